//! Explicit schemes with the contact in the internal force: their limits beside their amplification matrices.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::{Gap, Matrix, Penalty};
use bipenalty::schemes::explicit::{CostCurve, ExplicitName, ExplicitScheme};
use bipenalty::spectrum::{Spectrum, StepLimit, engine};
use bipenalty::stability::Model;
use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};

fn with(name: ExplicitName, parameter: f64) -> ExplicitScheme {
    name.with(Some(parameter)).unwrap()
}

/// So many parameters of the accepted range, ends included.
fn sweep(name: ExplicitName, count: usize) -> Vec<f64> {
    let (low, high) = name.facts().allowed;
    let at = |i: usize| low + (high - low) * (i as f64 / (count - 1) as f64);
    (0..count).map(at).map(|x| x.min(high)).collect()
}

/// The characteristic polynomial of the amplification matrix, highest power first.
fn polynomial(scheme: &ExplicitScheme, w: f64) -> Vec<f64> {
    let a = scheme.amplification(w);
    let minor = |i: usize, j: usize| a[i][i] * a[j][j] - a[i][j] * a[j][i];
    if a.len() == 2 {
        return vec![1.0, -(a[0][0] + a[1][1]), minor(0, 1)];
    }
    let cofactor = |j: usize, k: usize| a[1][j] * a[2][k] - a[1][k] * a[2][j];
    let determinant = a[0][0] * cofactor(1, 2) - a[0][1] * cofactor(0, 2) + a[0][2] * cofactor(0, 1);
    let minors = minor(0, 1) + minor(0, 2) + minor(1, 2);
    vec![1.0, -(a[0][0] + a[1][1] + a[2][2]), minors, -determinant]
}

/// The least of the quantities all of which are positive for roots inside the unit circle.
fn inside(p: &[f64]) -> f64 {
    let odd = if p.len().is_multiple_of(2) { -1.0 } else { 1.0 };
    let at = |z: f64| p.iter().fold(0.0, |sum, c| sum * z + c);
    let last = p[p.len() - 1];
    let mut least = at(1.0).min(odd * at(-1.0)).min(1.0 - last.abs());
    if let [_, a2, a1, a0] = p {
        least = least.min(1.0 - a0 * a0 - (a1 - a0 * a2).abs());
    }
    least
}

fn radius(scheme: &ExplicitScheme, w: f64) -> f64 {
    let rows = scheme.amplification(w);
    let roots = Mat::from_fn(rows.len(), rows.len(), |i, j| rows[i][j]).eigenvalues().unwrap();
    roots.iter().map(|z| z.re.hypot(z.im)).fold(0.0, f64::max)
}

/// The first omega dt at which a root leaves, by scanning and bisection; 1e-13 of it is rounding of the polynomial.
fn first_loss(scheme: &ExplicitScheme, highest: f64, points: usize) -> f64 {
    let stable = |x: f64| inside(&polynomial(scheme, x * x)) >= -1e-13;
    let step = highest / points as f64;
    let first = (1..=points).find(|i| !stable(*i as f64 * step)).expect("a root that leaves");
    let (mut low, mut high) = ((first - 1) as f64 * step, first as f64 * step);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Omega to 1e-10, and no island below it, over the whole range of each parameter.
#[test]
fn omega_is_where_the_first_root_leaves() {
    for name in ExplicitName::ALL {
        for parameter in sweep(name, 101) {
            // At rho = 1 a root is -1 for every step, so that rounding alone decides: see below.
            if (name, parameter) == (ExplicitName::GeneralisedAlpha, 1.0) {
                continue;
            }
            let scheme = with(name, parameter);
            let omega = scheme.largest();
            let found = first_loss(&scheme, 1.1 * omega, 4000);
            assert!((found / omega - 1.0).abs() < 1e-10, "{scheme:?}: {found} {omega}");
        }
    }
}

/// The same by eigenvalues, which see what the conditions might not.
#[test]
fn no_eigenvalue_leaves_below_and_one_does_above() {
    for name in ExplicitName::ALL {
        for parameter in sweep(name, 21) {
            let scheme = with(name, parameter);
            for i in 1..=2000 {
                let x = scheme.largest() * f64::from(i) / 2000.0 * (1.0 - 1e-6);
                // Double roots on the circle split by the root of rounding, triple ones by its third root.
                let slack = if scheme.facts().states == 3 && parameter > 0.99 { 1e-4 } else { 1e-6 };
                let largest = radius(&scheme, x * x);
                assert!(largest <= 1.0 + slack, "{scheme:?} at {x}: {largest}");
            }
            let above = scheme.largest() * 1.001;
            assert!(radius(&scheme, above * above) > 1.0 + 1e-4, "{scheme:?}");
        }
    }
}

/// What the ranges exclude does grow below the formula: by islands at -1, and at every step.
#[test]
fn what_is_refused_is_unstable_below_the_formula() {
    // Noh and Bathe's step once more, for any p.
    let noh_bathe = |p: f64, w: f64| {
        let s = 1.0 - p;
        let d = 1.0 - w * w * s * s * (2.0 * p - 1.0) / 4.0;
        let at_minus_one = 4.0 - w + w * w * s * (4.0 * p * p - 3.0 * p + 1.0) / 4.0;
        (d, at_minus_one)
    };
    let scheme = with(ExplicitName::NohBathe, 0.6);
    for w in [0.3, 2.0, 7.0] {
        let p = polynomial(&scheme, w);
        let (d, at_minus_one) = noh_bathe(0.6, w);
        assert!((p[2] - d).abs() < 1e-14 && (1.0 - p[1] + p[2] - at_minus_one).abs() < 1e-14);
    }
    for p in [0.76, 0.8, 0.9] {
        let highest = 4.0 / ((3.0 * p - 1.0) * (1.0 - p));
        let lost = (1..1000).any(|i| noh_bathe(p, highest * f64::from(i) / 1000.0).1 < 0.0);
        assert!(lost && ExplicitName::NohBathe.with(Some(p)).is_err(), "{p}");
    }
    assert!(noh_bathe(0.49, 0.1).0 > 1.0 && ExplicitName::NohBathe.with(Some(0.49)).is_err());
    for (name, parameter) in [
        (ExplicitName::ChungLee, 0.99),
        (ExplicitName::ChungLee, 1.1),
        (ExplicitName::TchamwaWielgosz, 0.99),
        (ExplicitName::TchamwaWielgosz, 2.1),
        (ExplicitName::GeneralisedAlpha, -0.01),
        (ExplicitName::GeneralisedAlpha, 1.01),
        (ExplicitName::GeneralisedAlpha, f64::NAN),
    ] {
        let refusal = name.with(Some(parameter)).unwrap_err();
        let (low, high) = name.facts().allowed;
        assert!(refusal.place.contains(name.name()) && refusal.place.contains(name.facts().parameter));
        assert!(refusal.allowed.contains(&format!("{low} to {high}")), "{refusal}");
    }
    assert!("newmark".parse::<ExplicitName>().unwrap_err().allowed.contains("chung-lee"));
}

#[test]
fn the_usual_parameters_have_the_published_limits() {
    let omega = |name: ExplicitName, parameter| name.with(parameter).unwrap().largest();
    for (name, parameter, expected) in [
        (ExplicitName::NohBathe, None, 3.7450),
        (ExplicitName::ChungLee, None, 1.8665),
        (ExplicitName::TchamwaWielgosz, None, 1.9371),
        (ExplicitName::GeneralisedAlpha, Some(0.0), 1.5492),
        // Without damping: central differences, in two halves for Noh and Bathe.
        (ExplicitName::NohBathe, Some(0.5), 4.0),
        (ExplicitName::ChungLee, Some(1.0), 2.0),
        (ExplicitName::TchamwaWielgosz, Some(1.0), 2.0),
        (ExplicitName::GeneralisedAlpha, Some(1.0), 2.0),
    ] {
        assert!((omega(name, parameter) - expected).abs() < 1e-4, "{name:?} {parameter:?}");
    }
    let (half, chung_lee) =
        (omega(ExplicitName::GeneralisedAlpha, Some(0.5)), omega(ExplicitName::ChungLee, None));
    assert!((half / chung_lee - 1.0).abs() < 1e-15);
    for name in ExplicitName::ALL {
        assert_eq!(name.name().parse(), Ok(name));
        assert_eq!(name.with(None).unwrap().parameter(), name.facts().usual);
    }
}

/// The error of a quarter of a period falls with the order of the facts; a starts as it should.
#[test]
fn schemes_converge_in_the_order_of_their_facts() {
    for name in ExplicitName::ALL {
        let scheme = name.with(None).unwrap();
        let error = |steps: u32| {
            let dt = std::f64::consts::FRAC_PI_4 / f64::from(steps);
            let start = if scheme.facts().name == "chung-lee" { dt } else { 0.0 };
            let mut state = vec![(-start).cos(), dt * start.sin(), -dt * dt * start.cos()];
            // The acceleration of Chung and Lee is that of the displacement a step before.
            (state[0], state[1]) = if start > 0.0 { (1.0, 0.0) } else { (state[0], state[1]) };
            state.truncate(scheme.facts().states);
            (0..steps).for_each(|_| state = scheme.step(dt * dt, &state));
            (state[0] - std::f64::consts::FRAC_1_SQRT_2).abs()
        };
        let order = (error(400) / error(800)).log2();
        assert!((order - scheme.facts().order as f64).abs() < 0.1, "{name:?}: {order}");
    }
}

fn signorini() -> Model {
    let scene = bipenalty::scene::built_in("signorini").unwrap().unwrap().with_elements(12).unwrap();
    Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent)
}

fn penalty(model: &Model, beta_s: f64, ratio: f64) -> Penalty {
    model.penalty(StiffnessPenalty::new(beta_s).unwrap(), Ratio::new(ratio).unwrap())
}

/// Steps of whole vectors, as the schemes are written: stable just below the limit of the scene, not just above.
#[test]
fn limits_of_a_scene_are_those_of_its_steps() {
    let model = signorini();
    let pencil = model.pencil();
    let n = pencil.size();
    let full = |matrix: &Matrix| {
        let mut a = Mat::<f64>::zeros(n, n);
        (0..n).for_each(|i| matrix.row(i).for_each(|(j, x)| a[(i, j)] = x));
        a
    };
    for (beta_s, ratio) in [(0.0, 1.0), (3.0, 1.0), (100.0, 4.0), (10.0, f64::INFINITY)] {
        let penalty = penalty(&model, beta_s, ratio);
        let (mut k, mut m) = (full(pencil.stiffness()), full(pencil.mass()));
        for Gap { column, scale, .. } in pencil.gaps() {
            let ((s, mass), i) = (penalty.of(*scale), column.0[0].0 as usize);
            k[(i, i)] += s;
            m[(i, i)] += mass;
        }
        let rate = PartialPivLu::new(m.as_ref()).solve(&k);
        for name in ExplicitName::ALL {
            let scheme = name.with(None).unwrap();
            let step = scheme.limit(engine(&pencil).unwrap()).enclose(&penalty, None).unwrap();
            let size = |dt: f64| {
                let parts = scheme.facts().states;
                // The matrix of the modes is a polynomial in w, of degree 3 at most, which four values tell; w is dt^2 N^-1 S.
                let a: Vec<_> = [0.0, 1.0, 2.0, 3.0].map(|w| scheme.amplification(w)).into();
                let w = &rate * (dt * dt);
                let square = &w * &w;
                let cube = &square * &w;
                let matrix = Mat::from_fn(parts * n, parts * n, |row, column| {
                    let ((r, i), (c, j)) = ((row / n, row % n), (column / n, column % n));
                    let [a0, a1, a2, a3] = [a[0][r][c], a[1][r][c], a[2][r][c], a[3][r][c]];
                    let third = (a3 - 3.0 * a2 + 3.0 * a1 - a0) / 6.0;
                    let second = 0.5 * (a2 - 2.0 * a1 + a0) - 3.0 * third;
                    let first = a1 - a0 - second - third;
                    let own = a0 * f64::from(u8::from(i == j));
                    own + first * w[(i, j)] + second * square[(i, j)] + third * cube[(i, j)]
                });
                let roots = matrix.eigenvalues().unwrap();
                roots
                    .iter()
                    .filter(|z| (z.re - 1.0).hypot(z.im) > 1e-3)
                    .map(|z| z.re.hypot(z.im))
                    .fold(0.0, f64::max)
            };
            let place = format!("{name:?}, beta_s = {beta_s}, r = {ratio}");
            assert!(size(0.999 * step.lower()) <= 1.0 + 1e-7, "{place}");
            // Noh and Bathe's root leaves at +1.
            assert!(size(1.01 * step.upper()) > 1.0 + 1e-6, "{place}: {}", size(1.01 * step.upper()));
        }
    }
}

/// The chart of cost: two forces a step buy Noh and Bathe less than central differences, at every penalty alike.
#[test]
fn cost_is_the_limit_over_the_evaluations() {
    let model = signorini();
    let pencil = model.pencil();
    let penalties: Vec<Penalty> =
        [0.0, 1.0, 10.0, 1e4].iter().map(|beta_s| penalty(&model, *beta_s, f64::INFINITY)).collect();
    let central = Spectrum(engine(&pencil).unwrap());
    let central = CostCurve::new("central-difference", 1, &central, &penalties);
    for name in ExplicitName::ALL {
        let scheme = name.with(None).unwrap();
        let limit = scheme.limit(engine(&pencil).unwrap());
        let curve = CostCurve::new(name.name(), scheme.facts().evaluations, &limit, &penalties);
        assert_eq!((curve.points.len(), curve.evaluations), (4, scheme.facts().evaluations));
        for (own, other) in curve.points.iter().zip(&central.points) {
            let (time, reference) =
                (own.time_per_evaluation().unwrap(), other.time_per_evaluation().unwrap());
            let expected = 0.5 * scheme.largest() / scheme.facts().evaluations as f64;
            assert!((time / reference / expected - 1.0).abs() < 1e-12, "{name:?}");
            assert!(expected < 1.0 && own.evaluations_per_second().unwrap() * time - 1.0 < 1e-15);
        }
        assert!(curve.points.windows(2).all(|pair| {
            pair[1].time_per_evaluation().unwrap() <= pair[0].time_per_evaluation().unwrap()
        }));
    }
}
