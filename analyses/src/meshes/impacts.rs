//! The studies of impact: a block that is held at its sides and hits a wall, by every scheme, beside its exact solution.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use crate::error::{Refusal, Result};
use crate::record::{Number, StudyRow};
use bipenalty::impact::{Comparison, Encounter, Exact, Passage, Summary, exact};
use bipenalty::mesh::MeshScene;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::schemes::{Scheme, SchemeName};
use bipenalty::stability::{AnyModel, AnyScene};
use bipenalty::verify::{PenaltyPoint, linear_step};

/// Cells across the block for each so many along it.
const SLENDER: usize = 10;

/// A step that is meant to be as long as it may be is this share of the linear limit of its scheme.
pub const SHARE: f64 = 0.95;

/// The share of the contact-free step in the paper.
const PAPER: f64 = 0.5;

/// The penalties of the studies where another thing is varied.
const STIFF: f64 = 1e4;

/// How fine the studies are.
#[derive(Debug, Clone)]
pub struct ImpactFineness {
    /// Cells along the block, each mesh twice as fine as the one before.
    pub cells: Vec<usize>,
    /// Cells along the block where the mesh is not varied.
    pub usual: usize,
    /// Stiffness penalties.
    pub penalties: Vec<f64>,
}

impl ImpactFineness {
    /// For the figures.
    pub fn figures() -> Self {
        let decades = (-1..=12).map(|exponent| 10_f64.powi(exponent)).collect();
        Self { cells: vec![10, 20, 40, 80, 160], usual: 80, penalties: decades }
    }

    /// For a test.
    pub fn quick() -> Self {
        Self { cells: vec![10, 20], usual: 10, penalties: vec![1.0, 1e4, 1e12] }
    }
}

/// How long a step is.
#[derive(Clone, Copy, PartialEq)]
enum Pace {
    /// A share of the contact-free step.
    Free(f64),
    /// A share of the linear limit of the scheme.
    Limit(f64),
}

/// A block of so many cells with its model and its exact solution.
struct Block {
    cells: usize,
    model: Arc<AnyModel>,
    encounter: Encounter,
    exact: Exact,
    duration: f64,
    cell: f64,
}

/// Of steel, 20 mm x 200 mm, at 1 m/s; the wave is back after 2/3 of the time.
fn scene(cells: usize) -> String {
    let across = (cells / SLENDER).max(1);
    format!(
        "name = \"plane-impact\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"block\"\nbox = [0.02, 0.2]\n\
         cells = [{across}, {cells}]\nelement = \"quad4\"\nyoungs_modulus = 210e9\npoissons_ratio = 0.3\ndensity = 7850.0\n\
         velocity = [0.0, -1.0]\n[[contact]]\nsurfaces = [\"block.bottom\", \"wall\"]\n\
         [[hold]]\nsurface = \"block.left\"\ndirections = [\"x\"]\n[[hold]]\nsurface = \"block.right\"\ndirections = [\"x\"]\n\
         [impact]\nduration = 1e-4\n"
    )
}

impl Block {
    fn new(cells: usize) -> Result<Self> {
        let mesh = MeshScene::parse(&scene(cells), "plane-impact.toml")?;
        let duration = mesh.impact.as_ref().map_or(0.0, |impact| impact.duration);
        let scene = AnyScene::Mesh(mesh);
        let model = Arc::new(AnyModel::new(&scene, None, PenaltyMass::Consistent)?);
        let encounter = Encounter::of_scene(&scene, &model)?;
        let exact = exact(&scene, duration).ok_or_else(|| {
            Refusal::new("plane-impact", "no exact solution", "a block that moves as a bar")
        })?;
        Ok(Self { cells, model, encounter, exact, duration, cell: 0.2 / cells as f64 })
    }

    /// The impact by one scheme at (beta_s, r); `clock` also measures the time of its steps.
    fn row(
        &self,
        study: &'static str,
        scheme: SchemeName,
        (beta_s, ratio): (f64, f64),
        pace: Pace,
        clock: bool,
    ) -> Result<StudyRow> {
        let scheme: Arc<dyn Scheme> = scheme.into();
        let point =
            PenaltyPoint { stiffness_penalty: StiffnessPenalty::new(beta_s)?, ratio: Ratio::new(ratio)? };
        let (courant, limit) = match pace {
            Pace::Free(share) => (share, ""),
            Pace::Limit(share) => {
                let limit = linear_step(&self.model, &scheme, point)?;
                (share * limit.relative, limit.basis.text())
            }
        };
        let penalty = self.encounter.penalty(beta_s, ratio);
        let facts = scheme.facts();
        let passage = Passage::new(self.encounter.clone(), scheme, penalty, courant, self.duration)?;
        let dt = passage.time_step();
        let mut comparison = Comparison::new(self.exact.clone(), facts.search, dt, self.cell);
        let (mut impulse, mut expected, mut gained) = (0.0, 0.0, 0.0_f64);
        let outcome = passage.stream(1, None, |time, motion| {
            let state = motion.state();
            let force: f64 = state.force.iter().sum();
            let gap = state.gap.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            gained = gained.max(-state.balance_work);
            impulse += dt * force;
            expected += dt * comparison.expected(time);
            comparison.note(time, force, gap);
        })?;
        let seconds = if clock { Some(Number(seconds(&passage)?)) } else { None };
        let summary = Summary::new(comparison.finish(), outcome.kept(), outcome.switches);
        Ok(StudyRow {
            study,
            scheme: facts.name,
            cells: self.cells,
            unknowns: self.encounter.pencil().size(),
            contacts: self.encounter.pencil().gaps().len(),
            stiffness_penalty: Number(beta_s),
            ratio: Number(ratio),
            relative_courant: Number(courant),
            limit,
            steps: outcome.steps,
            force_error: summary.force_error.map(Number),
            impulse_error: (expected > 0.0).then(|| Number(impulse / expected - 1.0)),
            overshoot: summary.oscillation[0].map(Number),
            variation: summary.oscillation[1].map(Number),
            steady_relative_gap: summary.steady_relative_gap.map(Number),
            energy_ratio: summary.energy_ratio.map(Number),
            energy_gain: Number(gained / outcome.energy[0].stored()),
            switches: summary.switches,
            seconds,
        })
    }
}

/// The median time of nine passages that record nothing, s.
fn seconds(passage: &Passage) -> Result<f64> {
    let mut times = [0.0; 9];
    for time in &mut times {
        let mut motion = passage.prepare(false)?;
        let begun = Instant::now();
        (0..passage.steps()).for_each(|_| motion.step());
        *time = begun.elapsed().as_secs_f64();
    }
    times.sort_unstable_by(f64::total_cmp);
    Ok(times[4])
}

/// Scheme and ratio of every line: the mass penalty at r = 1 and 1/4 for the schemes that have one, once for the others.
fn lines() -> Vec<(SchemeName, f64)> {
    use SchemeName::{Buffered, CentralDifference, Park, PredictorCorrector};
    let penalised = [CentralDifference, PredictorCorrector, Park, Buffered];
    let one = |scheme: &SchemeName| match penalised.contains(scheme) {
        true => vec![(*scheme, 1.0), (*scheme, 0.25)],
        false => vec![(*scheme, 1.0)],
    };
    SchemeName::ALL.iter().flat_map(one).collect()
}

fn blocks(cells: &[usize]) -> Result<Vec<Block>> {
    cells.par_iter().map(|cells| Block::new(*cells)).collect()
}

/// Errors over the size of the cells.
///
/// # Errors
/// None but what a mesh refuses.
pub fn cells(fine: &ImpactFineness) -> Result<Vec<StudyRow>> {
    let blocks = blocks(&fine.cells)?;
    let cases: Vec<_> =
        lines().into_iter().flat_map(|line| blocks.iter().map(move |block| (line, block))).collect();
    let row = |((scheme, ratio), block): &((SchemeName, f64), &Block)| {
        block.row("cells", *scheme, (STIFF, *ratio), Pace::Limit(SHARE), false)
    };
    cases.par_iter().map(row).collect()
}

/// Errors and gap over beta_s, at half the contact-free step as in the paper.
///
/// # Errors
/// As [`cells`].
pub fn penalty(fine: &ImpactFineness) -> Result<Vec<StudyRow>> {
    use SchemeName::{Buffered, CentralDifference, Park, PredictorCorrector};
    let block = Block::new(fine.usual)?;
    let mut cases = Vec::new();
    for scheme in [CentralDifference, PredictorCorrector, Park, Buffered] {
        cases.extend(fine.penalties.iter().map(|beta_s| (scheme, *beta_s)));
    }
    let row = |(scheme, beta_s): &(SchemeName, f64)| {
        block.row("penalty", *scheme, (*beta_s, 1.0), Pace::Free(PAPER), false)
    };
    cases.par_iter().map(row).collect()
}

/// Oscillation of the force at r = 1, 1/4 and without a mass penalty, each scheme at its own stable step.
///
/// # Errors
/// As [`cells`].
pub fn oscillation(fine: &ImpactFineness) -> Result<Vec<StudyRow>> {
    let block = Block::new(fine.usual)?;
    let cases: Vec<_> =
        [1.0, 0.25, f64::INFINITY].iter().flat_map(|r| SchemeName::ALL.map(|scheme| (scheme, *r))).collect();
    let row = |(scheme, ratio): &(SchemeName, f64)| {
        block.row("oscillation", *scheme, (STIFF, *ratio), Pace::Limit(SHARE), false)
    };
    cases.par_iter().map(row).collect()
}

/// Error against run time, one run after the other.
///
/// # Errors
/// As [`cells`].
pub fn cost(fine: &ImpactFineness) -> Result<Vec<StudyRow>> {
    let blocks = blocks(&fine.cells)?;
    let mut rows = Vec::new();
    for (scheme, ratio) in lines() {
        for block in &blocks {
            rows.push(block.row("cost", scheme, (STIFF, ratio), Pace::Limit(SHARE), true)?);
        }
    }
    Ok(rows)
}

/// Whether a scheme that is proven to gain nothing, at a step below its own limit, has gained nothing: 4 epsilon a step of the
/// energy.
pub fn holds(row: &StudyRow) -> bool {
    let proven =
        SchemeName::ALL.iter().any(|known| known.name() == row.scheme && known.facts().gains_nothing);
    let rounding = 4.0 * f64::EPSILON * (row.steps + 1) as f64;
    !proven || row.limit.is_empty() || row.energy_gain.0 <= rounding
}
