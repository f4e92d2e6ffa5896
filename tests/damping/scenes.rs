//! Random bars, meshes and dampings.

use bipenalty::damping::Damping;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::{Gap, Matrix, Penalty, Pencil};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::sparse::{Csr, SparseVector};
use bipenalty::stability::Model;

use crate::numbers::Numbers;

fn penalty(numbers: &mut Numbers, reference: f64) -> Penalty {
    let ratio = if numbers.next() < 0.2 { f64::INFINITY } else { 10_f64.powf(numbers.between(-1.5, 2.0)) };
    let stiffness = if numbers.next() < 0.1 { 0.0 } else { 10_f64.powf(numbers.between(-2.0, 4.0)) };
    Penalty { stiffness, rate: ratio * reference, form: PenaltyMass::Consistent }
}

/// One bar to four, up to five contacts.
pub fn bars(numbers: &mut Numbers) -> (Pencil, Penalty) {
    let scene = if numbers.next() < 0.5 {
        numbers.scene()
    } else {
        let count = 2 + (3.0 * numbers.next()) as usize;
        let ends = [End::Free, End::Wall, End::Fixed];
        let (left, right) = (numbers.one_of(&ends), numbers.one_of(&ends));
        let row = (0..count).map(|_| numbers.bar(0.7)).collect();
        Scene::new("row", left, row, right, None).unwrap()
    };
    let model = Model::new(scene, numbers.mass(), PenaltyMass::Consistent);
    let penalty = penalty(numbers, model.reference_eigenvalue());
    (model.pencil(), penalty)
}

/// A bar of so many elements of unit size between two ends.
pub fn model(left: End, elements: usize, mass: MassMatrix, right: End) -> Model {
    let scene = Scene::new("one", left, vec![Bar::unit(elements)], right, None).unwrap();
    Model::new(scene, mass, PenaltyMass::Consistent)
}

/// A, B and c from far below to above what halves the step, each left out now and then.
pub fn damping(numbers: &mut Numbers, pencil: &Pencil) -> Damping {
    let omega = pencil.reference().sqrt();
    let mut part = |unit: f64| match numbers.next() < 0.3 {
        true => 0.0,
        false => unit * 10_f64.powf(numbers.between(-3.0, 1.0)),
    };
    Damping::new(part(omega), part(1.0 / omega), part(1.0 / omega)).unwrap()
}

/// Full matrices, and contacts that share unknowns: (K, M, gaps), with the square of a frequency of their size.
pub fn mesh(numbers: &mut Numbers) -> (Matrix, Matrix, Vec<Gap>, Penalty) {
    let n = 2 + (7.0 * numbers.next()) as usize;
    let mut square = |rank: usize, own: f64| {
        let factor: Vec<Vec<f64>> =
            (0..n).map(|_| (0..rank).map(|_| numbers.between(-1.0, 1.0)).collect()).collect();
        let dot = |i: usize, j: usize| factor[i].iter().zip(&factor[j]).map(|(a, b)| a * b).sum::<f64>();
        let mut entries = Vec::new();
        for i in 0..n {
            for j in 0..=i {
                let value = dot(i, j) + if i == j { own } else { 0.0 };
                entries.push((i as u32, j as u32, value));
                if i != j {
                    entries.push((j as u32, i as u32, value));
                }
            }
        }
        Csr::from_triplets(n, n, &entries)
    };
    let (k, m) = (square(n - 1, 0.0), square(n, 0.4));
    // One unknown at least is free of them.
    let count = (1 + (3.0 * numbers.next()) as usize).min(n - 1);
    let gap = |numbers: &mut Numbers| {
        let column = (0..n as u32).map(|i| (i, numbers.between(-1.0, 1.0))).collect::<Vec<_>>();
        let first = (numbers.next() * n as f64) as usize;
        let scale = 10_f64.powf(numbers.between(-1.0, 1.0));
        Gap { column: SparseVector(column[first.min(n - 1)..].to_vec()), scale, initial: 0.0 }
    };
    let gaps = (0..count).map(|_| gap(numbers)).collect();
    let penalty = penalty(numbers, 5.0);
    (Matrix::Sparse(k), Matrix::Sparse(m), gaps, penalty)
}
