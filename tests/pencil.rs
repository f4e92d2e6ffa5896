//! What a pencil refuses, and the bounds that it accepts: no smaller ones.

#![allow(clippy::unwrap_used)]

use bipenalty::fem::{MassMatrix, assemble};
use bipenalty::pencil::{Bounds, Gap, Matrix, Pencil, Tridiagonal};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::sparse::{Csr, SparseVector};

/// Three masses of 2 kg on two springs of 1 N/m: the largest eigenvalue of (|K|, M) is 3/2, rows give 2.
fn springs() -> Vec<(u32, u32, f64)> {
    vec![(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0), (1, 2, -1.0), (2, 1, -1.0), (2, 2, 1.0)]
}

fn sparse(entries: &[(u32, u32, f64)]) -> Matrix {
    Matrix::Sparse(Csr::from_triplets(3, 3, entries))
}

fn gap(column: Vec<(u32, f64)>, scale: f64) -> Gap {
    Gap { column: SparseVector(column), scale, initial: 0.0 }
}

const BOUNDS: Bounds = Bounds { stiffness: 2.0, mass: 1.0 };

fn refused(k: Matrix, m: Matrix, gaps: Vec<Gap>, bounds: Bounds, reference: f64) -> String {
    Pencil::new(k, m, gaps, bounds, reference).unwrap_err().to_string()
}

#[test]
fn what_has_no_meaning_is_refused_with_its_place() {
    let (k, m) = (|| sparse(&springs()), || Matrix::Diagonal(vec![2.0; 3]));
    let wall = || vec![gap(vec![(2, 1.0)], 1.0)];
    assert!(Pencil::new(k(), m(), wall(), BOUNDS, 2.0).is_ok());
    let changed = |at: usize, value: f64| {
        let mut entries = springs();
        entries[at].2 = value;
        sparse(&entries)
    };
    let cases = [
        (refused(k(), Matrix::Diagonal(vec![2.0; 4]), wall(), BOUNDS, 2.0), "mass: 4 x 4"),
        (refused(changed(2, -0.5), m(), wall(), BOUNDS, 2.0), "symmetric"),
        (refused(changed(3, f64::NAN), m(), wall(), BOUNDS, 2.0), "stiffness, row 1, column 1: NaN"),
        (refused(k(), Matrix::Diagonal(vec![2.0, 0.0, 2.0]), wall(), BOUNDS, 2.0), "mass, row 1: 0"),
        (refused(k(), m(), vec![gap(vec![], 1.0)], BOUNDS, 2.0), "gap 0, column: no entry"),
        (refused(k(), m(), vec![gap(vec![(3, 1.0)], 1.0)], BOUNDS, 2.0), "index 3"),
        (refused(k(), m(), vec![gap(vec![(1, 1.0), (0, -1.0)], 1.0)], BOUNDS, 2.0), "ascending"),
        (refused(k(), m(), vec![gap(vec![(1, 0.0)], 1.0)], BOUNDS, 2.0), "other than 0"),
        (refused(k(), m(), vec![gap(vec![(1, 1.0)], 0.0)], BOUNDS, 2.0), "gap 0, scale: 0"),
        (refused(k(), m(), wall(), BOUNDS, -1.0), "reference: -1"),
        (refused(k(), m(), wall(), Bounds { mass: 0.5, ..BOUNDS }, 2.0), "bounds, mass"),
        (refused(k(), m(), wall(), Bounds { stiffness: 1.49, ..BOUNDS }, 2.0), "bounds, stiffness"),
    ];
    for (text, expected) in cases {
        assert!(text.contains(expected), "{text} does not say {expected}");
    }
    // Positive on the diagonal, and not definite: 1 1; 1 1.
    let singular = sparse(&[(0, 0, 1.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)]);
    assert!(
        refused(k(), singular, wall(), Bounds { stiffness: 100.0, mass: 100.0 }, 2.0).contains("definite")
    );
}

/// The bounds of bars are sharp: what elements give is accepted in every form of the matrices, 1 % less in none.
#[test]
fn bounds_are_accepted_as_small_as_they_are() {
    for gamma in [0.0, 0.3, 0.5, 1.0] {
        let bar =
            Bar { length: 6.0, elements: 6, youngs_modulus: 3.0, density: 0.7, area: 2.0, velocity: 0.0 };
        let scene = Scene::new("bar", End::Free, vec![bar], End::Free, None).unwrap();
        let pencil = assemble(&scene, MassMatrix::new(gamma).unwrap());
        let sparse = |a: &Matrix| {
            let rows = (0..7).flat_map(|i| a.row(i).map(move |(j, a)| (i as u32, j as u32, a)));
            Matrix::Sparse(Csr::from_triplets(7, 7, &rows.collect::<Vec<_>>()))
        };
        let chain = |a: &Matrix| a.clone();
        let forms: [&dyn Fn(&Matrix) -> Matrix; 2] = [&chain, &sparse];
        for form in forms {
            let with = |factor: f64| {
                let Bounds { stiffness, mass } = pencil.bounds();
                let bounds = Bounds { stiffness: factor * stiffness, mass };
                Pencil::new(form(pencil.stiffness()), form(pencil.mass()), Vec::new(), bounds, 1.0)
            };
            assert!(with(1.0).is_ok(), "gamma = {gamma}: {:?}", with(1.0).unwrap_err());
            assert!(with(0.99).is_err(), "gamma = {gamma}");
        }
    }
}

/// A chain is recognised by its gaps: at the ends of uncoupled bars, from left to right.
#[test]
fn only_rows_of_bars_are_chains() {
    let k = || Tridiagonal { diagonal: vec![1.0; 4], off_diagonal: vec![-1.0, 0.0, -1.0] };
    let chain = |gaps: Vec<Gap>| {
        let bounds = Bounds { stiffness: 2.0, mass: 1.0 };
        let mass = Matrix::Diagonal(vec![1.0; 4]);
        Pencil::new(Matrix::Chain(k()), mass, gaps, bounds, 2.0).unwrap().chain().is_some()
    };
    let pair = |left: u32| gap(vec![(left, 1.0), (left + 1, -1.0)], 1.0);
    assert!(chain(vec![pair(1), gap(vec![(3, 1.0)], 1.0)]));
    assert!(!chain(vec![gap(vec![(3, 1.0)], 1.0), pair(1)]), "from right to left");
    assert!(!chain(vec![pair(0)]), "within a bar");
    assert!(!chain(vec![gap(vec![(2, 1.0)], 1.0)]), "a wall within the row");
    assert!(!chain(vec![gap(vec![(0, 1.0), (3, -1.0)], 1.0)]), "ends that are no neighbours");
    assert!(!chain(vec![gap(vec![(3, 0.5)], 1.0)]), "a gap that is not the displacement");
}

/// A plane truss of integer springs, moved by 2^40 in one direction and -3 2^38 in the other: what it holds are integers of
/// the strains alone, while plain sums, and differences between directions, leave the rounding of 2^100.
#[test]
fn what_is_strained_far_away_has_all_its_digits() {
    let nodes = 40_usize;
    let springs = || (1..=3).flat_map(|apart| (apart..nodes).map(move |j| (j - apart, j)));
    let along = |i: usize, j: usize| {
        ([(i + 2 * j) as i64 % 7 - 3, (3 * i + j) as i64 % 5 + 1], 101 + 7919 * i as i64)
    };
    let mut entries = Vec::new();
    for (i, j) in springs() {
        let (d, k) = along(i, j);
        let ends = || {
            [(i, 1), (j, -1)].into_iter().flat_map(|(node, sign)| [0, 1].map(|x| (2 * node + x, sign * d[x])))
        };
        for (row, a) in ends() {
            entries.extend(ends().map(|(column, b)| (row as u32, column as u32, (k * a * b) as f64)));
        }
    }
    let k = Matrix::Sparse(Csr::from_triplets(2 * nodes, 2 * nodes, &entries));
    let moved =
        |by: usize| (0..2 * nodes).map(move |at| [1 << 40, -3 << 38][at % 2] + (at * at * by % 101) as i64);
    let [u, v] = [37, 53].map(|by| moved(by).collect::<Vec<i64>>());
    let longer = |x: &[i64], i: usize, j: usize| {
        let d = along(i, j).0;
        (0..2).map(|at| d[at] * (x[2 * j + at] - x[2 * i + at])).sum::<i64>()
    };
    let held = |(i, j)| along(i, j).1 * longer(&u, i, j) * longer(&v, i, j);
    let exact = springs().map(held).sum::<i64>() as f64;
    let [u, v] = [&u, &v].map(|x| x.iter().map(|x| *x as f64).collect::<Vec<f64>>());
    let found = k.strain(&u, &v);
    assert!(exact != 0.0 && (found - exact).abs() <= f64::EPSILON * exact.abs(), "{found:e} {exact:e}");
}
