//! Bounds by patches: as low as patches can prove, each proven once, with vectors no closer than they decide.

use bipenalty::convex::{Asked, Curve, Enclosed, Options, Prover};

use crate::blocks::{Blocks, dense_largest};
use crate::enclosure;

/// Unlike meshes, stiffnesses and patches.
const CASES: [(usize, usize, [f64; 2], f64); 4] =
    [(6, 3, [1.0, 0.5], 2.0), (9, 4, [1.0, 20.0], 3.0), (5, 2, [3.0, 3.0], 1.0), (8, 5, [0.1, 1.0], 4.0)];

fn curve((width, height, youngs, size): (usize, usize, [f64; 2], f64), tolerance: f64) -> (Blocks, Curve) {
    let blocks = Blocks::new(width, height, youngs);
    let pencil = blocks.pencil();
    let prover = Prover::Patches(Box::new(blocks.patches(&pencil, size)));
    let curve = Curve::with(&pencil, prover, Options { tolerance, ..Options::default() }).unwrap();
    (blocks, curve)
}

fn at(t: f64) -> [Asked; 1] {
    [Asked { stiffness: t, mass: 0.0 }]
}

/// f(0)/mu, the t of which contact and mesh weigh alike.
fn unit(curve: &Curve) -> f64 {
    curve.mesh() / curve.upper().slope()
}

/// The value is f(t) as closely as its vector, 1e-8, or a hundredth of what is asked lets it be by the square; the bound is the
/// least that the patches prove, to 5 % of what it is too high twice (once looked for, once already too low) and the first step.
#[test]
fn the_value_is_that_of_dense_eigenvalues_and_the_bound_the_least_that_is_proven() {
    for case in CASES {
        for share in [-20.0, -1.0, 0.0, 0.3, 5.0] {
            let tolerance = 1e-5;
            let (blocks, mut curve) = curve(case, tolerance);
            let t = share * unit(&curve);
            let Enclosed { lower, upper } = enclosure(curve.enclose(&at(t))[0]);
            let pencil = blocks.pencil();
            let dense = dense_largest(&pencil, 1.0, t);
            let place = format!("{case:?}, t = {t}: {lower} to {upper}, dense {dense}");
            let rounding = 1e-13 * pencil.size() as f64 * dense.max(t.abs());
            assert!(lower <= dense + rounding && dense <= upper + rounding, "{place}");
            assert!(lower >= dense * (1.0 - 1e-7), "{place}");
            let patches = blocks.patches(&pencil, case.3);
            let proves =
                |u: f64| patches.prove(u, 1.0, t, 1e-10) == bipenalty::convex::factor::Verdict::Proven;
            let (mut low, mut high) = (lower, upper * 1.001);
            assert!(proves(high), "{place}");
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if proves(middle) { high = middle } else { low = middle }
            }
            let excess = (high - lower) / lower;
            let allowed = 1.05 * 1.05 * excess + 0.5 * tolerance * (1.0 + 1e-6);
            println!("{place}: {excess:e} {:e}", upper / lower - 1.0);
            assert!(upper / lower - 1.0 <= allowed, "{place}: patches prove {high}");
        }
    }
}

/// Asked again, for the same width or a wider one, or a hair beside, patches prove nothing again; for a narrower one they
/// do where the last bound stopped at the width.
#[test]
fn each_bound_is_proven_once() {
    for case in CASES {
        for share in [-2.0, 0.5, 3.0] {
            let (_, mut curve) = curve(case, 1e-4);
            let t = share * unit(&curve);
            let first = enclosure(curve.enclose(&at(t))[0]);
            assert!(first.step_width() > 1e-4, "{case:?}: patches are too high by more");
            let proofs = curve.effort().proofs;
            let hair = 1e-9 * t.abs();
            for (t, width) in [(t, 1e-4), (t, 1e-3), (t, 1e-6), (t - hair, 1e-4)] {
                let again = enclosure(curve.enclose_to(&at(t), width)[0]);
                let place = format!("{case:?}, t = {t}, {width:e}: {:?}", curve.effort());
                assert!(again.upper <= first.upper * (1.0 + 1e-8), "{place}");
                assert_eq!(curve.effort().proofs, proofs, "{place}");
            }
            enclosure(curve.enclose_to(&at(t + 1e-3 * t.abs()), 1e-4)[0]);
            assert!(curve.effort().proofs > proofs, "another point");
        }
    }
}

/// A bound that was proven for a wide question may stop at its width: a narrow one proves anew.
#[test]
fn a_narrower_question_is_proven_anew() {
    for case in CASES {
        let (_, mut curve) = curve(case, 0.9);
        let t = 0.5 * unit(&curve);
        // From f(0) and mu alone.
        let begun = curve.effort().proofs;
        let known = enclosure(curve.enclose_to(&at(t), 0.9)[0]);
        assert_eq!(curve.effort().proofs, begun, "{case:?}: {known:?}");
        let wide = enclosure(curve.enclose_to(&at(t), 0.6 * known.step_width())[0]);
        let proofs = curve.effort().proofs;
        assert!(proofs > begun && wide.step_width() <= 0.6 * known.step_width(), "{case:?}: {wide:?}");
        let narrow = enclosure(curve.enclose_to(&at(t), 1e-4)[0]);
        assert!(curve.effort().proofs > proofs, "{case:?}: {wide:?} {narrow:?}");
        assert!(narrow.upper <= wide.upper, "{case:?}: {wide:?} {narrow:?}");
    }
}

/// At t = 0 the vector of f(0) is there already, right to 1e-8: patches ask for no other, however narrow a width is.
#[test]
fn vectors_are_no_closer_than_patches_decide() {
    for case in CASES {
        let (_, mut curve) = curve(case, 1e-12);
        let begun = curve.effort().eigenproblems;
        let _ = curve.enclose(&at(0.0));
        assert_eq!(curve.effort().eigenproblems, begun, "{case:?}: {:?}", curve.effort());
        // Elsewhere 1e-12 takes no more than the narrowest width of which 1e-8 is a twentieth.
        let count = |width: f64| {
            let (_, mut curve) = self::curve(case, width);
            let _ = curve.enclose(&at(2.0 * unit(&curve)));
            curve.effort().products
        };
        assert_eq!(count(1e-12), count(0.5 * 1e-8 / 0.05), "{case:?}");
    }
}

/// Nearer to t = 0 than where f bends the vector of t serves; farther below the mode that holds the gaps closed is sampled too.
#[test]
fn the_closed_mode_is_sampled_where_f_bends_only() {
    // Blocks of one material alike in size have a mode of f(0) that opens no gap, and f does not bend.
    for case in CASES.into_iter().filter(|case| case.2[0] != case.2[1]) {
        let eigenproblems = |share: f64| {
            let (_, mut curve) = curve(case, 1e-4);
            let begun = curve.effort().eigenproblems;
            let _ = curve.enclose(&at(share * unit(&curve)));
            curve.effort().eigenproblems - begun
        };
        assert_eq!([-0.03, -0.05].map(eigenproblems), [1, 2], "{case:?}");
    }
}
