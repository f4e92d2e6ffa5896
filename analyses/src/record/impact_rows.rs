//! Rows of contact-impact runs.

use serde::Serialize;

use super::{Number, Subject};
use bipenalty::impact::{Ending, Exact, History, Mesh, Run, StressField, Summary};

/// One step of a run at one contact. The energies are those of all bars and all contacts; in every row
/// kinetic + strain + penalty energy + loss - body work is what it is in the first, to rounding (the definitions are
/// those of [`bipenalty::schemes::Energy`]).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistoryRow {
    /// s.
    pub time: Number,
    /// lambda, N, positive in compression.
    pub contact_force: Number,
    /// g/h, positive in penetration.
    pub relative_gap: Number,
    /// J.
    pub kinetic_energy: Number,
    /// J.
    pub strain_energy: Number,
    /// Work that the bars have done on the contacts, J.
    pub contact_work: Number,
    /// Held by the penalties of the closed contacts, J.
    pub penalty_energy: Number,
    /// Work of the body force since u = 0, J.
    pub body_work: Number,
    /// Lost by the scheme, J; negative is a gain.
    pub loss: Number,
}

impl HistoryRow {
    /// The rows of `contact` (from 0); the history must have energies.
    pub fn of(history: &History, contact: usize) -> Vec<Self> {
        let rows = history.time.iter().zip(history.forces(contact)).zip(history.relative_gaps(contact));
        rows.zip(&history.energy)
            .map(|(((time, force), gap), energy)| Self {
                time: Number(*time),
                contact_force: Number(force),
                relative_gap: Number(gap),
                kinetic_energy: Number(energy.kinetic),
                strain_energy: Number(energy.strain),
                contact_work: Number(energy.contact_work),
                penalty_energy: Number(energy.penalty),
                body_work: Number(energy.body_work),
                loss: Number(energy.loss),
            })
            .collect()
    }
}

/// The stress of one element at one time, beside the exact one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StressRow {
    /// s.
    pub time: Number,
    /// Centre of the element with the bars laid end to end, m.
    pub position: Number,
    /// Pa, positive in tension.
    pub stress: Number,
    /// Pa; empty without an exact solution.
    pub exact: Option<Number>,
}

impl StressRow {
    /// The rows of one time, element by element.
    pub fn of(run: &Run, exact: Option<&Exact>, field: &StressField) -> Vec<Self> {
        let mesh = Mesh::new(run.model().scene());
        let centres = mesh.centres().into_iter().zip(&field.stress);
        centres
            .map(|((bar, x), stress)| Self {
                time: Number(field.time),
                position: Number(mesh.start(bar) + x),
                stress: Number(*stress),
                exact: exact.and_then(|exact| exact.stress(bar, x, field.time)).map(Number),
            })
            .collect()
    }
}

/// A run in one line.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImpactRow {
    /// Name of the scene.
    pub scene: String,
    /// `lumped`, `averaged`, `consistent`, or gamma.
    pub mass: String,
    /// Name of the scheme.
    pub scheme: &'static str,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// C = dt/dt_cr of the contact-free scene.
    pub relative_courant: Number,
    /// rms of force minus exact force, over the peak exact force.
    pub force_error: Option<Number>,
    /// Median of g/h over the middle half of the first exact contact interval.
    pub steady_relative_gap: Option<Number>,
    /// Energy at the end over that at the start.
    pub energy_ratio: Option<Number>,
    /// How often a contact has opened or closed.
    pub switches: u64,
    /// Steps done.
    pub steps: u64,
    /// `finished`, `finished with 5.1 times its energy` where that is more than 1 (` (none from contact)` where the scheme
    /// alone makes it swing), or the step and time at which the run blew up or was stopped.
    pub ending: String,
    /// Whether contact has added energy, and the run ended with more than it was given.
    #[serde(skip)]
    pub gained: bool,
    /// dt, s.
    pub time_step: Number,
    /// s = beta_s w, N/m, of the contact of smallest scale w, the softest.
    pub penalty_stiffness: Option<Number>,
    /// m = s/(r omega_ref^2), kg, of the same contact.
    pub penalty_mass: Option<Number>,
    /// The largest force over the largest exact one, minus 1.
    pub overshoot: Option<Number>,
    /// The total variation of the force over that of the exact one.
    pub variation: Option<Number>,
}

impl ImpactRow {
    /// The line of a run with penalties (beta_s, r).
    pub fn new(run: &Run, beta_s: f64, ratio: f64, history: &History) -> Self {
        let summary = Summary::of(run, history);
        let model = run.model();
        let penalties = Subject::of_bars(model).penalties(beta_s, ratio);
        Self {
            scene: model.scene().name().to_owned(),
            mass: model.mass().name(),
            scheme: run.scheme().facts().name,
            stiffness_penalty: Number(beta_s),
            ratio: Number(ratio),
            relative_courant: Number(run.relative_courant()),
            time_step: Number(run.time_step()),
            penalty_stiffness: penalties.map(|(stiffness, _)| stiffness),
            penalty_mass: penalties.map(|(_, mass)| mass),
            ..Self::measured(&summary, history.steps, history.ending)
        }
    }

    /// What was measured of a run that is not named yet.
    pub(super) fn measured(summary: &Summary, steps: u64, ending: Ending) -> Self {
        let (source, ratio) =
            (if summary.gained { "" } else { " (none from contact)" }, summary.energy_ratio);
        let energy = ratio.filter(|_| summary.more_energy);
        let more = energy.map_or(String::new(), |x| format!(" with {} times its energy{source}", digits(x)));
        Self {
            scene: String::new(),
            mass: String::new(),
            scheme: "",
            stiffness_penalty: Number(0.0),
            ratio: Number(0.0),
            relative_courant: Number(0.0),
            force_error: summary.force_error.map(Number),
            steady_relative_gap: summary.steady_relative_gap.map(Number),
            energy_ratio: summary.energy_ratio.map(Number),
            switches: summary.switches,
            steps,
            ending: match ending {
                Ending::Finished => "finished".to_owned() + &more,
                Ending::Stopped { step, time } => format!("stopped at step {step} (t = {time:e} s){more}"),
                Ending::BlewUp { step, time } => format!("blew up by step {step} (t = {time:e} s)"),
            },
            gained: summary.gained && summary.more_energy,
            time_step: Number(0.0),
            penalty_stiffness: None,
            penalty_mass: None,
            overshoot: summary.oscillation[0].map(Number),
            variation: summary.oscillation[1].map(Number),
        }
    }
}

/// A ratio above 1 with two digits, or as many as tell it from 1.
fn digits(ratio: f64) -> String {
    let digits = (1.0 - (ratio - 1.0).log10()).ceil().clamp(1.0, 16.0) as usize;
    if ratio < 1e4 { format!("{ratio:.digits$}") } else { format!("{ratio:.1e}") }
}
