//! `--from FILE.csv`: the figure of records that a run has left, drawn again without computing.

use std::path::{Path, PathBuf};

use super::samples::{Claim, Samples};
use super::{Chart, Output, Units};
use crate::error::{Refusal, Result};
use figure::Figure;

use crate::charts;
use crate::record::{
    CostRow, OptimalRatioRow, Origin, StabilityRow, cost_rows, optimal_ratio_rows, stability_rows,
};

/// Draws the records that `stability-map` or `scheme-limits` has written to `files`, in one figure; the rows and the number
/// of files.
///
/// # Errors
/// What [`stability_rows`] refuses, rows that make no chart, and what the system says of the files.
pub fn redraw_stability(
    files: &[PathBuf],
    units: Units,
    output: &Output,
) -> Result<(Vec<StabilityRow>, usize)> {
    let tables: Vec<Vec<StabilityRow>> =
        files.iter().map(|file| stability_rows(file)).collect::<Result<_>>()?;
    let key = |row: &StabilityRow| (row.scene.clone(), row.mass.clone(), row.elements, row.limit);
    let mut models = Vec::new();
    for (file, rows) in files.iter().zip(&tables) {
        let of_file = models_of(file, rows, key)?;
        of_file.iter().try_for_each(|rows| check_units(file, rows))?;
        models.extend(of_file);
    }
    let name = stems(files)?;
    let figure = stability_figure(&models, Path::new(&format!("{name}.csv")), output.levels(), units)?;
    let sources = files.iter().zip(&tables).map(|(file, rows)| Redrawn::of(file, rows)).collect();
    let rows = tables.concat();
    let files = write(&name, sources, &rows, &figure, output)?;
    Ok((rows, files))
}

/// A file that is drawn again: where its rows come from, and how those computed anew agree with them.
#[derive(Debug, Clone)]
pub struct Redrawn {
    /// The file.
    pub file: PathBuf,
    /// The run that has computed its rows.
    pub origin: Origin,
    /// Some of them, computed again.
    pub samples: Samples,
}

impl Redrawn {
    fn of<'a, R: 'a>(file: &Path, rows: &'a [R]) -> Self
    where
        Claim<'a>: From<&'a R>,
    {
        let origin = Origin::of(file, rows.len());
        Self { file: file.to_owned(), samples: Samples::of(rows, &origin), origin }
    }
}

/// What the figure of several files is called: by all of them.
fn stems(files: &[PathBuf]) -> Result<String, Refusal> {
    Ok(files.iter().map(|file| stem(file)).collect::<Result<Vec<_>, _>>()?.join("-"))
}

/// Draws the records that `optimal-ratio` or `scheme-limits` has written to `file`; the rows and the number of files.
///
/// # Errors
/// As [`redraw_stability`], with [`optimal_ratio_rows`].
pub fn redraw_optimal_ratio(file: &Path, output: &Output) -> Result<(Vec<OptimalRatioRow>, usize)> {
    let rows = optimal_ratio_rows(file)?;
    let key = |row: &OptimalRatioRow| (row.scene.clone(), row.mass.clone(), row.elements, row.limit);
    let models = models_of(file, &rows, key)?;
    let betas: Vec<f64> = models[0].iter().map(|row| row.stiffness_penalty.0).collect();
    let name = stem(file)?.to_owned() + ".csv";
    let figure =
        charts::optimal_ratio(&name, &models, charts::is_logarithmic(&betas)).filter(|_| betas.len() > 1);
    let allowed = "at least two stiffness penalties and a ratio";
    let figure =
        figure.ok_or_else(|| Refusal::new(file.display().to_string(), "too few rows to draw", allowed))?;
    let files = write(stem(file)?, vec![Redrawn::of(file, &rows)], &rows, &figure, output)?;
    Ok((rows, files))
}

/// Draws the records that `scheme-limits --per-force` has written to `file`; the rows and the number of files.
///
/// # Errors
/// As [`redraw_stability`], with [`cost_rows`]; rows of more than one model, or of one penalty.
pub fn redraw_costs(file: &Path, units: Units, output: &Output) -> Result<(Vec<CostRow>, usize)> {
    let rows = cost_rows(file)?;
    let key = |row: &CostRow| (row.scene.clone(), row.mass.clone(), row.elements);
    let mut betas: Vec<f64> = rows.iter().map(|row| row.stiffness_penalty.0).collect();
    betas.sort_by(f64::total_cmp);
    betas.dedup();
    let models = models_of(file, &rows, key)?.len();
    if models > 1 || betas.len() < 2 {
        let found = format!("{models} models and {} stiffness penalties", betas.len());
        let allowed = "one model and at least two stiffness penalties";
        return Err(Refusal::new(file.display().to_string(), found, allowed).into());
    }
    let si = units == Units::Si;
    if si && rows.iter().any(|row| row.penalty_stiffness.is_none()) {
        let allowed = "records with penalty_stiffness, or --units dimensionless";
        return Err(Refusal::new(file.display().to_string(), "no penalties in N/m", allowed).into());
    }
    let figure = charts::per_force(&rows, charts::is_logarithmic(&betas), si);
    let files = write(stem(file)?, vec![Redrawn::of(file, &rows)], &rows, &figure, output)?;
    Ok((rows, files))
}

/// Rows that follow one another and agree in what `key` says.
///
/// # Errors
/// Rows of one model that do not all follow one another: they are not in the order in which a run leaves them.
fn models_of<R: Clone, K: PartialEq>(
    file: &Path,
    rows: &[R],
    key: impl Fn(&R) -> K,
) -> Result<Vec<Vec<R>>, Refusal> {
    let models: Vec<Vec<R>> = rows.chunk_by(|a, b| key(a) == key(b)).map(<[R]>::to_vec).collect();
    let mut line = 2;
    for (i, rows) in models.iter().enumerate() {
        if models[..i].iter().any(|before| key(&before[0]) == key(&rows[0])) {
            let place = format!("{}, line {line}", file.display());
            let value = "a row of a model whose other rows came before those of another one";
            return Err(Refusal::new(
                place,
                value,
                "all rows of a model one after the other, as a run leaves them",
            ));
        }
        line += rows.len();
    }
    Ok(models)
}

/// A quantity over the dimensionless one beside it.
type Proportion = fn(&StabilityRow) -> Option<f64>;

/// Refuses rows of one model whose steps in seconds and Courant numbers, or whose penalties in N/m and beta_s, are not all in
/// one proportion: a chart in SI units would show others than its rows prove.
fn check_units(file: &Path, rows: &[StabilityRow]) -> Result<(), Refusal> {
    // A quotient of two rounded numbers, a bound that is rounded outwards, and the other quotient.
    const ROUNDINGS: f64 = 16.0 * f64::EPSILON;
    let proportions: [(&str, Proportion); 4] = [
        ("critical_step", |row| Some(row.critical_step?.0 / row.critical_courant?.0)),
        ("step_lower", |row| Some(row.step_lower?.0 / row.lower?.0)),
        ("step_upper", |row| Some(row.step_upper?.0 / row.upper?.0).filter(|rate| rate.is_finite())),
        ("penalty_stiffness", |row| {
            Some(row.penalty_stiffness?.0 / row.stiffness_penalty.0).filter(|scale| scale.is_finite())
        }),
    ];
    let steps = rows.iter().find_map(|row| proportions[1].1(row));
    for (index, (column, proportion)) in proportions.into_iter().enumerate() {
        let first = if index < 3 { steps } else { rows.iter().find_map(proportion) };
        let Some(first) = first else { continue };
        let other =
            rows.iter().find(|row| proportion(row).is_some_and(|p| (p / first - 1.0).abs() > ROUNDINGS));
        if let Some(row) = other {
            let place = format!(
                "{}, {column} at beta_s = {}, r = {}",
                file.display(),
                row.stiffness_penalty.0,
                row.ratio.0
            );
            let value = format!("{:?} of the dimensionless one", proportion(row).unwrap_or(f64::NAN));
            return Err(Refusal::new(
                place,
                value,
                format!("{first:?} of it, as in the other rows of the model"),
            ));
        }
    }
    Ok(())
}

/// The chart that the run has drawn from these rows, with contour lines interpolated on their grid.
fn stability_figure(
    models: &[Vec<StabilityRow>],
    file: &Path,
    levels: Option<&[f64]>,
    units: Units,
) -> Result<Figure, Refusal> {
    let mut betas: Vec<f64> = models[0].iter().map(|row| row.stiffness_penalty.0).collect();
    let mut ratios: Vec<f64> = models[0].iter().map(|row| row.ratio.0).collect();
    ratios.dedup();
    betas.truncate(models[0].len() / ratios.len());
    let contact_free = |rows: &Vec<StabilityRow>| rows.len() == 1 && rows[0].stiffness_penalty.0 == 0.0;
    let chart = match Chart::of(&betas, &ratios) {
        _ if models.len() > 1 && models.iter().all(contact_free) => Chart::MassFamily,
        chart => chart,
    };
    let name = stem(file)?.to_owned() + ".csv";
    let mut lines = Vec::new();
    let figure = match chart {
        Chart::MassFamily => charts::mass_family(&name, models),
        Chart::Curves => charts::curves(name.as_str(), models, charts::is_logarithmic(&betas)),
        Chart::Map if models.iter().all(|rows| is_grid(rows)) => {
            lines = models.iter().map(|rows| charts::interpolated_contours(rows, levels)).collect();
            charts::map(models, &lines)
        }
        Chart::Map | Chart::None => {
            let allowed = "a grid of at least two stiffness penalties by some ratios, curve by curve; more than 12 \
                           ratios on two logarithmic axes";
            let found = format!("{} rows of {} ratios", models[0].len(), ratios.len());
            return Err(Refusal::new(file.display().to_string(), found, allowed));
        }
    };
    let figure = match units {
        Units::Si => {
            let rows = || models.iter().flatten();
            if rows().all(|row| row.penalty_stiffness.is_none()) || rows().all(|row| row.step_lower.is_none())
            {
                let allowed = "records with penalty_stiffness and critical_step, or --units dimensionless";
                return Err(Refusal::new("--units", "si", allowed));
            }
            charts::in_si(figure, models, &lines)
        }
        Units::Dimensionless => figure,
    };
    let limits = models.windows(2).any(|pair| pair[0][0].limit != pair[1][0].limit);
    Ok(if limits { charts::titled_by_limit(figure, models) } else { figure })
}

/// Whether the rows are curves over the same stiffness penalties, each ratio once.
fn is_grid(rows: &[StabilityRow]) -> bool {
    let curves: Vec<&[StabilityRow]> = rows.chunk_by(|a, b| a.ratio == b.ratio).collect();
    let betas = |curve: &[StabilityRow]| curve.iter().map(|row| row.stiffness_penalty.0).collect::<Vec<_>>();
    let mut ratios: Vec<f64> = curves.iter().map(|curve| curve[0].ratio.0).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.windows(2).all(|pair| pair[0] < pair[1])
        && curves.iter().all(|curve| betas(curve) == betas(curves[0]))
}

/// What the figure of a file is called.
fn stem(file: &Path) -> Result<&str, Refusal> {
    let stem = file.file_stem().and_then(|stem| stem.to_str());
    stem.ok_or_else(|| Refusal::new("--from", file.display(), "a file with a name"))
}

fn write<R: serde::Serialize + Clone>(
    stem: &str,
    sources: Vec<Redrawn>,
    rows: &[R],
    figure: &Figure,
    output: &Output,
) -> Result<usize> {
    let output = output.clone().redrawing(sources);
    output.check_figure(stem, figure.clone())?;
    Ok(output.write_rows(stem, rows)?.len() + output.write_figure(stem, figure)?.len())
}
