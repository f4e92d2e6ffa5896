//! Orders of convergence in the number of elements, n = 50 to 3200: contact force and stress of the Signorini problem, C = 1/2.

#![allow(clippy::unwrap_used, clippy::panic)]

use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Exact, Mesh, Recording, Run, Summary};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::built_in;
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

const ELEMENTS: [usize; 7] = [50, 100, 200, 400, 800, 1600, 3200];

/// Force error and relative rms stress error at t = 0.05 s, when the wave is half way down the bar.
fn errors(elements: usize, mass: MassMatrix, scheme: SchemeName, beta_s: f64) -> [f64; 2] {
    let scene = built_in("signorini").unwrap().unwrap().with_elements(elements).unwrap();
    let model = Model::new(scene.clone(), mass, PenaltyMass::Consistent);
    let run = Run::new(model, scheme, StiffnessPenalty::new(beta_s).unwrap(), Ratio::OPTIMAL).unwrap();
    let recording = Recording { every: 1, energies: false, compare: true, stress_times: vec![0.05] };
    let history = run.execute(&recording, None).unwrap();
    let force = Summary::of(&run, &history).force_error.unwrap();
    let exact = Exact::of(&scene, run.duration()).unwrap();
    let field = &history.stress[0];
    let pairs = field.stress.iter().zip(Mesh::new(&scene).centres());
    let square: f64 =
        pairs.map(|(found, (bar, x))| (found - exact.stress(bar, x, field.time).unwrap()).powi(2)).sum();
    [force, (square / elements as f64).sqrt() / 0.1]
}

/// Slope of ln(error) against ln(1/n), least squares.
fn order(errors: &[f64]) -> f64 {
    let x: Vec<f64> = ELEMENTS.iter().map(|n| (*n as f64).ln()).collect();
    let y: Vec<f64> = errors.iter().map(|e| e.ln()).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(&x), mean(&y));
    let covariance: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    -covariance / x.iter().map(|x| (x - mx) * (x - mx)).sum::<f64>()
}

/// Scheme, mass matrix, beta_s, and the orders of the force and the stress error.
type Expected = (SchemeName, MassMatrix, f64, [f64; 2]);

/// Fitted over n = 50 to 3200. The solution jumps: an rms error of order p/(2 (p + 1)), 1/3 for a scheme of order 2 and 1/2
/// where nothing disperses, is all there can be, and the mean of a few wiggles makes it uneven. Central differences with a
/// stiff contact chatter: their force does not converge at all, their stress does.
const ORDERS: [Expected; 18] = [
    (SchemeName::CentralDifference, MassMatrix::LUMPED, 1.0, [0.46, 0.37]),
    (SchemeName::CentralDifference, MassMatrix::AVERAGED, 1.0, [0.33, 0.42]),
    (SchemeName::CentralDifference, MassMatrix::CONSISTENT, 1.0, [0.24, 0.30]),
    (SchemeName::PredictorCorrector, MassMatrix::LUMPED, 1.0, [0.44, 0.34]),
    (SchemeName::PredictorCorrector, MassMatrix::AVERAGED, 1.0, [0.34, 0.40]),
    (SchemeName::PredictorCorrector, MassMatrix::CONSISTENT, 1.0, [0.21, 0.31]),
    (SchemeName::Park, MassMatrix::LUMPED, 1.0, [0.52, 0.47]),
    (SchemeName::Park, MassMatrix::AVERAGED, 1.0, [0.27, 0.40]),
    (SchemeName::Park, MassMatrix::CONSISTENT, 1.0, [0.22, 0.33]),
    (SchemeName::CentralDifference, MassMatrix::LUMPED, 1e4, [0.0, 0.44]),
    (SchemeName::CentralDifference, MassMatrix::AVERAGED, 1e4, [0.0, 0.38]),
    (SchemeName::CentralDifference, MassMatrix::CONSISTENT, 1e4, [0.0, 0.38]),
    (SchemeName::PredictorCorrector, MassMatrix::LUMPED, 1e4, [0.35, 0.30]),
    (SchemeName::PredictorCorrector, MassMatrix::AVERAGED, 1e4, [0.11, 0.18]),
    (SchemeName::PredictorCorrector, MassMatrix::CONSISTENT, 1e4, [0.31, 0.32]),
    (SchemeName::Park, MassMatrix::LUMPED, 1e4, [0.37, 0.41]),
    (SchemeName::Park, MassMatrix::AVERAGED, 1e4, [0.24, 0.28]),
    (SchemeName::Park, MassMatrix::CONSISTENT, 1e4, [0.30, 0.30]),
];

/// How far a fitted order may be from the table.
const MARGIN: f64 = 0.03;

#[test]
fn force_and_stress_converge_with_the_orders_of_a_jump() {
    println!("beta_s scheme mass: order of force, of stress; errors for n = {ELEMENTS:?}");
    for (scheme, mass, beta_s, expected) in ORDERS {
        let rows: Vec<[f64; 2]> = ELEMENTS.iter().map(|n| errors(*n, mass, scheme, beta_s)).collect();
        for (k, expected) in expected.into_iter().enumerate() {
            let column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
            let found = order(&column);
            let what = ["force", "stress"][k];
            println!("{beta_s:5} {:20} {:10} {what:6} {found:6.3}  {column:.4?}", scheme.name(), mass.name());
            let place = format!("{} {} {beta_s} {what}", scheme.name(), mass.name());
            assert!((found - expected).abs() <= MARGIN, "{place}: {found} instead of {expected}");
        }
    }
}
