//! Bars written as matrices give what the engines of bars give.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Matrix;
use bipenalty::scene::load;
use bipenalty::schemes::SchemeName;
use bipenalty::sparse::Csr;
use bipenalty::spectrum::Uncertified;
use bipenalty::stability::{AnyModel, Asking, Grid, LimitOf, MeshModel, Model, Sweep};

/// The same matrices without what makes them a row of bars.
pub fn as_matrices(model: &Model) -> MeshModel {
    let pencil = model.pencil();
    let sparse = |matrix: &Matrix| {
        let n = matrix.size();
        let entries: Vec<_> = (0..n)
            .flat_map(|i| matrix.row(i).map(move |(j, a)| (i as u32, j as u32, a)).collect::<Vec<_>>())
            .collect();
        Matrix::Sparse(Csr::from_triplets(n, n, &entries))
    };
    let gaps = pencil.gaps().iter().map(|gap| gap.column.clone()).collect();
    let scales: Vec<f64> = pencil.gaps().iter().map(|gap| gap.scale).collect();
    let reference = Some(pencil.reference());
    MeshModel::from_matrices(sparse(pencil.stiffness()), sparse(pencil.mass()), gaps, &scales, reference)
        .unwrap()
}

pub fn bars(name: &str, elements: usize, mass: MassMatrix) -> Model {
    let scene = load(name).unwrap().with_elements(elements).unwrap();
    Model::new(scene, mass, PenaltyMass::Consistent)
}

/// Every point of a map, and the contact-free step, lie in the enclosure of the curve; none is wider than asked.
#[test]
fn bars_as_matrices_give_the_numbers_of_the_bar_engines() {
    let grid = Grid::new(
        &Sweep::list([0.0, 1e-6, 0.3, 10.0, 1e4, 1e9]),
        &Sweep::list([1e-2, 0.5, 1.0, 2.0, 1e3, f64::INFINITY]),
    )
    .unwrap();
    let mut wide = 0;
    for (name, elements) in [("signorini", 7), ("symmetric", 5), ("hunek", 9), ("bouncing-bar", 12)] {
        for mass in [MassMatrix::LUMPED, MassMatrix::AVERAGED, MassMatrix::CONSISTENT] {
            let model = bars(name, elements, mass);
            // C = omega_ref dt/2 of matrices against c0 dt/h of bars.
            let unit = (model.reference_eigenvalue() / model.reference_rate()).sqrt() / 2.0;
            let other = AnyModel::Mesh(Box::new(as_matrices(&model)));
            let model = AnyModel::Bars(model);
            let limits = [LimitOf::Spectrum, SchemeName::CentralDifference.into()];
            for (limit, tolerance) in limits.into_iter().zip([1e-3, 1e-9]) {
                let asking = Asking { limit, ..Asking::default() };
                let exact = model.map(&grid, &asking, &|_| ()).unwrap();
                let asking = Asking { tolerance: Some(tolerance), ..asking };
                let found = other.map(&grid, &asking, &|_| ()).unwrap();
                let points = |curves: &[bipenalty::stability::Curve]| {
                    curves.iter().flat_map(|curve| curve.points.clone()).collect::<Vec<_>>()
                };
                for (exact, found) in points(&exact).iter().zip(points(&found)) {
                    let exact = exact.step.unwrap();
                    let place = format!("{name}, {}, {found:?}, {exact:?}", mass.name());
                    assert_eq!(found.engine, "convex");
                    match found.step {
                        Ok(step) => {
                            assert!(step.lower <= exact.upper * unit, "{place}");
                            assert!(exact.lower * unit <= step.upper, "{place}");
                            assert!(step.upper / step.lower - 1.0 <= tolerance * (1.0 + 1e-6), "{place}");
                        }
                        // Far below t = 0 the terms of t P drown f, and what is left is said.
                        Err(Uncertified { value, width }) => {
                            let l = exact.omega_max.powi(2);
                            assert!(tolerance < 1e-6 && width < 1e-3, "{place}");
                            assert!(
                                value <= l * (1.0 + 1e-12) && l <= value * (1.0 + width + 1e-12),
                                "{place}"
                            );
                            wide += 1;
                        }
                    }
                }
            }
        }
    }
    // Of 864 points.
    assert!(wide < 50, "{wide}");
    println!("wider than asked: {wide}");
}

/// The step of the sufficient half, which bars have too where their contacts are unlike; the limit itself for one contact.
#[test]
fn the_predictor_corrector_of_matrices_is_that_of_bars_with_one_contact() {
    for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
        let model = bars("signorini", 8, mass);
        let unit = (model.reference_eigenvalue() / model.reference_rate()).sqrt() / 2.0;
        let other = AnyModel::Mesh(Box::new(as_matrices(&model)));
        let model = AnyModel::Bars(model);
        let asking = Asking { limit: SchemeName::PredictorCorrector.into(), ..Asking::default() };
        for (beta_s, ratio) in [(1.0, 1.0), (1e4, 1.0), (1e4, 0.5), (30.0, f64::INFINITY)] {
            let exact = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
            let found = other.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
            assert!(found.is_lower_bound() && found.lower <= exact.upper * unit, "{exact:?} {found:?}");
            // Beyond the contact-free step, where the closed contact alone would stand more, the bound is that step.
            let expected = (exact.critical_courant * unit).min(1.0);
            assert!((found.lower / expected - 1.0).abs() < 1e-5, "{exact:?} {found:?}");
        }
    }
}
