//! The plan of `stability-map`: which models over which grid, by which engine, for which chart.

use std::time::Instant;

use super::Progress;
use crate::error::{Refusal, Result};
use crate::fem::MassMatrix;
use crate::penalty::{PenaltyMass, Ratio};
use crate::scene::Scene;
use crate::spectrum::{Enclosure, Uncertified};
use crate::stability::{Axis, Curve, EngineName, Grid, Model, map};

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
}

/// One model's map.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The model.
    pub model: Model,
    /// Name of the engine that was used.
    pub engine: &'static str,
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
        let chart = match (grid.stiffness_penalties.len(), grid.ratios.len()) {
            (1, _) => Chart::None,
            (_, ratios) if ratios <= MOST_CURVES => Chart::Curves,
            _ if beta_s.log && ratio.log => Chart::Map,
            _ => Chart::None,
        };
        Ok(Self { stem, models, beta_s, ratio, grid, chart })
    }

    /// Points of the job.
    pub fn points(&self) -> usize {
        self.grid.len() * self.models.len()
    }

    /// Computes the maps of all models, certified.
    pub fn solve(&self, engine: EngineName, progress: &Progress) -> Vec<Solved> {
        progress.doing(&self.stem);
        self.models.iter().map(|model| self.solve_model(model, engine, progress)).collect()
    }

    fn solve_model(&self, model: &Model, name: EngineName, progress: &Progress) -> Solved {
        let pencil = name.needs_pencil().then(|| model.pencil());
        let engine = model.engine(name, pencil.as_ref());
        let begun = Instant::now();
        let curves = map(model, &self.grid, engine.as_ref(), &|points| progress.add(points));
        let seconds = begun.elapsed().as_secs_f64();
        let at_one = curves.iter().find(|curve| curve.ratio == Ratio::OPTIMAL).cloned();
        let optimal = at_one.unwrap_or_else(|| {
            let grid = Grid { ratios: vec![Ratio::OPTIMAL], ..self.grid.clone() };
            map(model, &grid, engine.as_ref(), &|_| ()).remove(0)
        });
        let contact_free = engine.enclose(&vec![Default::default(); model.scales().len()], None);
        Solved { model: model.clone(), engine: engine.name(), curves, contact_free, optimal, seconds }
    }

    /// What `--explain` says of the job.
    pub fn explain(&self, engine: EngineName) -> String {
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
            text += &format!("  {}\n", model.explain(engine, &self.grid));
        }
        text
    }
}

/// The grid of two axes; a refusal goes by the options that the user typed.
///
/// # Errors
/// See [`Grid::new`].
pub fn checked_grid(beta_s: &Axis, ratio: &Axis) -> Result<Grid, Refusal> {
    Grid::new(beta_s, ratio).map_err(|refusal| {
        let place = match refusal.place.as_str() {
            "beta_s" => "--beta-s",
            "r" => "--ratio",
            _ => "--beta-s, --ratio",
        };
        Refusal { place: place.to_owned(), ..refusal }
    })
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

/// Fig. 1: the contact-free limit over gamma.
fn mass_family(scene: Scene, form: PenaltyMass) -> Result<Job, Refusal> {
    let gammas = Axis::linear(0.0, 1.0, 21)?;
    let models: Result<Vec<Model>, Refusal> = gammas
        .values
        .iter()
        .map(|gamma| Ok(Model::new(scene.clone(), MassMatrix::new(*gamma)?, form)))
        .collect();
    let job = Job::new("fig1".to_owned(), models?, Axis::list([0.0]), Axis::list([1.0]))?;
    Ok(Job { chart: Chart::MassFamily, ..job })
}
