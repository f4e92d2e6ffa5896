//! Rows of runs with contact that opens and closes, the limits that follow from them, and the step to recommend.

use serde::Serialize;

use super::rows::softest_penalties;
use super::{GIVEN, Number, Subject, VerifyRow};
use bipenalty::impact::{Passage, Run};
use bipenalty::stability::AnyModel;
use bipenalty::verify::PenaltyPoint;
use bipenalty::verify::opening::{Gain, Load, least_gain};

/// What one run has gained. Steps are dt over the contact-free critical step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpeningRow {
    /// Name of the scene.
    pub scene: String,
    /// `lumped`, `averaged`, `consistent`, or gamma.
    pub mass: String,
    /// gamma of the mass matrix; empty for matrices.
    pub gamma: Option<Number>,
    /// Elements of all bars or bodies; empty for matrices.
    pub elements: Option<usize>,
    /// Name of the scheme.
    pub scheme: &'static str,
    /// `impact` or `sustained`.
    pub load: &'static str,
    /// beta_s.
    pub stiffness_penalty: Number,
    /// r.
    pub ratio: Number,
    /// The linear limit, the smaller one of closed and open contact.
    pub predicted: Number,
    /// C of the run.
    pub relative_courant: Number,
    /// Largest net work of the contacts on the bars over the energy put in.
    pub energy_gain: Number,
    /// Energy at the end over the energy put in; 1 for a perfect scheme.
    pub energy_ratio: Number,
    /// How often a contact has opened or closed.
    pub switches: u64,
    /// Steps done.
    pub steps: u64,
    /// Whether the gain counts: more than the mean energy of an element.
    pub gains: bool,
    /// dt, s.
    pub time_step: Number,
    /// s = beta_s w, N/m, of the contact of smallest scale w, the softest.
    pub penalty_stiffness: Option<Number>,
    /// m = s/(r omega_ref^2), kg, of the same contact.
    pub penalty_mass: Option<Number>,
}

impl OpeningRow {
    /// The row of `run` under `load` at `point`.
    pub fn new(run: &Run, load: Load, point: PenaltyPoint, predicted: f64, found: &Gain) -> Self {
        let model = run.model();
        let penalties = Subject::of_bars(model).penalties(point.stiffness_penalty.get(), point.ratio.get());
        Self {
            time_step: Number(run.time_step()),
            penalty_stiffness: penalties.map(|(stiffness, _)| stiffness),
            penalty_mass: penalties.map(|(_, mass)| mass),
            scene: model.scene().name().to_owned(),
            mass: model.mass().name(),
            gamma: Some(Number(model.mass().gamma())),
            elements: Some(model.scene().elements()),
            scheme: run.scheme().facts().name,
            load: load.name(),
            stiffness_penalty: Number(point.stiffness_penalty.get()),
            ratio: Number(point.ratio.get()),
            predicted: Number(predicted),
            relative_courant: Number(run.relative_courant()),
            energy_gain: Number(found.energy_gain),
            energy_ratio: Number(found.energy_ratio),
            switches: found.switches,
            steps: found.steps,
            gains: found.energy_gain > least_gain(model),
        }
    }

    /// The row of a passage of `model`, matrices or a mesh, at `point`.
    pub fn of_passage(
        model: &AnyModel,
        passage: &Passage,
        point: PenaltyPoint,
        predicted: f64,
        found: &Gain,
    ) -> Self {
        let (beta_s, ratio) = (point.stiffness_penalty.get(), point.ratio.get());
        let penalties = softest_penalties(passage.encounter().pencil(), beta_s, ratio);
        let parts = model.elements().unwrap_or(passage.encounter().pencil().size());
        Self {
            time_step: Number(passage.time_step()),
            penalty_stiffness: penalties.map(|(stiffness, _)| stiffness),
            penalty_mass: penalties.map(|(_, mass)| mass),
            scene: model.name().to_owned(),
            mass: model.mass().map_or(GIVEN.to_owned(), |mass| mass.name()),
            gamma: model.mass().map(|mass| Number(mass.gamma())),
            elements: model.elements(),
            scheme: passage.scheme().facts().name,
            load: Load::Impact.name(),
            stiffness_penalty: Number(point.stiffness_penalty.get()),
            ratio: Number(point.ratio.get()),
            predicted: Number(predicted),
            relative_courant: Number(passage.time_step() / passage.encounter().critical_step()),
            energy_gain: Number(found.energy_gain),
            energy_ratio: Number(found.energy_ratio),
            switches: found.switches,
            steps: found.steps,
            gains: found.energy_gain > 1.0 / parts as f64,
        }
    }

    /// Whether both belong to one limit: all but load and step are the same.
    fn is_beside(&self, other: &Self) -> bool {
        let penalties = |row: &Self| (row.stiffness_penalty, row.ratio);
        (&self.scene, &self.mass, self.scheme) == (&other.scene, &other.mass, other.scheme)
            && penalties(self) == penalties(other)
    }
}

/// The rows of each limit; `rows` must have them together.
pub fn scans(rows: &[OpeningRow]) -> impl Iterator<Item = &[OpeningRow]> {
    rows.chunk_by(OpeningRow::is_beside)
}

/// The smallest C of a scan that gains; infinite if none does.
fn first_gain(scan: &[OpeningRow]) -> f64 {
    let gaining = scan.iter().filter(|row| row.gains).map(|row| row.relative_courant.0);
    gaining.fold(f64::INFINITY, f64::min)
}

/// The largest C of a scan below every one that gains; 0 if the smallest does. Larger ones may be free of gain again.
fn last_without_gain(scan: &[OpeningRow]) -> f64 {
    let first = first_gain(scan);
    let below = scan.iter().map(|row| row.relative_courant.0).filter(|c| *c < first);
    below.fold(0.0, f64::max)
}

impl VerifyRow {
    /// The row of a scan: no step up to `stable_at` gains energy, `unstable_at` is the first that does (`inf`: none of
    /// the scan), `agrees` if linear stability was enough. `contact_free_courant` is c0 dt/h of C = 1.
    pub fn opening(scan: &[OpeningRow], contact_free_courant: f64) -> Option<Self> {
        let row = scan.first()?;
        let first = first_gain(scan);
        let free_step = row.time_step.0 / row.relative_courant.0;
        let gaining = scan.iter().filter(|row| row.relative_courant.0 == first);
        let strongest = gaining.max_by(|a, b| a.energy_gain.0.total_cmp(&b.energy_gain.0));
        let growth = |row: &OpeningRow| 0.5 * row.energy_gain.0.ln_1p() / row.steps as f64;
        Some(Self {
            scene: row.scene.clone(),
            mass: row.mass.clone(),
            gamma: row.gamma,
            elements: row.elements,
            scheme: row.scheme,
            contact: "opening",
            stiffness_penalty: row.stiffness_penalty,
            ratio: row.ratio,
            predicted: Some(Number(row.predicted.0 * contact_free_courant)),
            stable_at: Number(last_without_gain(scan) * contact_free_courant),
            unstable_at: Number(first * contact_free_courant),
            steps: scan.iter().map(|row| row.steps).max().unwrap_or(0),
            growth: Number(strongest.map_or(0.0, growth)),
            agrees: Some(first.is_infinite()),
            predicted_growth: None,
            steps_needed: None,
            islands: String::new(),
            predicted_step: Some(Number(row.predicted.0 * free_step)),
            stable_step: Number(last_without_gain(scan) * free_step),
            unstable_step: Number(first * free_step),
            penalty_stiffness: row.penalty_stiffness,
            penalty_mass: row.penalty_mass,
        })
    }
}

/// The step to take with a scheme and a ratio when contact opens and closes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recommendation {
    /// Name of the scheme.
    pub scheme: &'static str,
    /// `lumped`, `averaged`, `consistent`, or gamma.
    pub mass: String,
    /// r.
    pub ratio: Number,
    /// The largest beta_s of the scans.
    pub largest_stiffness_penalty: Number,
    /// C = dt/dt_cr of the contact-free bars up to which no scanned step gained energy, for any scene, load and beta_s;
    /// 0 if there is none.
    pub relative_courant: Number,
    /// The least share of the energy that was left after an impact with a step up to this C; empty if C = 0.
    pub energy_ratio: Option<Number>,
}

impl Recommendation {
    /// What follows from `rows`, in the order in which scheme, mass and ratio first appear.
    pub fn all(rows: &[OpeningRow]) -> Vec<Self> {
        let mut groups: Vec<Vec<&[OpeningRow]>> = Vec::new();
        let of = |scan: &[OpeningRow]| (scan[0].scheme, scan[0].mass.clone(), scan[0].ratio);
        for scan in scans(rows) {
            match groups.iter_mut().find(|group| of(group[0]) == of(scan)) {
                Some(group) => group.push(scan),
                None => groups.push(vec![scan]),
            }
        }
        groups.iter().map(|scans| Self::of(scans)).collect()
    }

    fn of(scans: &[&[OpeningRow]]) -> Self {
        let (rows, first) = (|| scans.iter().copied().flatten(), &scans[0][0]);
        let courant = scans.iter().map(|scan| last_without_gain(scan)).fold(f64::INFINITY, f64::min);
        let kept = rows().filter(|row| row.load == Load::Impact.name() && row.relative_courant.0 <= courant);
        Self {
            scheme: first.scheme,
            mass: first.mass.clone(),
            ratio: first.ratio,
            largest_stiffness_penalty: Number(rows().map(|row| row.stiffness_penalty.0).fold(0.0, f64::max)),
            relative_courant: Number(courant),
            energy_ratio: kept.map(|row| row.energy_ratio.0).reduce(f64::min).map(Number),
        }
    }
}
