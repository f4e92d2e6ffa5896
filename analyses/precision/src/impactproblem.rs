//! The impacts that are stepped, and how far a run is from the exact solution.

use super::{Family, Measurement};
use bipenalty::error::Result;
use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Ending, Exact, History, Mesh, Recording, Run, Summary};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Scene, load};
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

/// The scenes, each with an exact solution.
pub const SCENES: [&str; 3] = ["signorini", "hunek", "bouncing-bar"];

/// beta_s of every impact.
const STIFFNESS_PENALTY: f64 = 1e4;

/// The stress is compared at so many equally spaced times.
const STRESS_TIMES: u32 = 10;

/// One impact at beta_s = 1e4 and r = 1 by one scheme.
#[derive(Debug, Clone)]
pub struct Impactproblem {
    /// Scene and mass matrix, such as `signorini-lumped`.
    pub name: String,
    /// SchemeName and relative Courant number.
    pub method: String,
    /// Elements of the first bar.
    pub elements: usize,
    run: Run,
}

/// Distances from the exact solution, each in a unit of the size of the impact, so that they can be compared:
///
/// ```text
/// force    rms over the steps of lambda - exact                                   / F
/// stress   rms over elements and 10 equally spaced times of sigma - exact         / (F/A)
/// gap      rms over the steps of g - exact (exact: 0 in contact)                  / (F L/(E A))
/// ```
/// with F the exact peak force and L, E, A of the first bar: F L/(E A) is its shortening under F.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpactErrors {
    /// Of the contact force.
    pub force: f64,
    /// Of the stress at the centres of the elements.
    pub stress: f64,
    /// Of the gap.
    pub gap: f64,
}

impl ImpactErrors {
    /// The errors by name.
    pub fn named(self) -> [(&'static str, f64); 3] {
        [("force", self.force), ("stress", self.stress), ("gap", self.gap)]
    }

    /// The names.
    pub const NAMES: [&'static str; 3] = ["force", "stress", "gap"];
}

impl Impactproblem {
    /// The impact of one of [`SCENES`] with `elements` in its first bar at dt = C times the contact-free critical step.
    ///
    /// # Errors
    /// What the scene and the run refuse.
    pub fn new(
        scene: &str,
        mass: MassMatrix,
        scheme: SchemeName,
        elements: usize,
        relative_courant: f64,
    ) -> Result<Self> {
        let scene = load(scene)?.with_elements(elements)?;
        let name = format!("{}-{}", scene.name(), mass.name());
        let model = Model::new(scene, mass, PenaltyMass::Consistent);
        let run = Run::new(model, scheme, StiffnessPenalty::new(STIFFNESS_PENALTY)?, Ratio::OPTIMAL)?;
        let run = run.with_relative_courant(relative_courant)?;
        let method = format!("{} C={relative_courant}", scheme.name());
        Ok(Self { name, method, elements, run })
    }

    /// Products M^-1 (f - K u) of a run.
    pub fn evaluations(&self) -> u64 {
        self.run.steps() * self.run.scheme().facts().solves as u64
    }

    /// Steps through the impact with nothing recorded.
    ///
    /// # Errors
    /// As [`Run::execute`].
    pub fn step_through(&self) -> Result<()> {
        let nothing =
            Recording { every: u64::MAX, energies: false, compare: false, stress_times: Vec::new() };
        std::hint::black_box(self.run.execute(&nothing, None)?);
        Ok(())
    }

    /// The errors of a recorded run, or how it failed.
    ///
    /// # Errors
    /// As [`Run::execute`].
    pub fn errors(&self) -> Result<std::result::Result<ImpactErrors, String>> {
        let time = |k: u32| self.run.duration() * f64::from(k) / f64::from(STRESS_TIMES);
        let stress_times = (1..=STRESS_TIMES).map(time).collect();
        let history =
            self.run.execute(&Recording { every: 1, energies: false, compare: true, stress_times }, None)?;
        Ok(match history.ending {
            Ending::BlewUp { step, .. } => Err(format!("blew up by step {step}")),
            Ending::Stopped { step, .. } => Err(format!("stopped at step {step}")),
            Ending::Finished => self.compare(&history).ok_or_else(|| "no exact solution".to_owned()),
        })
    }

    fn compare(&self, history: &History) -> Option<ImpactErrors> {
        let scene = self.run.model().scene();
        let exact = Exact::of(scene, self.run.duration())?;
        let (bar, peak) = (&scene.bars()[0], exact.peak_force());
        let shortening = peak * bar.length / (bar.youngs_modulus * bar.area);
        Some(ImpactErrors {
            force: Summary::of(&self.run, history).force_error?,
            stress: stress_error(scene, &exact, history)? / (peak / bar.area),
            gap: self.gap_error(&exact, history)? / shortening,
        })
    }

    /// m.
    fn gap_error(&self, exact: &Exact, history: &History) -> Option<f64> {
        let scene = self.run.model().scene();
        let h = *Mesh::new(scene).contact_lengths(self.run.model().mass()).first()?;
        let rows = history.time.iter().zip(history.relative_gaps(0));
        let differences: Option<Vec<f64>> =
            rows.map(|(t, gap)| Some(h * gap - exact_gap(scene, exact, *t)?)).collect();
        rms(&differences?)
    }

    /// A measurement of this impact and `quantity` without numbers.
    pub fn blank(&self, quantity: &str, status: super::Status) -> Measurement {
        let problem = format!("{}-{quantity}", self.name);
        Measurement::without_value(Family::Stepping, &problem, &self.method, self.elements, status)
    }
}

/// Pa.
fn stress_error(scene: &Scene, exact: &Exact, history: &History) -> Option<f64> {
    let centres = Mesh::new(scene).centres();
    let mut differences = Vec::new();
    for field in &history.stress {
        for ((bar, x), stress) in centres.iter().zip(&field.stress) {
            differences.push(stress - exact.stress(*bar, *x, field.time)?);
        }
    }
    rms(&differences)
}

/// The exact gap, m, positive in penetration, of a last bar on a wall or of two bars.
fn exact_gap(scene: &Scene, exact: &Exact, t: f64) -> Option<f64> {
    let distance = scene.impact()?.gaps.first().copied().unwrap_or(0.0);
    let left = exact.displacement(0, scene.bars()[0].length, t)?;
    let right = if scene.bars().len() > 1 { exact.displacement(1, 0.0, t)? } else { 0.0 };
    Some(left - right - distance)
}

fn rms(values: &[f64]) -> Option<f64> {
    let mean = values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
    mean.is_finite().then(|| mean.sqrt())
}
