//! Evidence by chance: matrices without elements, and no memory for a factor.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Matrix;
use bipenalty::sparse::{Csr, SparseVector};
use bipenalty::spectrum::Evidence;
use bipenalty::stability::{AnyModel, AnyScene, Asking, Grid, MeshModel, Prover, Sweep};

use crate::scenes::TWO_BLOCKS;

fn without_elements(mass: MassMatrix) -> AnyModel {
    let finer = TWO_BLOCKS.replace("[6, 4]", "[30, 20]").replace("[5, 3]", "[25, 12]");
    let model =
        AnyModel::new(&AnyScene::parse(&finer, "b.toml").unwrap(), Some(mass), PenaltyMass::Consistent)
            .unwrap();
    let AnyModel::Mesh(mesh) = &model else { panic!() };
    let (k, m, gaps) = mesh.matrices();
    let scales: Vec<f64> = gaps.iter().map(|gap| gap.scale).collect();
    let columns = gaps.iter().map(|gap| gap.column.clone()).collect();
    AnyModel::Mesh(Box::new(MeshModel::from_matrices(k.clone(), m.clone(), columns, &scales, None).unwrap()))
}

/// Every point of a map holds the proven one, is as narrow as asked, and says how likely it is to be wrong.
#[test]
fn a_map_by_chance_holds_the_proven_one() {
    let model = without_elements(MassMatrix::LUMPED);
    let grid = Grid::new(
        &Sweep::list([0.0, 1e-3, 0.1, 1.0, 10.0, 1e4]),
        &Sweep::list([0.5, 1.0, 3.0, f64::INFINITY]),
    )
    .unwrap();
    let proven = model.map(&grid, &Asking { tolerance: Some(1e-6), ..Asking::default() }, &|_| ()).unwrap();
    let asking = Asking { tolerance: Some(1e-3), memory: Some(100_000), ..Asking::default() };
    let plan = model.plan(grid.len(), &asking).unwrap();
    assert!(
        matches!(plan.prover, Some(Prover::Chance { probability, steps }) if probability < 1e-12 && steps > 300),
        "{plan:?}"
    );
    let found = model.map(&grid, &asking, &|_| ()).unwrap();
    for (exact, found) in proven.iter().zip(&found).flat_map(|(a, b)| a.points.iter().zip(&b.points)) {
        assert_eq!(found.engine, "convex-chance");
        let (exact, step) = (exact.step.unwrap(), found.step.unwrap());
        let place = format!("{exact:?} {step:?}");
        assert!(step.lower <= exact.upper && exact.lower <= step.upper, "{place}");
        assert!(step.upper / step.lower - 1.0 <= 1.01e-3, "{place}");
        assert!(matches!(step.evidence, Evidence::Probability(p) if (1e-15..1e-12).contains(&p)), "{place}");
    }
}

#[test]
fn what_chance_cannot_do_is_said() {
    let asking = Asking { memory: Some(100_000), ..Asking::default() };
    let narrow = Asking { tolerance: Some(1e-9), ..asking.clone() };
    let place = |model: &AnyModel, asking: &Asking| model.critical_step(1.0, 1.0, asking).unwrap_err().place;
    assert_eq!(place(&without_elements(MassMatrix::LUMPED), &narrow), "tolerance");
    // A uniform start needs the root of the mass.
    assert_eq!(place(&without_elements(MassMatrix::CONSISTENT), &asking), "memory of the factorisation");
    // An indefinite stiffness breaks the premise: nothing is claimed.
    let n = 40_u32;
    let k: Vec<_> = (0..n).map(|i| (i, i, if i == 7 { -3.0 } else { 1.0 + f64::from(i) })).collect();
    let stiffness = Matrix::Sparse(Csr::from_triplets(n as usize, n as usize, &k));
    let gap = SparseVector(vec![(0, 1.0)]);
    let model =
        MeshModel::from_matrices(stiffness, Matrix::Diagonal(vec![1.0; n as usize]), vec![gap], &[1.0], None);
    let model = AnyModel::Mesh(Box::new(model.unwrap()));
    let tight = Asking { memory: Some(10), ..Asking::default() };
    assert!(model.critical_step(1.0, 1.0, &tight).unwrap().step.is_err());
    assert!(model.critical_step(1.0, 1.0, &Asking::default()).unwrap().step.is_ok());
}
