//! The plan of `stability-map`: which models over which grid, by which engine, for which chart.

use std::time::Instant;

use super::{Limit, LimitOptions, Progress};
use crate::charts::{ContourLines, interpolated_contours, is_logarithmic, levels};
use crate::error::{Refusal, Result};
use crate::record::StabilityRow;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Penalty;
use bipenalty::scene::Scene;
use bipenalty::schemes::{ClosedLimit, SchemeName};
use bipenalty::spectrum::{Enclosure, StepLimit, Uncertified};
use bipenalty::stability::{Axis, Curve, Grid, Model, map, scheme_contour};

/// How the points of a job are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chart {
    /// C_r over beta_s, one curve a ratio, one panel a model.
    Curves,
    /// Colours over (beta_s, r) with contour lines, one panel a model.
    Map,
    /// The contact-free limit over gamma.
    MassFamily,
    /// Too few points for a chart.
    None,
}

impl Chart {
    /// The chart for curves over `beta_s` at `ratios`.
    pub fn of(beta_s: &[f64], ratios: &[f64]) -> Self {
        match (beta_s.len(), ratios.len()) {
            (0 | 1, _) => Self::None,
            (_, ratios) if ratios <= MOST_CURVES => Self::Curves,
            _ if is_logarithmic(beta_s) && is_logarithmic(ratios) => Self::Map,
            _ => Self::None,
        }
    }
}

/// The models of one figure and the grid they share.
#[derive(Debug, Clone)]
pub struct Job {
    /// Name of the files, without ending.
    pub stem: String,
    /// The models, a panel each.
    pub models: Vec<Model>,
    /// The axis of beta_s.
    pub beta_s: Axis,
    /// The axis of r.
    pub ratio: Axis,
    /// The same as a checked grid.
    pub grid: Grid,
    /// The chart.
    pub chart: Chart,
    /// Whether the i-th ratio of the grid goes with the i-th beta_s only.
    pub paired: bool,
}

/// One model's map.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The model.
    pub model: Model,
    /// Whose limit.
    pub limit: Limit,
    /// The map.
    pub curves: Vec<Curve>,
    /// The contact-free l_max.
    pub contact_free: Result<Enclosure, Uncertified>,
    /// The map at r = 1 over the same beta_s.
    pub optimal: Curve,
    /// Time for the map, s.
    pub seconds: f64,
}

/// Curves up to this many ratios; more are drawn as a map.
const MOST_CURVES: usize = 12;

/// Bytes of a point: as found (88, twice), its record (310, three times on the way to standard output), its line of text
/// (up to 340, in a vector that doubles), and the cells of its line for the record of a figure (17 of 24 and up to 32).
const BYTES_PER_POINT: u64 = 2800;

impl Job {
    /// The job of one figure; refuses what the models cannot hold.
    ///
    /// # Errors
    /// A grid that is empty, too large, or whose penalties leave the range of f64.
    pub fn new(stem: String, models: Vec<Model>, beta_s: Axis, ratio: Axis) -> Result<Self, Refusal> {
        let grid = checked_grid(&beta_s, &ratio)?;
        for model in &models {
            model.check_grid(&grid)?;
        }
        let chart = Chart::of(&beta_s.values, &ratio.values);
        Ok(Self { stem, models, beta_s, ratio, grid, chart, paired: false })
    }

    /// The job of one model with the plastic ratio of every beta_s at dt = `relative_courant` times the contact-free
    /// step: dt^2 s' mu = 1.
    ///
    /// # Errors
    /// What [`ClosedLimit::plastic_ratio`] and [`Job::new`] refuse.
    pub fn plastic(stem: String, model: Model, beta_s: Axis, relative_courant: f64) -> Result<Self, Refusal> {
        model.check_pencil()?;
        let pencil = model.pencil();
        model.limit(SchemeName::PredictorCorrector.scheme(), &pencil)?;
        let limit = ClosedLimit::new(&pencil, Box::new(model.auto()))?;
        let ratio = |beta_s: &f64| {
            let beta_s = StiffnessPenalty::new(*beta_s)?.get();
            limit.plastic_ratio(beta_s, relative_courant)
        };
        let ratios: Result<Vec<f64>, Refusal> = beta_s.values.iter().map(ratio).collect();
        let job = Self::new(stem, vec![model.clone()], beta_s, Axis::list(ratios?))?;
        Ok(Self { chart: Chart::None, paired: true, ..job })
    }

    /// Points of the job.
    pub fn points(&self) -> usize {
        let points = if self.paired { self.grid.ratios.len() } else { self.grid.len() };
        points * self.models.len()
    }

    /// Refuses maps whose records the memory does not hold.
    ///
    /// # Errors
    /// See [`Grid::require_memory`].
    pub fn require_memory(&self) -> Result<(), Refusal> {
        require_memory(&self.grid, BYTES_PER_POINT * self.models.len() as u64)
    }

    /// Computes the maps of all models, certified.
    ///
    /// # Errors
    /// What [`LimitOptions::check`] refuses.
    pub fn solve(&self, limit: &LimitOptions, progress: &Progress) -> Result<Vec<Solved>, Refusal> {
        progress.doing(&self.stem);
        self.models.iter().map(|model| self.solve_model(model, limit, progress)).collect()
    }

    fn solve_model(
        &self,
        model: &Model,
        limit: &LimitOptions,
        progress: &Progress,
    ) -> Result<Solved, Refusal> {
        let pencil = limit.needs_pencil().then(|| model.pencil());
        let engine = limit.find(model, pencil.as_ref())?;
        let begun = Instant::now();
        let curves = self.curves(model, engine.as_ref(), progress);
        let seconds = begun.elapsed().as_secs_f64();
        let at_one = curves.iter().find(|curve| !self.paired && curve.ratio == Ratio::OPTIMAL).cloned();
        let optimal = at_one.unwrap_or_else(|| {
            let grid = Grid { ratios: vec![Ratio::OPTIMAL], ..self.grid.clone() };
            map(model, &grid, engine.as_ref(), &|_| ()).remove(0)
        });
        let contact_free = engine.enclose(&Penalty::NONE, None).map(|step| step.l);
        let (model, limit) = (model.clone(), limit.limit);
        Ok(Solved { model, limit, curves, contact_free, optimal, seconds })
    }

    fn curves(&self, model: &Model, engine: &dyn StepLimit, progress: &Progress) -> Vec<Curve> {
        let done = |points| progress.add(points);
        if !self.paired {
            return map(model, &self.grid, engine, &done);
        }
        let pairs = self.grid.stiffness_penalties.iter().zip(&self.grid.ratios);
        pairs
            .flat_map(|(beta_s, ratio)| {
                let point = Grid { stiffness_penalties: vec![*beta_s], ratios: vec![*ratio] };
                map(model, &point, engine, &done)
            })
            .collect()
    }

    /// What `--explain` says of the job.
    pub fn explain(&self, limit: &LimitOptions) -> String {
        let mut text = format!(
            "{}: {} x {} points (beta_s x r), {}\n",
            self.stem,
            self.grid.stiffness_penalties.len(),
            self.grid.ratios.len(),
            match self.chart {
                Chart::Curves => "drawn as curves over beta_s",
                Chart::Map => "drawn as a map with explicit contour lines",
                Chart::MassFamily => "drawn over gamma",
                Chart::None => "not drawn",
            }
        );
        for model in &self.models {
            text += &match limit.limit.scheme() {
                None => format!("  {}\n", super::explain(model, limit.engine, &self.grid)),
                Some(scheme) => format!("  {}\n", explain_scheme(model, scheme)),
            };
        }
        text
    }
}

/// The grid of two axes; a refusal goes by the options that the user typed.
///
/// # Errors
/// See [`Grid::new`].
pub fn checked_grid(beta_s: &Axis, ratio: &Axis) -> Result<Grid, Refusal> {
    Grid::new(beta_s, ratio)
}

/// Refuses a grid whose points, of `bytes` each, the memory does not hold, by the options that the user typed.
///
/// # Errors
/// See [`Grid::require_memory`].
pub fn require_memory(grid: &Grid, bytes: u64) -> Result<(), Refusal> {
    grid.require_memory(bytes)
}

/// The contour lines of the limit of a scheme: explicit for one contact, for several interpolated on the grid of the rows.
pub fn scheme_lines(
    model: &Model,
    limit: &dyn StepLimit,
    rows: &[StabilityRow],
    beta_s: (f64, f64),
    ratio: (f64, f64),
) -> ContourLines {
    if model.scales().len() > 1 {
        return interpolated_contours(rows);
    }
    let line = |level: f64| (level, scheme_contour(model, limit, level, beta_s, ratio));
    levels(rows).into_iter().map(line).collect()
}

/// How the limit of a scheme is found for `model`.
fn explain_scheme(model: &Model, scheme: SchemeName) -> String {
    let scene = model.scene();
    let method = match scheme {
        SchemeName::Park => {
            "multiplier -1 of the amplification matrix, about 10 pairs of eliminations of the pencil"
        }
        _ => {
            "dt^2 s' mu = 1 in closed form, of unlike contacts a lower bound; below the contact-free l_max signs of the secular equation"
        }
    };
    format!("{} ({} elements, {} mass): {method}", scene.name(), scene.elements(), model.mass().name())
}

/// The figures of the paper, and the maps it leaves out: what `stability-map` does without a scene.
///
/// # Errors
/// None in practice: the built-in scenes and grids are valid.
pub fn paper(
    scene: &dyn Fn(&str, usize) -> Result<Scene>,
    masses: &[MassMatrix],
    form: PenaltyMass,
) -> Result<Vec<Job>> {
    let ratios = Axis::list([0.5, 1.0, 2.0, 3.0, f64::INFINITY]);
    let linear = Axis::linear(0.0, 10.0, 401)?;
    let (log_beta, log_ratio) = (Axis::log(1e-3, 1e12, 181)?, Axis::log(0.1, 1e3, 97)?);
    let mut jobs = vec![mass_family(scene("signorini", 1)?, form)?];
    // Fig. 1: the penalty method against the bi-penalty method at its optimum.
    let methods = Axis::list([1.0, f64::INFINITY]);
    for mass in masses {
        let model = Model::new(scene("signorini", 1)?, *mass, form);
        let name = format!("fig1-{}", mass.name());
        jobs.push(Job::new(name, vec![model], linear.clone(), methods.clone())?);
    }
    for elements in [1, 100] {
        let pair = [scene("signorini", elements)?, scene("symmetric", elements)?];
        for mass in masses {
            let models: Vec<Model> =
                pair.iter().map(|scene| Model::new(scene.clone(), *mass, form)).collect();
            let name = |kind: &str| format!("{kind}-{elements}-{}", mass.name());
            jobs.push(Job::new(name("fig3"), models.clone(), linear.clone(), ratios.clone())?);
            jobs.push(Job::new(name("map"), models, log_beta.clone(), log_ratio.clone())?);
        }
    }
    for mass in masses {
        let model = Model::new(scene("hunek", 50)?, *mass, form);
        jobs.push(Job::new(format!("hunek-{}", mass.name()), vec![model], linear.clone(), ratios.clone())?);
    }
    Ok(jobs)
}

/// The contact-free limit over gamma, (26).
fn mass_family(scene: Scene, form: PenaltyMass) -> Result<Job, Refusal> {
    let gammas = Axis::linear(0.0, 1.0, 21)?;
    let models: Result<Vec<Model>, Refusal> = gammas
        .values
        .iter()
        .map(|gamma| Ok(Model::new(scene.clone(), MassMatrix::new(*gamma)?, form)))
        .collect();
    let job = Job::new("mass-matrices".to_owned(), models?, Axis::list([0.0]), Axis::list([1.0]))?;
    Ok(Job { chart: Chart::MassFamily, ..job })
}
