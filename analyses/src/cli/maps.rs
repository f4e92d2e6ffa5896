//! The plan of `stability-map`: which models over which grid, by which engine, for which chart.

use std::sync::Arc;
use std::time::Instant;

use super::{Intent, LimitOptions, Progress};
use crate::charts::{ContourLines, Level, interpolated_contours, is_logarithmic, levels};
use crate::error::{Refusal, Result};
use crate::record::StabilityRow;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::Scene;
use bipenalty::schemes::{ClosedLimit, SchemeName};
use bipenalty::spectrum::Uncertified;
use bipenalty::stability::{
    AnyModel, Asking, CriticalStep, Curve, Grid, LimitOf, Model, Sweep, map, with_limit,
};

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
#[derive(Debug)]
pub struct Job {
    /// Name of the files, without ending.
    pub stem: String,
    /// The models, a panel each.
    pub models: Vec<Arc<AnyModel>>,
    /// The axis of beta_s.
    pub beta_s: Sweep,
    /// The axis of r.
    pub ratio: Sweep,
    /// The same as a checked grid.
    pub grid: Grid,
    /// The chart.
    pub chart: Chart,
    /// Whether the i-th ratio of the grid goes with the i-th beta_s only.
    pub paired: bool,
}

/// One model's map.
#[derive(Debug)]
pub struct Solved {
    /// The model.
    pub model: Arc<AnyModel>,
    /// Whose limit.
    pub limit: LimitOf,
    /// The map.
    pub curves: Vec<Curve>,
    /// The contact-free limit.
    pub contact_free: Result<CriticalStep, Uncertified>,
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

impl Solved {
    /// dt, s, of a critical Courant number.
    pub fn seconds_of(&self, critical_courant: f64) -> f64 {
        // Its reference was found with the map.
        self.model.time_step(critical_courant).unwrap_or(f64::NAN)
    }
}

impl Job {
    /// The job of one figure.
    ///
    /// # Errors
    /// A grid that is empty, too large, or whose penalties leave the range of f64.
    pub fn new(
        stem: String,
        models: Vec<Arc<AnyModel>>,
        beta_s: Sweep,
        ratio: Sweep,
    ) -> Result<Self, Refusal> {
        let grid = checked_grid(&beta_s, &ratio)?;
        // What a mesh refers to is an eigenvalue, which is for the run to compute.
        for model in models.iter().filter(|model| matches!(***model, AnyModel::Bars(_))) {
            model.check_grid(&grid)?;
        }
        let chart = Chart::of(&beta_s.values, &ratio.values);
        Ok(Self { stem, models, beta_s, ratio, grid, chart, paired: false })
    }

    /// The job of one model with the plastic ratio of every beta_s at dt = `relative_courant` times the contact-free
    /// step: dt^2 s' mu = 1.
    ///
    /// # Errors
    /// What [`ClosedLimit::plastic_ratio`] and [`Job::new`] refuse; a model that is no row of bars.
    pub fn plastic(
        stem: String,
        model: Arc<AnyModel>,
        beta_s: Sweep,
        relative_courant: f64,
    ) -> Result<Self, Refusal> {
        let AnyModel::Bars(bars) = &*model else {
            let value = format!("plastic with scene {}", model.name());
            return Err(Refusal::new("--ratio", value, "numbers, or a scene of [[bar]]"));
        };
        bars.check_pencil()?;
        let pencil = bars.pencil();
        bars.limit(SchemeName::PredictorCorrector.scheme(), &pencil)?;
        let limit = ClosedLimit::new(&pencil, Box::new(bars.auto()))?;
        let ratio = |beta_s: &f64| {
            let beta_s = StiffnessPenalty::new(*beta_s)?.get();
            limit.plastic_ratio(beta_s, relative_courant)
        };
        let ratios: Result<Vec<f64>, Refusal> = beta_s.values.iter().map(ratio).collect();
        let job = Self::new(stem, vec![model.clone()], beta_s, Sweep::list(ratios?))?;
        Ok(Self { chart: Chart::None, paired: true, ..job })
    }

    /// Points of the job.
    pub fn points(&self) -> usize {
        let points = if self.paired { self.grid.ratios.len() } else { self.grid.len() };
        points * self.models.len()
    }

    /// Refuses what the run itself has to find out: maps whose records the memory does not hold, and penalties of meshes
    /// that f64 does not.
    ///
    /// # Errors
    /// See [`Grid::require_memory`] and [`AnyModel::check_grid`].
    pub fn check(&self) -> Result<(), Refusal> {
        require_memory(&self.grid, BYTES_PER_POINT * self.models.len() as u64)?;
        self.models.iter().try_for_each(|model| model.check_grid(&self.grid))
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
        model: &Arc<AnyModel>,
        limit: &LimitOptions,
        progress: &Progress,
    ) -> Result<Solved, Refusal> {
        let asking = limit.asking()?;
        let begun = Instant::now();
        let curves = self.curves(model, &asking, progress)?;
        let seconds = begun.elapsed().as_secs_f64();
        let at_one = curves.iter().find(|curve| !self.paired && curve.ratio == Ratio::OPTIMAL).cloned();
        let optimal = match at_one {
            Some(curve) => curve,
            None => {
                let grid = Grid { ratios: vec![Ratio::OPTIMAL], ..self.grid.clone() };
                model.map(&grid, &asking, &|_| ())?.remove(0)
            }
        };
        let contact_free = model.contact_free(&asking)?.step;
        Ok(Solved { model: model.clone(), limit: asking.limit, curves, contact_free, optimal, seconds })
    }

    fn curves(&self, model: &AnyModel, asking: &Asking, progress: &Progress) -> Result<Vec<Curve>, Refusal> {
        let done = |points| progress.add(points);
        if !self.paired {
            return model.map(&self.grid, asking, &done);
        }
        // Paired penalties are those of bars.
        let AnyModel::Bars(model) = model else { return model.map(&self.grid, asking, &done) };
        let pairs = self.grid.stiffness_penalties.iter().zip(&self.grid.ratios);
        let point = |(beta_s, ratio): (&StiffnessPenalty, &Ratio)| Grid {
            stiffness_penalties: vec![*beta_s],
            ratios: vec![*ratio],
        };
        with_limit(model, asking, |limit| {
            Ok(pairs.flat_map(|pair| map(model, &point(pair), limit, &done)).collect())
        })
    }

    /// What `--explain` says of the job.
    ///
    /// # Errors
    /// As [`AnyModel::plan`].
    pub fn explain(&self, limit: &LimitOptions) -> Result<Vec<Intent>, Refusal> {
        let drawn = match self.chart {
            Chart::Curves => "drawn as curves over beta_s",
            Chart::Map => "drawn as a map with explicit contour lines",
            Chart::MassFamily => "drawn over gamma",
            Chart::None => "not drawn",
        };
        let (columns, rows) = (self.grid.stiffness_penalties.len(), self.grid.ratios.len());
        let megabytes = (self.points() as u64 * BYTES_PER_POINT).div_ceil(1_000_000);
        let each = self.points() / self.models.len();
        let seconds =
            self.models.iter().map(|model| super::seconds_of(model, limit, each)).sum::<Option<f64>>();
        let seconds =
            seconds.map_or_else(String::new, |s| format!(", about {s:.1e} s of one core without figures"));
        let size = format!(
            "{columns} x {rows} points (beta_s x r), {drawn}; at most {megabytes} MB of memory for the records{seconds}"
        );
        let models = self.models.iter().map(|model| super::explain(model, limit, &self.grid));
        std::iter::once(Ok(Intent::of(&self.stem, size))).chain(models).collect()
    }

    /// The contour lines of the maps: explicit, but for the limits of schemes with several contacts between bars, which are
    /// interpolated on the grid of the rows.
    ///
    /// # Errors
    /// As [`AnyModel::contour`].
    pub fn contour_lines(
        &self,
        rows: &[Vec<StabilityRow>],
        limit: &LimitOptions,
        asked: Option<&[f64]>,
    ) -> Result<Vec<ContourLines>, Refusal> {
        let models = self.models.iter().zip(rows);
        models.map(|(model, rows)| self.lines_of(model, rows, limit, asked)).collect()
    }

    /// The contour lines of one of the models, whose rows these are, at the levels `asked` for, if any are.
    ///
    /// # Errors
    /// As [`Job::contour_lines`].
    pub fn lines_of(
        &self,
        model: &AnyModel,
        rows: &[StabilityRow],
        limit: &LimitOptions,
        asked: Option<&[f64]>,
    ) -> Result<ContourLines, Refusal> {
        let of_bars = matches!(model, AnyModel::Bars(_));
        let between = if of_bars { model.contacts() > 1 } else { limit.limit == super::Limit::Park };
        if between && limit.limit.scheme().is_some() {
            return Ok(interpolated_contours(rows, asked));
        }
        let range = |axis: &Sweep| (axis.values[0], axis.values[axis.values.len() - 1]);
        let (beta_s, ratio, asking) = (range(&self.beta_s), range(&self.ratio), limit.asking()?);
        let line = |level: Level| {
            let points = model.contour(level.value, beta_s, ratio, &asking)?;
            Ok((level, points))
        };
        levels(rows, asked).into_iter().map(line).collect()
    }
}

/// The grid of two axes; a refusal goes by the options that the user typed.
///
/// # Errors
/// See [`Grid::new`].
pub fn checked_grid(beta_s: &Sweep, ratio: &Sweep) -> Result<Grid, Refusal> {
    Grid::new(beta_s, ratio)
}

/// Refuses a scene without a contact: it has nothing to optimise.
///
/// # Errors
/// Names the scene.
pub fn check_touches(model: &AnyModel) -> Result<(), Refusal> {
    match model.contacts() {
        0 => Err(Refusal::new("SCENE", model.name(), "a scene with at least one contact")),
        _ => Ok(()),
    }
}

/// Refuses a grid whose points, of `bytes` each, the memory does not hold, by the options that the user typed.
///
/// # Errors
/// See [`Grid::require_memory`].
pub fn require_memory(grid: &Grid, bytes: u64) -> Result<(), Refusal> {
    grid.require_memory(bytes)
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
    let ratios = Sweep::list([0.5, 1.0, 2.0, 3.0, f64::INFINITY]);
    let linear = Sweep::linear(0.0, 10.0, 401)?;
    let (log_beta, log_ratio) = (Sweep::log(1e-3, 1e12, 181)?, Sweep::log(0.1, 1e3, 97)?);
    let mut jobs = vec![mass_family(scene("signorini", 1)?, form)?];
    // Fig. 1: the penalty method against the bi-penalty method at its optimum.
    let methods = Sweep::list([1.0, f64::INFINITY]);
    for mass in masses {
        let model = bars(scene("signorini", 1)?, *mass, form);
        let name = format!("fig1-{}", mass.name());
        jobs.push(Job::new(name, vec![model], linear.clone(), methods.clone())?);
    }
    for elements in [1, 100] {
        let pair = [scene("signorini", elements)?, scene("symmetric", elements)?];
        for mass in masses {
            let models: Vec<_> = pair.iter().map(|scene| bars(scene.clone(), *mass, form)).collect();
            let name = |kind: &str| format!("{kind}-{elements}-{}", mass.name());
            jobs.push(Job::new(name("fig3"), models.clone(), linear.clone(), ratios.clone())?);
            jobs.push(Job::new(name("map"), models, log_beta.clone(), log_ratio.clone())?);
        }
    }
    for mass in masses {
        let model = bars(scene("hunek", 50)?, *mass, form);
        jobs.push(Job::new(
            format!("sec5-2-hunek-{}", mass.name()),
            vec![model],
            linear.clone(),
            ratios.clone(),
        )?);
    }
    Ok(jobs)
}

fn bars(scene: Scene, mass: MassMatrix, form: PenaltyMass) -> Arc<AnyModel> {
    Arc::new(AnyModel::Bars(Model::new(scene, mass, form)))
}

/// The contact-free limit over gamma, (26).
fn mass_family(scene: Scene, form: PenaltyMass) -> Result<Job, Refusal> {
    let gammas = Sweep::linear(0.0, 1.0, 21)?;
    let model = |gamma: &f64| Ok(bars(scene.clone(), MassMatrix::new(*gamma)?, form));
    let models = gammas.values.iter().map(model).collect::<Result<_, Refusal>>()?;
    let job = Job::new("mass-matrices".to_owned(), models, Sweep::list([0.0]), Sweep::list([1.0]))?;
    Ok(Job { chart: Chart::MassFamily, ..job })
}
