//! The bouncing bar of Doyen, Ern, Piperno (SIAM J. Sci. Comput. 33, 2011) by every scheme: energy, oscillation of the contact
//! force, convergence. Each at its own stable step: C of the contact-free step.

use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Ending, Exact, Recording, Run, Summary};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::built_in;
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

/// What a row of the comparison says.
#[derive(Debug, Clone, Copy)]
struct Row {
    /// Energy at the end over the start.
    energy: f64,
    /// rms of the force error over the peak.
    error: f64,
    /// Peak over the exact peak, minus 1.
    overshoot: f64,
    /// Total variation of the force over that of the exact one.
    variation: f64,
}

fn row(scheme: SchemeName, elements: usize, ratio: f64, c: f64) -> Row {
    let scene = built_in("bouncing-bar").unwrap().unwrap().with_elements(elements).unwrap();
    let model = Model::new(scene.clone(), MassMatrix::LUMPED, PenaltyMass::Consistent);
    let beta_s = StiffnessPenalty::new(1e4).unwrap();
    let run = Run::new(model, scheme, beta_s, Ratio::new(ratio).unwrap()).unwrap();
    let run = run.with_relative_courant(c).unwrap();
    let history = run.execute(&Recording::default(), None).unwrap();
    assert_eq!(history.ending, Ending::Finished, "{} r = {ratio}", scheme.name());
    let exact = Exact::of(&scene, run.duration()).unwrap();
    let summary = Summary::of(&run, &history);
    let variation = |force: &[f64]| force.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>();
    let forces: Vec<f64> = history.forces(0).collect();
    let reference: Vec<f64> = history.time.iter().map(|t| exact.force(*t)).collect();
    Row {
        energy: summary.energy_ratio.unwrap(),
        error: summary.force_error.unwrap(),
        overshoot: forces.iter().fold(0.0, |a: f64, f| a.max(*f)) / exact.peak_force() - 1.0,
        variation: variation(&forces) / variation(&reference),
    }
}

/// Scheme, r and C: central differences at what they stand, PC and Park as in the paper, the others close to dt_cr.
const CASES: [(SchemeName, f64, f64); 10] = [
    (SchemeName::CentralDifference, 1.0, 0.5),
    (SchemeName::PredictorCorrector, 1.0, 0.5),
    (SchemeName::PredictorCorrector, 0.25, 0.95),
    (SchemeName::Park, 1.0, 0.5),
    (SchemeName::Buffered, 1.0, 0.95),
    (SchemeName::Buffered, 0.25, 0.95),
    (SchemeName::Lagrange, 1.0, 0.95),
    (SchemeName::MoreauJean, 1.0, 0.95),
    (SchemeName::PaoliSchatzman, 1.0, 0.95),
    (SchemeName::MassRedistribution, 1.0, 0.95),
];

#[test]
fn the_bouncing_bar_row_by_row() {
    for (scheme, ratio, c) in CASES {
        let [coarse, middle, fine] = [100, 200, 400].map(|elements| row(scheme, elements, ratio, c));
        let order = 0.5 * (coarse.error / fine.error).log2();
        let Row { energy, error, overshoot, variation } = fine;
        println!(
            "{:20} r = {ratio:4} C = {c:4}: energy {energy:.4}, force error {error:.4} (order {order:.2}), overshoot {overshoot:.3}, variation {variation:.2}",
            scheme.name()
        );
        if scheme == SchemeName::CentralDifference {
            // They chatter: a force as wrong as the force itself, and more so on a finer mesh.
            assert!(error > 0.2 && variation > 10.0, "{fine:?}");
            continue;
        }
        // A force that jumps converges in the mean square like h^(1/2) at best, like h^(1/3) where the mesh disperses.
        assert!(
            error < 0.05 && middle.error < 1.2 * coarse.error && order > 0.2,
            "{} {fine:?} {order}",
            scheme.name()
        );
        assert!(variation < 8.0 && overshoot < 0.4, "{} {fine:?}", scheme.name());
        assert!((energy - 1.0).abs() < 0.02, "{} {fine:?}", scheme.name());
    }
}
