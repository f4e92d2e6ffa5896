//! `--from FILE.csv`: the figure of records that a run has left, drawn again without computing.

use std::path::{Path, PathBuf};

use super::{Chart, Output, Units};
use crate::error::{Refusal, Result};
use figure::Figure;

use crate::charts;
use crate::record::{CostRow, OptimalRatioRow, StabilityRow, cost_rows, optimal_ratio_rows, stability_rows};

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
    let models: Vec<_> = tables.iter().flat_map(|rows| models(rows, key)).collect();
    let name = stems(files)?;
    let figure = stability_figure(&models, Path::new(&format!("{name}.csv")), output.levels(), units)?;
    let counted: Vec<(PathBuf, usize)> = files.iter().cloned().zip(tables.iter().map(Vec::len)).collect();
    let rows = tables.concat();
    let files = write(&name, &counted, &rows, &figure, output)?;
    Ok((rows, files))
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
    let models = models(&rows, key);
    let betas: Vec<f64> = models[0].iter().map(|row| row.stiffness_penalty.0).collect();
    let name = stem(file)?.to_owned() + ".csv";
    let figure =
        charts::optimal_ratio(&name, &models, charts::is_logarithmic(&betas)).filter(|_| betas.len() > 1);
    let allowed = "at least two stiffness penalties and a ratio";
    let figure =
        figure.ok_or_else(|| Refusal::new(file.display().to_string(), "too few rows to draw", allowed))?;
    let files = write(stem(file)?, &[(file.to_owned(), rows.len())], &rows, &figure, output)?;
    Ok((rows, files))
}

/// Draws the records that `scheme-limits --per-force` has written to `file`; the rows and the number of files.
///
/// # Errors
/// As [`redraw_stability`], with [`cost_rows`]; rows of more than one model, or of one penalty.
pub fn redraw_costs(file: &Path, output: &Output) -> Result<(Vec<CostRow>, usize)> {
    let rows = cost_rows(file)?;
    let key = |row: &CostRow| (row.scene.clone(), row.mass.clone(), row.elements);
    let mut betas: Vec<f64> = rows.iter().map(|row| row.stiffness_penalty.0).collect();
    betas.sort_by(f64::total_cmp);
    betas.dedup();
    let models = models(&rows, key).len();
    if models > 1 || betas.len() < 2 {
        let found = format!("{models} models and {} stiffness penalties", betas.len());
        let allowed = "one model and at least two stiffness penalties";
        return Err(Refusal::new(file.display().to_string(), found, allowed).into());
    }
    let figure = charts::per_force(&rows, charts::is_logarithmic(&betas));
    let files = write(stem(file)?, &[(file.to_owned(), rows.len())], &rows, &figure, output)?;
    Ok((rows, files))
}

/// Rows that follow one another and agree in what `key` says.
fn models<R: Clone, K: PartialEq>(rows: &[R], key: impl Fn(&R) -> K) -> Vec<Vec<R>> {
    rows.chunk_by(|a, b| key(a) == key(b)).map(<[R]>::to_vec).collect()
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
    files: &[(PathBuf, usize)],
    rows: &[R],
    figure: &Figure,
    output: &Output,
) -> Result<usize> {
    let output = output.clone().redrawing(files);
    Ok(output.write_rows(stem, rows)?.len() + output.write_figure(stem, figure)?.len())
}
