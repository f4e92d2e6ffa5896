//! Contacts that a bar couples: the Park limit and that of the spectrum are where the amplification matrices have them, and
//! up to the lower bound of the predictor-corrector none grows.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::{Penalty, Pencil};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::SchemeName;
use bipenalty::spectrum::Evidence;
use bipenalty::stability::Model;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};
use rayon::prelude::*;

use super::common::numbers::Numbers;
use super::judge::Judge;
use super::{Dense, add_contacts, free_of, full, growth_of, limit_of, outside, penalties, with_limit};

fn row(parts: &[(f64, f64, f64, usize)], ends: (End, End)) -> Scene {
    let bar = |&(youngs_modulus, density, area, elements): &(f64, f64, f64, usize)| Bar {
        length: elements as f64,
        elements,
        youngs_modulus,
        density,
        area,
        velocity: 0.0,
    };
    Scene::new("row", ends.0, parts.iter().map(bar).collect(), ends.1, None).unwrap()
}

/// With a factor for each contact these bars flutter at every step; the limit computed then was 0.40659.
#[test]
fn coupled_contacts_with_one_factor_do_not_flutter() {
    let scene =
        row(&[(0.27, 0.064, 1.0, 1), (0.016, 0.055, 1.0, 1), (0.048, 0.035, 1.0, 3)], (End::Free, End::Wall));
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let p = penalties(&model, 1e4, 1.0);
    for theta in [0.0, 0.5, 1.0] {
        with_limit(&model, SchemeName::Park, theta, &p, |limit, matrix, _| {
            for i in 1..400 {
                let (count, largest) = outside(&matrix(limit * f64::from(i) / 400.0));
                assert_eq!(count, 0, "theta = {theta}: |z| = {largest} at {i}/400 of {limit}");
            }
            assert!(outside(&matrix(1.001 * limit)).0 > 0, "theta = {theta}: stable above {limit}");
        });
    }
}

/// A factor for each contact, and a sign divided by a number that may then be negative, put this limit elsewhere.
#[test]
fn the_park_limit_of_a_soft_bar_behind_a_stiff_one_is_its_own() {
    let scene = row(&[(26.0, 0.6, 4.6, 1), (0.4, 9.0, 0.12, 1)], (End::Free, End::Wall));
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let p = penalties(&model, 3e4, 4.0);
    with_limit(&model, SchemeName::Park, 0.5, &p, |limit, matrix, engine| {
        let courant = model.critical_courant(free_of(engine).value) * limit;
        assert!((courant - 0.257104).abs() < 1e-6, "{courant}");
        assert_eq!(outside(&matrix(limit * 0.9999)).0, 0);
        assert!(outside(&matrix(limit * 1.001)).0 > 0);
    });
}

/// Two to four bars, one or two elements between contacts, contrasts to 1e3.
#[test]
fn the_park_limit_holds_for_coupled_contacts() {
    let counts: Vec<[usize; 2]> = (0..3000).into_par_iter().map(|point| check(point as u64)).collect();
    let sum = counts.iter().fold([0; 2], |sum, c| [sum[0] + c[0], sum[1] + c[1]]);
    println!("{sum:?} of 3000 grow 0.1 % above too slowly to be seen, are seen to grow 1e-9 above");
    assert!(sum[0] < 10 && sum[1] > 2000, "{sum:?}");
}

/// One to three contacts, one or two elements between them, contrasts to 1e3: a model and its penalty.
struct CoupledPoint {
    model: Model,
    theta: f64,
    beta_s: f64,
    ratio: f64,
    penalty: Penalty,
    numbers: Numbers,
}

fn point_of(point: u64) -> CoupledPoint {
    let mut numbers = Numbers(1000 + 7919 * point);
    for _ in 0..5 {
        numbers.next();
    }
    let parts: Vec<_> = (0..2 + (3.0 * numbers.next()) as usize)
        .map(|_| {
            let mut any = || 10f64.powf(numbers.between(-1.5, 1.5));
            (any(), any(), any(), 1 + usize::from(any() > 1.0))
        })
        .collect();
    let ends = [End::Free, End::Fixed, End::Wall];
    let scene = row(&parts, (numbers.one_of(&ends), numbers.one_of(&ends)));
    let gamma = numbers.one_of(&[0.0, 0.5, 1.0]);
    let theta = numbers.one_of(&[0.0, 0.5, 1.0]);
    let model = Model::new(scene, MassMatrix::new(gamma).unwrap(), PenaltyMass::Consistent);
    let ratio = numbers.one_of(&[0.1, 0.25, 1.0, 3.0, 30.0, f64::INFINITY]);
    let beta_s = 10f64.powf(numbers.between(0.0, 6.0));
    let penalty = penalties(&model, beta_s, ratio);
    CoupledPoint { model, theta, beta_s, ratio, penalty, numbers }
}

fn check(point: u64) -> [usize; 2] {
    let CoupledPoint { model, theta, beta_s, ratio, penalty: p, mut numbers } = point_of(point);
    let pencil = model.pencil();
    let engine = limit_of(&model, &pencil, SchemeName::Park, theta);
    let place = || format!("point {point}, beta_s = {beta_s:e}, r = {ratio}, theta = {theta}, {model:?}");
    let step = engine.enclose(&p, None).unwrap_or_else(|error| panic!("{error}: {}", place()));
    let far = 2.0 / free_of(&*engine).value.sqrt();
    let judge = Judge::new(&pencil, &p);
    for below in [numbers.next(), numbers.next(), 0.97, 1.0 - 1e-6, 1.0] {
        let dt = below * step.lower();
        assert!(!judge.park_grows(dt, far, theta), "grows at {below} of {}: {}", step.lower(), place());
    }
    let grows_above = |excess: f64| {
        let above = (1.0 + excess) * step.upper();
        let predicted = growth_of(&*engine, &p, above / far);
        let slow = predicted.is_some_and(|growth| growth < 2.0 * SEEN);
        let grows = slow || judge.park_grows(above, far, theta);
        assert!(grows, "stable {excess} above {step:?}, predicted {predicted:?}: {}", place());
        slow
    };
    // Next to dt_c the scheme may be stable again beyond it.
    let close = (1.0 + 1e-9) * step.upper() < far && !grows_above(1e-9);
    [usize::from(grows_above(1e-3)), usize::from(close)]
}

/// Growth a step that [`Judge`] sees.
const SEEN: f64 = 1.2e-12;

/// The same scenes by the predictor-corrector, whose bound must not be passed, and by the spectrum, whose limit must not be
/// missed: central differences are stable below it and grow 0.1 % above it.
#[test]
fn the_bound_of_the_predictor_corrector_and_the_spectrum_hold_for_coupled_contacts() {
    let counts: Vec<[usize; 4]> = (0..3000).into_par_iter().map(|point| look(point as u64)).collect();
    let sum = counts.iter().fold([0; 4], |sum, c| [0, 1, 2, 3].map(|i| sum[i] + c[i]));
    println!(
        "{sum:?} of 3000: lower bounds, below the contact-free step, grown between it and 1.5 times it; growth above a limit seen"
    );
    assert!(sum[0] > 1500 && sum[1] > 1000 && sum[2] > 500 && sum[3] > 300, "{sum:?}");
}

fn look(point: u64) -> [usize; 4] {
    let CoupledPoint { model, beta_s, ratio, penalty, mut numbers, .. } = point_of(point);
    let pencil = model.pencil();
    let dense = Dense::new(&pencil, &penalty);
    let place = || format!("point {point}, beta_s = {beta_s:e}, r = {ratio}, {model:?}");
    let spectrum = limit_of(&model, &pencil, SchemeName::CentralDifference, 0.0);
    let dt = spectrum.enclose(&penalty, None).unwrap().seconds();
    let modes = central_modes(&pencil, &penalty);
    for (c, grows) in [(numbers.next(), false), (1.0 - 1e-4, false), (1.001, true)] {
        // z^2 - (2 - dt^2 l) z + 1 = 0: on the circle exactly while dt^2 l <= 4.
        assert_eq!((c * dt).powi(2) * modes > 4.0, grows, "central differences at {c} of {dt}: {}", place());
    }
    let limit = limit_of(&model, &pencil, SchemeName::PredictorCorrector, 0.0);
    let step = limit.enclose(&penalty, None).unwrap();
    let far = 2.0 / free_of(&*limit).value.sqrt();
    let dt = step.lower();
    let judge = Judge::new(&pencil, &penalty);
    for c in [numbers.next(), numbers.next(), 0.97, 1.0 - 1e-6, 1.0] {
        assert!(!judge.predictor_corrector_grows(c * dt), "grows at {c} of {dt}, dt_c = {far}: {}", place());
    }
    let bound = step.evidence == Evidence::LowerBound;
    let mut seen = 0;
    if !bound {
        let predicted = limit.growth(&penalty, &step, 1.001).unwrap();
        let grows = judge.predictor_corrector_grows(1.001 * step.seconds());
        assert!(
            grows || predicted < 2.0 * SEEN,
            "stable above {step:?}, predicted {predicted:e}: {}",
            place()
        );
        seen = usize::from(grows);
    }
    assert!(dt <= step.upper() && step.upper().is_finite(), "{step:?}: {}", place());
    if bound {
        let (above, grows) = (1.0 + 1e-6, |dt| judge.predictor_corrector_grows(dt));
        assert!(grows(above * step.upper()), "stable above {step:?}: {}", place());
    }
    let short = dt < 0.999 * far;
    let grown = outside(&scaled_pair(&dense.predictor_corrector(1.5 * dt), &pencil, dt)).0 > 0;
    [usize::from(bound), usize::from(bound && short), usize::from(bound && short && grown), seen]
}

/// l_max(K + K_p, M + M_p) by the dense eigenvalues of a symmetric matrix.
fn central_modes(pencil: &Pencil, penalty: &Penalty) -> f64 {
    let (mut k, mut m) = (full(pencil.stiffness()), full(pencil.mass()));
    add_contacts(pencil, penalty, &mut k, &mut m);
    let n = k.nrows();
    let unit: Vec<f64> = (0..n).map(|i| m[(i, i)].sqrt()).collect();
    let by_unit = |a: &Mat<f64>| Mat::from_fn(n, n, |i, j| a[(i, j)] / unit[i] / unit[j]);
    let factor = by_unit(&m).llt(Side::Lower).unwrap();
    let mut reduced = by_unit(&k);
    for _ in 0..2 {
        solve_lower_triangular_in_place(factor.L(), reduced.as_mut(), Par::Seq);
        reduced = reduced.transpose().to_owned();
    }
    reduced.self_adjoint_eigenvalues(Side::Lower).unwrap()[n - 1]
}

/// The matrix for the states (u, dt v), each node by the root of its mass.
fn scaled_pair(matrix: &Mat<f64>, pencil: &Pencil, dt: f64) -> Mat<f64> {
    let n = pencil.size();
    let unit = |i: usize| pencil.mass().diagonal(i % n).sqrt() * dt.powi((i / n) as i32);
    Mat::from_fn(2 * n, 2 * n, |i, j| matrix[(i, j)] * unit(i) / unit(j))
}

/// Contact by contact dt^2 s'_j mu_j <= 1 would allow 1.22 times the bound, and the scheme grows there by 36 % a step.
#[test]
fn a_step_contact_by_contact_is_not_enough_for_coupled_contacts() {
    // One element with stiffness k = E A/h and mass m = rho A h, h = A = 1.
    let scene = row(&[(14.8, 55.9, 1.0, 1), (0.0155, 0.0144, 1.0, 1)], (End::Free, End::Wall));
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let p = penalties(&model, 250.0, f64::INFINITY);
    let pencil = model.pencil();
    let limit = limit_of(&model, &pencil, SchemeName::PredictorCorrector, 0.0);
    let dt = limit.enclose(&p, None).unwrap().lower();
    let chain = pencil.chain().unwrap();
    let own = chain.compliance().iter().zip(chain.terms(&p)).map(|(mu, p)| p.stiffness * mu);
    let alone = 1.0 / own.fold(0.0, f64::max).sqrt();
    assert!((alone / dt - 1.22).abs() < 0.005, "{} times", alone / dt);
    let largest = |dt: f64| outside(&Dense::new(&pencil, &p).predictor_corrector(dt)).1;
    println!("|z| = {} at the bound, {} at {} times it", largest(dt), largest(alone), alone / dt);
    assert!(largest(dt) <= 1.0 + 1e-6 && largest(alone) > 1.3);
}
