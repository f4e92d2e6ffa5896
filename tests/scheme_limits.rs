//! The limits of the predictor-corrector and the Park scheme against their dense amplification matrices.
//!
//! A multiplier counts as outside the unit circle beyond 1 + TOLERANCE. Rigid motion has the defective multiplier 1,
//! which rounding splits by sqrt(eps) = 1.5e-8 times the norm of the matrix: so multipliers nearer to 1 than
//! RIGID = 1e-4 are left out, and TOLERANCE is 1e-7.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;
#[path = "scheme_limits/coupled.rs"]
mod coupled;
#[path = "scheme_limits/islands.rs"]
mod islands;
#[path = "scheme_limits/judge.rs"]
mod judge;

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::{Matrix, Penalty, Pencil};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::{ClosedLimit, SchemeName};
use bipenalty::spectrum::{Enclosure, Engine as _, Evidence, StepLimit};
use bipenalty::stability::Model;
use common::numbers::Numbers;
use faer::Mat;
use faer::linalg::solvers::Solve;

const TOLERANCE: f64 = 1e-7;
const RIGID: f64 = 1e-4;

fn full(matrix: &Matrix) -> Mat<f64> {
    let mut entries = Mat::zeros(matrix.size(), matrix.size());
    (0..matrix.size()).for_each(|i| matrix.row(i).for_each(|(j, a)| entries[(i, j)] = a));
    entries
}

/// Adds Z s Z' and Z m Z'.
fn add_contacts(pencil: &Pencil, penalty: &Penalty, stiffness: &mut Mat<f64>, mass: &mut Mat<f64>) {
    for gap in pencil.gaps() {
        let (s, m) = penalty.of(gap.scale);
        for (i, a) in &gap.column.0 {
            for (j, b) in &gap.column.0 {
                stiffness[(*i as usize, *j as usize)] += s * a * b;
                mass[(*i as usize, *j as usize)] += m * a * b;
            }
        }
    }
}

/// K, M and the columns of Z with the contact terms: what the schemes apply to a vector, as dense matrices.
struct Dense {
    /// M^-1 K.
    free: Mat<f64>,
    /// (M + Z m Z')^-1 Z s Z'.
    contact: Mat<f64>,
}

impl Dense {
    fn new(pencil: &Pencil, penalty: &Penalty) -> Self {
        let n = pencil.size();
        let (k, m) = (full(pencil.stiffness()), full(pencil.mass()));
        let (mut kp, mut mp) = (Mat::<f64>::zeros(n, n), m.clone());
        add_contacts(pencil, penalty, &mut kp, &mut mp);
        Self { free: m.partial_piv_lu().solve(&k), contact: mp.partial_piv_lu().solve(&kp) }
    }

    fn size(&self) -> usize {
        self.free.nrows()
    }

    /// u, v -> u, v of the predictor-corrector, acting on a basis of states: (M^-1 K and the contact as matrices).
    fn predictor_corrector(&self, dt: f64) -> Mat<f64> {
        let n = self.size();
        let (u, v) = (basis(n, 2, 0), basis(n, 2, 1));
        let rate = &self.free * &u * -1.0;
        let velocity = &v + &rate * dt;
        let predicted = &u + &velocity * dt;
        let velocity = velocity - &self.contact * &predicted * dt;
        let displacement = &u + &velocity * dt;
        stack(&[displacement, velocity])
    }

    /// u, v, a -> u, v, a of the Park scheme as the paper writes it (4.5).
    fn park(&self, dt: f64, far: f64, theta: f64) -> Mat<f64> {
        let n = self.size();
        let (u, v, a) = (basis(n, 3, 0), basis(n, 3, 1), basis(n, 3, 2));
        let alpha = dt / far;
        let b1 = alpha / 6.0 * (1.0 + 3.0 * alpha - alpha * alpha);
        let b2 = alpha / 6.0 * (alpha * alpha - 1.0);
        let ahead = &u + &v * far + &a * (0.5 * far * far);
        let ahead_rate = &self.free * &ahead * -1.0;
        let pulled = &u + &v * dt + &a * (far * far * b1) + &ahead_rate * (far * far * b2);
        let pushed = &u + &v * dt + &a * (0.5 * dt * dt);
        let displacement = &pulled * theta + &pushed * (1.0 - theta);
        let rate = (&self.free * &displacement + &self.contact * &displacement) * -1.0;
        let velocity = &v + (&a + &rate) * (0.5 * dt);
        stack(&[displacement, velocity, rate])
    }
}

/// The unit states of part `part` of `parts`, n x (parts n).
fn basis(n: usize, parts: usize, part: usize) -> Mat<f64> {
    Mat::from_fn(n, parts * n, |i, j| f64::from(u8::from(j == part * n + i)))
}

fn stack(parts: &[Mat<f64>]) -> Mat<f64> {
    let n = parts[0].nrows();
    Mat::from_fn(n * parts.len(), parts[0].ncols(), |i, j| parts[i / n][(i % n, j)])
}

/// Multipliers outside the unit circle, and the largest modulus, rigid motion left out.
fn outside(matrix: &Mat<f64>) -> (usize, f64) {
    let multipliers = matrix.eigenvalues().expect("eigenvalues of the amplification matrix");
    let moduli = multipliers.iter().filter(|z| (z.re - 1.0).hypot(z.im) > RIGID).map(|z| z.re.hypot(z.im));
    moduli.fold((0, 0.0), |(count, largest), modulus: f64| {
        (count + usize::from(modulus > 1.0 + TOLERANCE), largest.max(modulus))
    })
}

fn penalties(model: &Model, beta_s: f64, ratio: f64) -> Penalty {
    model.penalty(StiffnessPenalty::new(beta_s).unwrap(), Ratio::new(ratio).unwrap())
}

fn limit_of<'a>(
    model: &Model,
    pencil: &'a Pencil,
    scheme: SchemeName,
    theta: f64,
) -> Box<dyn StepLimit + 'a> {
    model.limit(&*scheme.with_theta(theta).unwrap(), pencil).unwrap()
}

/// The contact-free l_max.
fn free_of(limit: &dyn StepLimit) -> Enclosure {
    limit.enclose(&Penalty::NONE, None).unwrap().l
}

/// |z| - 1 of the largest multiplier at a step over the contact-free one.
fn growth_of(limit: &dyn StepLimit, penalty: &Penalty, relative: f64) -> Option<f64> {
    let step = limit.enclose(penalty, None).unwrap();
    let excess = relative / (free_of(limit).value / step.l.value).sqrt();
    limit.growth(penalty, &step, excess).map(f64::exp_m1)
}

/// dt of the limit over the contact-free one.
fn relative_limit(limit: &dyn StepLimit, penalties: &Penalty) -> f64 {
    let l = limit.enclose(penalties, None).map(|step| step.l).unwrap_or_else(|e| {
        panic!("{}, {penalties:?}, contact-free {:?}: {e}", limit.name(), free_of(limit))
    });
    assert!(l.lower <= l.value && l.value <= l.upper && l.relative_width() < 2e-13);
    (free_of(limit).value / l.value).sqrt()
}

/// The islands as steps over the contact-free one.
fn islands_of(limit: &dyn StepLimit, penalty: &Penalty) -> Vec<(f64, f64)> {
    let relative = |l: f64| (free_of(limit).value / l).sqrt();
    limit.islands(penalty).into_iter().map(|(high, low)| (relative(high), relative(low))).collect()
}

/// The limit of `scheme` with its dense matrix as a function of dt over the contact-free step.
fn with_limit<R>(
    model: &Model,
    scheme: SchemeName,
    theta: f64,
    penalties: &Penalty,
    check: impl FnOnce(f64, &dyn Fn(f64) -> Mat<f64>, &dyn StepLimit) -> R,
) -> R {
    let pencil = model.pencil();
    let limit = limit_of(model, &pencil, scheme, theta);
    let dense = Dense::new(&pencil, penalties);
    let far = 2.0 / free_of(&*limit).value.sqrt();
    let matrix = |c: f64| match scheme {
        SchemeName::Park => dense.park(c * far, far, theta),
        _ => dense.predictor_corrector(c * far),
    };
    check(relative_limit(&*limit, penalties), &matrix, &*limit)
}

#[test]
fn every_multiplier_is_inside_below_the_limit_and_one_outside_above() {
    let mut numbers = Numbers(1);
    let (mut seen, mut unseen) = ([0; 2], [0; 2]);
    for point in 0..200 {
        let scene = numbers.scene();
        let model = Model::new(scene, numbers.mass(), PenaltyMass::Consistent);
        let (beta_s, ratio) =
            (10f64.powf(numbers.between(-2.0, 6.0)), 10f64.powf(numbers.between(-2.0, 2.0)));
        let theta = numbers.one_of(&[0.0, 0.1, 0.25, 0.5, 0.75, 1.0]);
        let penalties = penalties(&model, beta_s, ratio);
        for (which, scheme) in [SchemeName::PredictorCorrector, SchemeName::Park].into_iter().enumerate() {
            with_limit(&model, scheme, theta, &penalties, |limit, matrix, engine| {
                let place = || {
                    format!(
                        "point {point}, {scheme:?}, beta_s = {beta_s:e}, r = {ratio:e}, theta = {theta}, {model:?}"
                    )
                };
                for below in [0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999] {
                    let (count, largest) = outside(&matrix(below * limit));
                    assert_eq!(count, 0, "|z| = {largest} at {below} of {limit}: {}", place());
                }
                let mut above = 1.0 + 2e-3;
                if scheme == SchemeName::Park && limit < 1.0 {
                    above = (above * limit).min(0.5 * (1.0 + limit)) / limit;
                }
                let (count, largest) = outside(&matrix(above * limit));
                let Some(growth) = growth_of(engine, &penalties, above * limit) else {
                    assert!(limit == 1.0 && count > 0, "stable beyond dt_c: {}", place());
                    return;
                };
                if growth > 10.0 * TOLERANCE {
                    seen[which] += 1;
                    assert!(count > 0, "stable at {above} of {limit}, predicted {growth:e}: {}", place());
                    let ratio = (largest - 1.0) / growth;
                    assert!(
                        (0.5..2.0).contains(&ratio),
                        "growth {largest} - 1 = {ratio} of {growth:e}: {}",
                        place()
                    );
                } else {
                    unseen[which] += 1;
                    assert!(
                        largest - 1.0 < 20.0 * TOLERANCE,
                        "|z| = {largest}, predicted {growth:e}: {}",
                        place()
                    );
                }
            });
        }
    }
    println!("growth seen (predictor-corrector, Park): {seen:?}, below the tolerance: {unseen:?}");
    assert!(seen[0] >= 100 && seen[1] >= 150, "{seen:?} seen, {unseen:?} below the tolerance");
}

fn on_a_wall(elements: usize, gamma: f64) -> Model {
    let scene = Scene::new("wall", End::Free, vec![Bar::unit(elements)], End::Wall, None).unwrap();
    Model::new(scene, MassMatrix::new(gamma).unwrap(), PenaltyMass::Consistent)
}

fn relative(model: &Model, scheme: SchemeName, theta: f64, beta_s: f64, ratio: f64) -> f64 {
    let pencil = model.pencil();
    let limit = limit_of(model, &pencil, scheme, theta);
    relative_limit(&*limit, &penalties(model, beta_s, ratio))
}

#[test]
fn the_predictor_corrector_keeps_half_the_step_of_a_stiff_optimal_penalty() {
    // C^2 = 1/(2 beta_s) + 1/(4 r) of a lumped bar on a wall.
    for (beta_s, ratio) in
        [(1.0, 1.0), (2.0, 1.0), (10.0, 1.0), (1e4, 1.0), (1e12, 2.0), (50.0, f64::INFINITY)]
    {
        for elements in [1, 10, 333] {
            let expected = (0.5 / beta_s + 0.25 / ratio).sqrt();
            let found =
                relative(&on_a_wall(elements, 1.0), SchemeName::PredictorCorrector, 0.5, beta_s, ratio);
            assert!((found / expected - 1.0).abs() < 1e-13, "beta_s = {beta_s}: {found} is not {expected}");
        }
    }
    let consistent = relative(&on_a_wall(7, 0.0), SchemeName::PredictorCorrector, 0.5, 30.0, 1.0);
    assert!((consistent - 0.52808).abs() < 5e-6, "{consistent}");
    let two = Scene::new("two", End::Free, vec![Bar::unit(5), Bar::unit(10)], End::Free, None).unwrap();
    let two = Model::new(two, MassMatrix::LUMPED, PenaltyMass::Consistent);
    let found = relative(&two, SchemeName::PredictorCorrector, 0.5, 1.0, 1.0);
    assert!((found - 0.5f64.sqrt()).abs() < 1e-13, "{found}");
}

#[test]
fn the_park_scheme_loses_three_tenths_of_the_step_to_a_stiff_optimal_penalty() {
    let found = relative(&on_a_wall(10, 1.0), SchemeName::Park, 0.5, 1e4, 1.0);
    assert!((found - 0.7072).abs() < 5e-5, "{found}");
}

#[test]
fn the_park_scheme_without_pullback_has_the_limit_of_its_effective_stiffness() {
    // theta = 0 leaves central differences with s' for s and no mass penalty.
    for gamma in [0.0, 0.5, 1.0] {
        for (beta_s, ratio) in [(0.01, 1.0), (3.0, 0.5), (1e5, 20.0), (1e9, f64::INFINITY)] {
            let model = on_a_wall(6, gamma);
            let pencil = model.pencil();
            let (p, chain) = (penalties(&model, beta_s, ratio), pencil.chain().unwrap());
            let mass = p.terms(model.scales()[0]).mass;
            let left =
                Penalty { stiffness: p.stiffness / (1.0 + mass * chain.compliance()[0]), ..Penalty::NONE };
            let l_max = bipenalty::spectrum::Sturm::new(chain).enclose(&left, None).unwrap().value;
            let limit = limit_of(&model, &pencil, SchemeName::Park, 0.0);
            let found = limit.enclose(&p, None).unwrap().l;
            assert!((found.value / l_max - 1.0).abs() < 2e-13, "{} is not {l_max}", found.value);
        }
    }
}

#[test]
fn a_quarter_is_the_largest_ratio_free_of_cost_to_the_predictor_corrector() {
    let mut numbers = Numbers(4);
    for point in 0..200 {
        let scene = numbers.scene();
        let model = Model::new(scene, numbers.mass(), PenaltyMass::Consistent);
        let top = {
            let pencil = model.pencil();
            let limit = limit_of(&model, &pencil, SchemeName::PredictorCorrector, 0.5);
            // r* is measured in the frequency of the elements that touch; r = 1/4 keeps their limit.
            free_of(&*limit).value / model.reference_eigenvalue()
        };
        let beta_s = 10f64.powf(numbers.between(5.0, 9.0));
        let kept = relative(&model, SchemeName::PredictorCorrector, 0.5, beta_s, 0.25 * top);
        let lost = relative(&model, SchemeName::PredictorCorrector, 0.5, beta_s, 0.26 * top);
        assert!(kept >= 1.0 - 1e-13, "point {point}: {kept} at r = 0.25");
        assert!(lost < 1.0 - 1e-3, "point {point}: {lost} at r = 0.26");
    }
}

#[test]
fn several_contacts_are_limited_together() {
    let mut numbers = Numbers(9);
    for point in 0..60 {
        let alike = numbers.next() < 0.5;
        let bars: Vec<Bar> = if alike {
            vec![Bar::unit(2 + (5.0 * numbers.next()) as usize); 1 + (2.0 * numbers.next()) as usize]
        } else {
            (0..3).map(|_| numbers.bar(0.5)).collect()
        };
        let walls = if bars.len() == 2 { (End::Free, End::Free) } else { (End::Wall, End::Wall) };
        let scene = Scene::new("row", walls.0, bars, walls.1, None).unwrap();
        let mass = if alike { MassMatrix::LUMPED } else { numbers.mass() };
        let model = Model::new(scene, mass, PenaltyMass::Consistent);
        let p =
            penalties(&model, 10f64.powf(numbers.between(0.0, 4.0)), 10f64.powf(numbers.between(-0.3, 1.0)));
        let theta = numbers.one_of(&[0.25, 0.5, 1.0]);
        let schemes: &[SchemeName] =
            if alike { &[SchemeName::PredictorCorrector, SchemeName::Park] } else { &[SchemeName::Park] };
        for scheme in schemes {
            with_limit(&model, *scheme, theta, &p, |limit, matrix, _| {
                for below in [0.3, 0.8, 0.999] {
                    let (count, largest) = outside(&matrix(below * limit));
                    assert_eq!(count, 0, "point {point}, {scheme:?}: |z| = {largest} at {below} of {limit}");
                }
                let (_, largest) = outside(&matrix(1.02 * limit));
                assert!(largest > 1.0 + 1e-9, "point {point}, {scheme:?}: stable above {limit}");
            });
        }
    }
}

#[test]
fn what_the_limits_are_not_derived_for_is_refused() {
    let refusal = |scene: Scene, form: PenaltyMass, scheme: SchemeName, theta: f64| {
        let model = Model::new(scene, MassMatrix::LUMPED, form);
        let pencil = model.pencil();
        let limit = scheme.with_theta(theta).and_then(|scheme| model.limit(&*scheme, &pencil).map(|_| ()));
        limit.unwrap_err().to_string()
    };
    let pair = || Scene::new("pair", End::Free, vec![Bar::unit(2), Bar::unit(3)], End::Free, None).unwrap();
    let consistent = PenaltyMass::Consistent;
    let text = refusal(pair(), PenaltyMass::Diagonalised, SchemeName::Park, 0.5);
    assert!(text.contains("diagonalised"), "{text}");
    let text = refusal(pair(), consistent, SchemeName::Park, 1.5);
    assert!(text.contains("theta: 1.5"), "{text}");
    let text = refusal(pair(), PenaltyMass::Diagonalised, SchemeName::PredictorCorrector, 0.5);
    assert!(text.contains("diagonalised"), "{text}");
}

/// What has a lower bound has no plastic ratio: that is a limit at which the scheme is run.
#[test]
fn where_the_limit_is_not_known_there_is_a_lower_bound_and_no_plastic_ratio() {
    let scene = |bars: &[usize], ends: (End, End)| {
        Scene::new("several", ends.0, bars.iter().map(|n| Bar::unit(*n)).collect(), ends.1, None).unwrap()
    };
    for (scene, what) in [
        (scene(&[1], (End::Fixed, End::Wall)), "single nodes"),
        (scene(&[1], (End::Wall, End::Wall)), "every node"),
        (scene(&[2, 3], (End::Free, End::Wall)), "unlike contacts"),
    ] {
        let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
        let pencil = model.pencil();
        let limit = limit_of(&model, &pencil, SchemeName::PredictorCorrector, 0.5);
        let step = limit.enclose(&penalties(&model, 10.0, 1.0), None).unwrap();
        assert!(
            step.evidence == Evidence::LowerBound && step.upper() < 2.5 * step.lower(),
            "{what}: {step:?}"
        );
        let free = limit.enclose(&Penalty::NONE, None).unwrap();
        assert_eq!(free.evidence, Evidence::Proven, "{what}: contact-free");
        let text = ClosedLimit::new(&pencil, Box::new(model.auto())).map(|_| ()).unwrap_err().to_string();
        assert!(text.contains(what), "{text}");
    }
}

#[test]
fn the_plastic_ratio_takes_the_penetration_out_in_one_step() {
    for gamma in [0.0, 0.5, 1.0] {
        let model = on_a_wall(9, gamma);
        let pencil = model.pencil();
        let limit = limit_of(&model, &pencil, SchemeName::PredictorCorrector, 0.5);
        let plastic = ClosedLimit::new(&pencil, Box::new(model.auto())).unwrap();
        for (beta_s, c) in [(1e3, 0.5), (1e8, 0.5), (1e5, 0.9), (10.0, 1.0)] {
            let ratio = plastic.plastic_ratio(beta_s, c).unwrap();
            let p = penalties(&model, beta_s, ratio);
            let found = relative_limit(&*limit, &p);
            assert!((found / c - 1.0).abs() < 1e-13, "{found} is not {c}");
            let dt2 = 4.0 * c * c / free_of(&*limit).value;
            let (mu, p) = (pencil.chain().unwrap().compliance()[0], p.terms(model.scales()[0]));
            let plasticity = dt2 * p.stiffness * mu / (1.0 + p.mass * mu);
            assert!((plasticity - 1.0).abs() < 1e-13, "{plasticity}");
        }
        let small = plastic.plastic_ratio(0.01, 0.5);
        assert!(small.unwrap_err().to_string().contains("beta_s above"));
    }
}
