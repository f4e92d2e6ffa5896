//! Both ends of every enclosure, by definiteness in double-double arithmetic: D(h) = h^2 (y^2 N - y C - S) with y = 2/h.

use bipenalty::damping::{DampedLimit, Damping};
use bipenalty::pencil::{Gap, Matrix, Penalty, Pencil};
use bipenalty::spectrum::{Evidence, StepLimit, engine};

use crate::definite;
use crate::double_double::Dd;
use crate::numbers::Numbers;
use crate::scenes;

/// Whether (y^2 - A y) M - (1 + B y) K + (y^2/rate - 1 - c y) beta_s P is positive definite.
pub fn is_definite(pencil: &Pencil, penalty: &Penalty, damping: Damping, y: Dd) -> bool {
    let n = pencil.size();
    let (one, dd) = (Dd::from(1.0), Dd::from);
    let mass = y * y - dd(damping.mass()) * y;
    let stiffness = one + dd(damping.stiffness()) * y;
    let inertia = if penalty.rate.is_finite() { y * y / dd(penalty.rate) } else { dd(0.0) };
    let contact = dd(penalty.stiffness) * (inertia - one - dd(damping.contact()) * y);
    let mut a = vec![vec![dd(0.0); n]; n];
    let mut add = |matrix: &Matrix, factor: Dd| {
        (0..n).for_each(|i| matrix.row(i).for_each(|(j, x)| a[i][j] = a[i][j] + factor * dd(x)));
    };
    add(pencil.mass(), mass);
    add(pencil.stiffness(), -stiffness);
    for Gap { column, scale, .. } in pencil.gaps() {
        for (i, x) in &column.0 {
            for (j, z) in &column.0 {
                let entry = &mut a[*i as usize][*j as usize];
                *entry = *entry + contact * dd(*scale) * dd(*x) * dd(*z);
            }
        }
    }
    definite::is_definite(a)
}

/// The square root, to twice the digits of f64: one step of Newton.
fn root(l: f64) -> Dd {
    let y = Dd::from(l.sqrt());
    (y + Dd::from(l) / y) * Dd::from(0.5)
}

/// Penalties to 1e10 and dampings from nothing to a thousand times what halves the step.
#[test]
fn every_enclosure_holds_the_exact_limit() {
    let mut numbers = Numbers(11);
    let mut widest = 0.0_f64;
    for case in 0..400 {
        let (pencil, mut penalty) = scenes::bars(&mut numbers);
        penalty.stiffness *= 10_f64.powf(numbers.between(0.0, 6.0));
        let omega = pencil.reference().sqrt();
        let mut part = |unit: f64| match numbers.next() < 0.3 {
            true => 0.0,
            false => unit * 10_f64.powf(numbers.between(-9.0, 3.0)),
        };
        let damping = Damping::new(part(omega), part(1.0 / omega), part(1.0 / omega)).unwrap();
        let limit = DampedLimit::new(&pencil, engine(&pencil).unwrap(), damping);
        let step = limit.enclose(&penalty, None).unwrap();
        let place = format!("case {case}, {penalty:?}, {damping:?}, {step:?}");
        assert_eq!(step.evidence, Evidence::Proven, "{place}");
        assert!(is_definite(&pencil, &penalty, damping, root(step.l.upper)), "{place}");
        assert!(!is_definite(&pencil, &penalty, damping, root(step.l.lower)), "{place}");
        widest = widest.max(step.l.relative_width());
    }
    println!("widest {widest:e}");
    assert!(widest < 4.1e-13, "{widest:e}");
}
