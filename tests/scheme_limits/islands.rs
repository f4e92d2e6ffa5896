//! Above the limits: islands of stability, and what several unlike contacts stand.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Terms;
use bipenalty::scene::{End, Scene};
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

use super::common::numbers::Numbers;
use super::{Dense, free_of, growth_of, islands_of, limit_of, on_a_wall, outside, penalties, with_limit};

/// Beyond its limit a scheme is unstable, but in the islands that are reported. Steps up to dt_c for Park, up to 2 dt_c and
/// beyond dt^2 s' mu = 4/3 (where growth cannot be slow) for the predictor-corrector.
#[test]
fn no_island_of_stability_is_left_out() {
    let mut numbers = Numbers(16);
    let (mut looked, mut beyond) = (0, 0);
    for point in 0..40 {
        let model = Model::new(numbers.scene(), numbers.mass(), PenaltyMass::Consistent);
        let p =
            penalties(&model, 10f64.powf(numbers.between(-1.5, 3.0)), 10f64.powf(numbers.between(-1.5, 1.0)));
        let theta = numbers.one_of(&[0.0, 0.5, 1.0]);
        for scheme in [SchemeName::PredictorCorrector, SchemeName::Park] {
            with_limit(&model, scheme, theta, &p, |limit, matrix, engine| {
                beyond += usize::from(limit > 1.0 + 1e-6);
                let islands = islands_of(engine, &p);
                for i in 1..50 {
                    let c = limit * (1.0 + 0.02 * f64::from(i));
                    if islands.iter().any(|(low, high)| (0.999 * low..=1.001 * high).contains(&c)) {
                        continue;
                    }
                    if growth_of(engine, &p, c).is_some_and(|growth| growth == 0.0 || growth > 1e-5) {
                        looked += 1;
                        let (count, largest) = outside(&matrix(c));
                        assert!(
                            count > 0,
                            "point {point}, {scheme:?}: |z| <= {largest} at {c}, limit {limit}"
                        );
                    }
                }
            });
        }
    }
    println!("{looked} steps above a limit looked at, {beyond} limits above the contact-free step");
    assert!(looked > 1000 && beyond > 0);
}

/// One lumped element on a wall with a weak pure penalty: stable again at 1.30 to 1.34 contact-free steps.
#[test]
fn islands_of_stability_are_found() {
    let mut found = 0;
    for elements in [1, 2, 3] {
        for beta_s in [0.1, 0.2, 0.26, 0.27, 0.28, 0.29, 0.3, 0.31, 0.35] {
            let model = on_a_wall(elements, 1.0);
            let p = penalties(&model, beta_s, f64::INFINITY);
            with_limit(&model, SchemeName::PredictorCorrector, 0.5, &p, |limit, matrix, engine| {
                let mut last = limit;
                for (low, high) in islands_of(engine, &p) {
                    found += 1;
                    println!(
                        "{elements} elements, beta_s = {beta_s}: {limit:.6}, then {low:.6} to {high:.6}"
                    );
                    let count = |c: f64| outside(&matrix(c)).0;
                    assert!(count(0.5 * (last + low)) > 0 && count(low * (1.0 - 1e-5)) > 0);
                    for part in [1e-5, 0.1, 0.5, 0.9, 1.0 - 1e-5] {
                        assert_eq!(count(low + part * (high - low)), 0, "{part} of {low} to {high}");
                    }
                    // The growth beyond dt^2 s' mu = 1 is seen a little further out.
                    assert!(count(high * 1.01) > 0);
                    last = high;
                }
                if elements == 1 && beta_s == 0.28 {
                    let islands = islands_of(engine, &p);
                    // dt^2 s' mu = 1 at dt/dt_c = (1/(2 beta_s))^(1/2).
                    assert_eq!(islands.len(), 1);
                    assert!((islands[0].0 - 1.300505).abs() < 1e-6, "{islands:?}");
                    assert!((islands[0].1 - (0.5 / 0.28_f64).sqrt()).abs() < 1e-8, "{islands:?}");
                }
            });
        }
    }
    assert!(found >= 4, "{found}");
}

/// Contacts that are not alike have a lower bound, as dt^2 lambda_max(C G) = 1 is not their limit.
#[test]
fn unlike_contacts_stand_more_than_the_safe_step() {
    let mut numbers = Numbers(23);
    let mut largest_gain: f64 = 1.0;
    for point in 0..60 {
        let bars = vec![numbers.bar(0.5), numbers.bar(0.5)];
        let scene = Scene::new("unlike", End::Free, bars, End::Wall, None).unwrap();
        let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
        let pencil = model.pencil();
        let park = limit_of(&model, &pencil, SchemeName::Park, 0.5);
        // No stiffer, so that the growth is seen where it begins.
        let p = penalties(&model, 10f64.powf(numbers.between(0.0, 1.5)), f64::INFINITY);
        // Lumped mass: C G is diagonal, s' mu a contact.
        let plastic = |(mu, p): (&f64, &Terms)| p.stiffness * mu / (1.0 + p.mass * mu);
        let chain = pencil.chain().unwrap();
        let largest = chain.compliance().iter().zip(&chain.terms(&p)).map(plastic).fold(0.0, f64::max);
        let safe = 1.0 / largest.sqrt();
        if safe * free_of(&*park).value.sqrt() > 2.0 {
            continue;
        }
        let dense = Dense::new(&pencil, &p);
        for below in [0.3, 0.9, 0.999, 1.0 - 1e-6] {
            let (count, modulus) = outside(&dense.predictor_corrector(below * safe));
            assert_eq!(count, 0, "point {point}: |z| = {modulus} at {below} of {safe}");
        }
        let stable =
            |i: &i32| outside(&dense.predictor_corrector(safe * (1.0 + 0.005 * f64::from(*i)))).0 == 0;
        let steps = (1..60).take_while(stable).last().unwrap_or(0);
        largest_gain = largest_gain.max(1.0 + 0.005 * f64::from(steps));
    }
    println!("stable up to {largest_gain} of the safe step");
    assert!(largest_gain > 1.05, "{largest_gain}");
}
