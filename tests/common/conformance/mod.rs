//! Suites that an engine, a scheme, an element or a pencil passes, of this crate or of one's own; each joins by a line.

// The helpers of a test fail by panicking, like the test; each test file uses its own part of this module.
#![allow(clippy::unwrap_used, clippy::panic, dead_code)]

pub mod engines;
pub mod pencils;
pub mod schemes;

use bipenalty::pencil::{Gap, Matrix, Pencil};
use bipenalty::sparse::{Csr, SparseVector};

/// `name => |model, pencil| engine, accuracy of l_max relative to the judge;` for engines of bars.
#[macro_export]
macro_rules! engine_conformance {
    ($($(#[$attribute:meta])* $name:ident => $engine:expr, $accuracy:expr;)*) => {$(
        $(#[$attribute])*
        mod $name {
            use super::*;
            use $crate::conformance::engines::{self, On};

            fn check(cases: Vec<engines::Case>) {
                engines::check(stringify!($name), &$engine, On::Bars, $accuracy, cases);
            }

            #[test]
            fn reference_scenes() {
                check(engines::reference_scenes_over_the_penalties());
            }

            #[test]
            fn ends_and_sizes() {
                check(engines::every_pair_of_ends());
            }

            #[test]
            fn unequal_bars() {
                check(engines::random_bars());
            }
        }
    )*};
}

/// The same for engines of any pencil: bars without their structure.
#[macro_export]
macro_rules! mesh_engine_conformance {
    ($($name:ident => $engine:expr, $accuracy:expr;)*) => {$(
        mod $name {
            use super::*;
            use $crate::conformance::engines::{self, On};

            #[test]
            fn bars_as_meshes() {
                let cases = engines::moderate_bars();
                engines::check(stringify!($name), &$engine, On::Meshes, $accuracy, cases);
            }
        }
    )*};
}

/// `name => scheme;`
#[macro_export]
macro_rules! scheme_conformance {
    ($($name:ident => $scheme:expr;)*) => {$(
        mod $name {
            use super::*;
            use $crate::conformance::schemes;

            #[test]
            fn converges_in_the_order_of_its_facts() {
                schemes::converges(&$scheme);
            }

            #[test]
            fn gaps_are_those_of_the_displacements() {
                schemes::keeps_its_gaps(&$scheme);
            }

            #[test]
            fn bars_move_as_their_matrices_do() {
                schemes::moves_alike(&$scheme);
            }

            #[test]
            fn steps_confirm_its_limit() {
                schemes::has_its_limit(&$scheme);
            }
        }
    )*};
}

/// `name => pencil;` for a pencil of one's own.
#[macro_export]
macro_rules! pencil_conformance {
    ($($name:ident => $pencil:expr;)*) => {$(
        mod $name {
            use super::*;
            use $crate::conformance::pencils;

            #[test]
            fn bounds_and_enclosures_hold() {
                pencils::check(&$pencil);
            }

            #[test]
            fn central_differences_step_to_the_limit() {
                pencils::steps_to_the_limit(&$pencil);
            }

            #[test]
            fn the_predictor_corrector_keeps_its_bound() {
                pencils::keeps_the_bound(&$pencil);
            }
        }
    )*};
}

/// The matrices of a row of bars without their structure, the unknowns in another order.
pub fn as_mesh(pencil: &Pencil) -> Pencil {
    let n = pencil.size();
    let place = |i: usize| place(i, n) as u32;
    let sparse = |a: &Matrix| {
        let rows = (0..n).flat_map(|i| a.row(i).map(move |(j, a)| (place(i), place(j), a)));
        Csr::from_triplets(n, n, &rows.collect::<Vec<_>>())
    };
    let mass = match pencil.mass().is_diagonal() {
        true => {
            let mut lumped = vec![0.0; n];
            (0..n).for_each(|i| lumped[place(i) as usize] = pencil.mass().diagonal(i));
            Matrix::Diagonal(lumped)
        }
        false => Matrix::Sparse(sparse(pencil.mass())),
    };
    let gap = |gap: &Gap| {
        let mut column: Vec<_> = gap.column.0.iter().map(|(i, z)| (place(*i as usize), *z)).collect();
        column.sort_by_key(|(i, _)| *i);
        Gap { column: SparseVector(column), ..gap.clone() }
    };
    let gaps = pencil.gaps().iter().map(gap).collect();
    let stiffness = Matrix::Sparse(sparse(pencil.stiffness()));
    Pencil::new(stiffness, mass, gaps, pencil.bounds(), pencil.reference()).unwrap()
}

/// Where [`as_mesh`] has put unknown i of n: an order that is no neighbourhood, by steps of a number that has no divisor in
/// common with n.
pub fn place(i: usize, n: usize) -> usize {
    let step = (n / 3 + 1..)
        .find(|step| (2..=*step).all(|d| !step.is_multiple_of(d) || !n.is_multiple_of(d)))
        .unwrap();
    (i * step + 1) % n
}
