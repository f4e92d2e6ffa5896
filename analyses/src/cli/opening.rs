//! Runs with contact that opens and closes, below the linear limits: what they gain, and which step to recommend.

use std::sync::Arc;

use clap::{Args, ValueEnum};
use rayon::prelude::*;

use super::summary::short;
use super::{Intent, Output, Progress, print_table};
use crate::charts::opening::{gain_maps, is_map};
use crate::error::{Refusal, Result};
use crate::record::{OpeningRow, Recommendation, VerifyRow, scans};
use bipenalty::impact::{Encounter, Passage, Run, duration};
use bipenalty::schemes::{Scheme, SchemeName};
use bipenalty::stability::{AnyModel, AnyScene, Grid, Model, Sweep};
use bipenalty::verify::opening::{
    LinearLimit, Load, MOST_STEPS, energy_gain, energy_put_in, is_proven, is_proven_passage, passage_energy,
    passage_gain,
};
use bipenalty::verify::{PenaltyPoint, linear_step, points_of};

/// How contacts behave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Contact {
    /// Held closed
    Closed,
    /// Opens and closes
    Opening,
}

/// What only contact that opens and closes needs.
#[derive(Debug, Clone, Args)]
pub struct OpeningOptions {
    /// Opening contact: steps over the predicted limit, each in (0, 1) [default: 0.1 to 0.9 by 0.1, and 0.99]
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    pub fraction: Option<Sweep>,
}

/// Steps over the predicted limit where nothing else is asked for.
const FRACTIONS: [f64; 10] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99];

/// What is run.
enum Trial {
    Bars(Run, Load),
    Mesh(Arc<AnyModel>, Passage),
}

impl Trial {
    fn steps(&self) -> u64 {
        match self {
            Self::Bars(run, _) => run.steps(),
            Self::Mesh(_, passage) => passage.steps(),
        }
    }
}

/// One run below the linear limit.
struct Case {
    trial: Trial,
    point: PenaltyPoint,
    predicted: f64,
    contact_free_courant: f64,
    proven: bool,
}

/// Runs that have passed their checks.
pub struct OpeningPlan {
    cases: Vec<Case>,
    left_out: usize,
}

/// What they have gained.
pub struct OpeningResult {
    /// Run by run.
    pub rows: Vec<OpeningRow>,
    /// Limit by limit.
    pub limits: Vec<VerifyRow>,
    /// Whether what is proven to gain nothing gained nothing.
    pub holds: bool,
}

impl OpeningPlan {
    /// Every scheme on every model at every point of the grid under every load the scene can bear. Points that need more
    /// than [`MOST_STEPS`] a run are left out.
    ///
    /// # Errors
    /// Refuses fractions outside (0, 1), and what the limits and the runs refuse.
    pub fn new(
        models: &[(AnyScene, Arc<AnyModel>)],
        schemes: &[SchemeName],
        theta: f64,
        grid: &Grid,
        options: &OpeningOptions,
    ) -> Result<Self> {
        let fractions = options.fraction.as_ref().map_or(&FRACTIONS[..], |axis| &axis.values);
        if let Some(wrong) = fractions.iter().find(|f| !(**f > 0.0 && **f < 1.0)) {
            return Err(Refusal::new("--fraction", wrong, "numbers between 0 and 1, both excluded").into());
        }
        let schemes: Vec<Arc<dyn Scheme>> =
            schemes.iter().map(|scheme| scheme.with_theta(theta)).collect::<Result<_, _>>()?;
        let mut plan = Self { cases: Vec::new(), left_out: 0 };
        for (scene, model) in models {
            model.check_grid(grid)?;
            match &**model {
                AnyModel::Bars(bars) => plan.add_bars(bars, &schemes, grid, fractions)?,
                AnyModel::Mesh(_) => plan.add_mesh(scene, model, &schemes, grid, fractions)?,
            }
        }
        Ok(plan)
    }

    fn add_bars(
        &mut self,
        model: &Model,
        schemes: &[Arc<dyn Scheme>],
        grid: &Grid,
        fractions: &[f64],
    ) -> Result<(), Refusal> {
        model.check_pencil()?;
        let pencil = model.pencil();
        for scheme in schemes {
            let limit = LinearLimit::new(model, &pencil, &**scheme)?;
            for point in points_of(grid) {
                self.add(model, scheme, point, &limit, fractions)?;
            }
        }
        Ok(())
    }

    /// The impact of a scene of matrices or of a mesh.
    fn add_mesh(
        &mut self,
        scene: &AnyScene,
        model: &Arc<AnyModel>,
        schemes: &[Arc<dyn Scheme>],
        grid: &Grid,
        fractions: &[f64],
    ) -> Result<()> {
        let encounter = Encounter::of_scene(scene, model)?;
        let duration = duration(scene)?;
        let contact_free_courant = encounter.critical_step() / model.time_step(1.0)?;
        for scheme in schemes {
            for point in points_of(grid) {
                let predicted = linear_step(model, scheme, point)?.relative;
                let penalty = encounter.penalty(point.stiffness_penalty.get(), point.ratio.get());
                let mut cases = Vec::new();
                for fraction in fractions {
                    let courant = fraction * predicted;
                    let passage =
                        Passage::new(encounter.clone(), scheme.clone(), penalty, courant, duration)?;
                    passage_energy(&passage)?;
                    let proven = is_proven_passage(&passage);
                    let trial = Trial::Mesh(model.clone(), passage);
                    cases.push(Case { trial, point, predicted, contact_free_courant, proven });
                }
                self.keep(cases);
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        model: &Model,
        scheme: &Arc<dyn Scheme>,
        point: PenaltyPoint,
        limit: &LinearLimit,
        fractions: &[f64],
    ) -> Result<(), Refusal> {
        let predicted = limit.relative(point)?;
        let mut cases = Vec::new();
        for load in Load::ALL {
            let Some(loaded) = load.on(model)? else { continue };
            let run = Run::new(loaded, scheme.clone(), point.stiffness_penalty, point.ratio)?;
            energy_put_in(&run, load)?;
            for fraction in fractions {
                let run = run.clone().with_relative_courant(fraction * predicted)?;
                cases.push(Case {
                    trial: Trial::Bars(run, load),
                    point,
                    predicted,
                    contact_free_courant: limit.contact_free_courant(),
                    proven: is_proven(model, &**scheme),
                });
            }
        }
        self.keep(cases);
        Ok(())
    }

    /// Keeps the runs of a point unless one of them is too long.
    fn keep(&mut self, cases: Vec<Case>) {
        if cases.iter().all(|case| case.trial.steps() <= MOST_STEPS) {
            self.cases.extend(cases);
        } else {
            self.left_out += 1;
        }
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.cases.len()
    }

    /// Whether there is nothing to run.
    pub fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// What would be computed, in words.
    pub fn explain(&self) -> Intent {
        let steps: u64 = self.cases.iter().map(|case| case.trial.steps()).sum();
        let runs = format!(
            "{} runs of {steps} steps in all, below the linear limits; left out: {} \
             points that need more than {MOST_STEPS} steps a run",
            self.len(),
            self.left_out
        );
        Intent::of("contact that opens and closes", runs)
    }

    /// Executes the runs, in parallel.
    ///
    /// # Errors
    /// None that the plan has not found.
    pub fn measure(&self, progress: &Progress) -> Result<OpeningResult, Refusal> {
        let row = |case: &Case| {
            let row = match &case.trial {
                Trial::Bars(run, load) => {
                    OpeningRow::new(run, *load, case.point, case.predicted, &energy_gain(run, *load)?)
                }
                Trial::Mesh(model, passage) => {
                    let found = passage_gain(passage)?;
                    OpeningRow::of_passage(model, passage, case.point, case.predicted, &found)
                }
            };
            progress.add(1);
            Ok(row)
        };
        let rows: Vec<OpeningRow> = self.cases.par_iter().map(row).collect::<Result<_, Refusal>>()?;
        // A sum of works, each at most of the size of the energy put in.
        let rounding = |row: &OpeningRow| 4.0 * f64::EPSILON * row.steps as f64;
        let kept = |(case, row): (&Case, &OpeningRow)| !case.proven || row.energy_gain.0 <= rounding(row);
        let holds = self.cases.iter().zip(&rows).all(kept);
        let mut cases = self.cases.iter();
        let limit = |scan: &[OpeningRow]| {
            let case = cases.nth(scan.len() - 1)?;
            VerifyRow::opening(scan, case.contact_free_courant)
        };
        let limits = scans(&rows).filter_map(limit).collect();
        Ok(OpeningResult { rows, limits, holds })
    }
}

impl OpeningResult {
    /// Writes the rows, what they recommend, and a map for each scene and mass; the number of files. `all` and `each` end the
    /// names of files of all scenes and of one.
    ///
    /// # Errors
    /// What the system says of a file, and what the drawing layer refuses.
    pub fn write(&self, output: &Output, [all, each]: &[String; 2]) -> Result<usize> {
        let records = format!("opening{all}");
        let mut files = output.write_rows(&records, &self.rows)?.len();
        files += output.write_rows(&format!("opening-limits{all}"), &self.limits)?.len();
        let recommended = Recommendation::all(&self.rows);
        files += output.write_rows(&format!("recommendation{all}"), &recommended)?.len();
        if !output.wants_figures() {
            return Ok(files);
        }
        for rows in self.rows.chunk_by(|a, b| (&a.scene, &a.mass) == (&b.scene, &b.mass)) {
            if is_map(rows) {
                let stem = format!("opening-{}-{}{each}", rows[0].scene, rows[0].mass);
                files += output.write_figure_from(&records, &stem, &gain_maps(rows))?.len();
            }
        }
        Ok(files)
    }

    /// Prints which step to take.
    pub fn summarise(&self, plan: &OpeningPlan) {
        let header = ["scheme", "mass", "r", "beta_s up to", "C without gain", "energy kept in an impact"];
        let cells = |row: &Recommendation| {
            let step =
                if row.relative_courant.0 > 0.0 { digits(row.relative_courant.0) } else { "none".to_owned() };
            vec![
                row.scheme.to_owned(),
                row.mass.clone(),
                short(row.ratio.0),
                short(row.largest_stiffness_penalty.0),
                step,
                row.energy_ratio.map_or("-".to_owned(), |kept| digits(kept.0)),
            ]
        };
        crate::tell!("contact that opens and closes:");
        print_table(&header, Recommendation::all(&self.rows).iter().map(cells));
        if plan.left_out > 0 {
            crate::tell!("left out: {} points that need more than {MOST_STEPS} steps a run", plan.left_out);
        }
        if !self.holds {
            crate::tell!(
                "NOT AS PROVEN: a scheme that is proven to gain nothing gained energy below its limit"
            );
        }
    }
}

/// Three digits after the point, rounded down: a step must not be rounded up.
fn digits(x: f64) -> String {
    format!("{:.3}", (1e3 * x).floor() / 1e3)
}
