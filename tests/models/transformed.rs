//! Limits that the spectrum tells after a change of variables: damped steps beside the matrix that decides, steps of other
//! explicit schemes beside those of the spectrum.

use bipenalty::damping::Damping;
use bipenalty::error::Error;
use bipenalty::pencil::{Gap, Matrix};
use bipenalty::schemes::SchemeName;
use bipenalty::schemes::explicit::ExplicitName;
use bipenalty::stability::{AnyModel, Asking, LimitOf};
use faer::linalg::solvers::Llt;
use faer::{Mat, Side};

use crate::bars::{as_matrices, bars};
use crate::largest::models;
use bipenalty::fem::MassMatrix;

/// Damping in parts that matter at the top frequency of `model`.
pub fn dampings(model: &AnyModel) -> [Damping; 3] {
    let omega = model.reference().unwrap().sqrt();
    [(0.3 * omega, 0.0, 0.0), (0.0, 0.2 / omega, 0.0), (0.05 * omega, 0.1 / omega, 0.3 / omega)]
        .map(|(a, b, c)| Damping::new(a, b, c).unwrap())
}

/// The limits that are no scheme's of this crate.
pub fn limits(model: &AnyModel) -> Vec<Asking> {
    let damped = dampings(model).map(LimitOf::Damped);
    let explicit = ExplicitName::ALL.map(|name| LimitOf::Explicit(name.with(None).unwrap()));
    damped.into_iter().chain(explicit).map(|limit| Asking { limit, ..Asking::default() }).collect()
}

fn full(matrix: &Matrix) -> Mat<f64> {
    let mut entries = Mat::zeros(matrix.size(), matrix.size());
    (0..matrix.size()).for_each(|i| matrix.row(i).for_each(|(j, a)| entries[(i, j)] = a));
    entries
}

/// P = sum_j w_j z_j z_j'.
fn contacts(gaps: &[Gap], n: usize) -> Mat<f64> {
    let mut sum = Mat::zeros(n, n);
    for gap in gaps {
        for (i, a) in &gap.column.0 {
            gap.column.0.iter().for_each(|(j, b)| sum[(*i as usize, *j as usize)] += gap.scale * a * b);
        }
    }
    sum
}

/// Whether 4 (M + M_p) - 2 h C - h^2 (K + K_p) is positive definite.
fn is_stable(model: &AnyModel, damping: Damping, (beta_s, ratio): (f64, f64), h: f64) -> bool {
    let AnyModel::Mesh(mesh) = model else { panic!("bars") };
    let (k, m, gaps) = mesh.matrices();
    let (k, m, p) = (full(k), full(m), contacts(gaps, k.size()));
    let inertia = beta_s / (ratio * model.reference().unwrap());
    let decides = &m * (4.0 - 2.0 * h * damping.mass()) - &k * (h * h + 2.0 * h * damping.stiffness())
        + &p * (4.0 * inertia - 2.0 * h * damping.contact() * beta_s - h * h * beta_s);
    Llt::new(decides.as_ref(), Side::Lower).is_ok()
}

#[test]
fn damped_meshes_are_stable_up_to_their_limit_and_not_beyond() {
    for model in models().into_iter().filter(|model| matches!(model, AnyModel::Mesh(_))) {
        for damping in dampings(&model) {
            for point in [(0.0, 1.0), (3.0, 0.4), (3.0, 2.0), (1e3, 1.0), (1e3, f64::INFINITY)] {
                let asking = Asking { limit: LimitOf::Damped(damping), ..Asking::default() };
                let step = model.critical_step(point.0, point.1, &asking).unwrap().step.unwrap();
                let place = format!("{}, {damping:?}, {point:?}: {step:?}", model.name());
                let seconds = |courant: f64| model.time_step(courant).unwrap();
                assert!(step.upper / step.lower - 1.0 < 1e-8, "{place}");
                assert!(is_stable(&model, damping, point, seconds(step.lower) * (1.0 - 1e-7)), "{place}");
                assert!(!is_stable(&model, damping, point, seconds(step.upper) * (1.0 + 1e-7)), "{place}");
            }
        }
    }
}

#[test]
fn other_schemes_stand_a_multiple_of_the_step() {
    for model in models() {
        for name in ExplicitName::ALL {
            let scheme = name.with(None).unwrap();
            let longer = 0.5 * scheme.largest();
            let asking = Asking { limit: LimitOf::Explicit(scheme), ..Asking::default() };
            for (beta_s, ratio) in [(0.0, 1.0), (1e3, 2.0), (1e3, f64::INFINITY)] {
                let of = |asking: &Asking| model.critical_step(beta_s, ratio, asking).unwrap().step.unwrap();
                let (step, spectrum) = (of(&asking), of(&Asking::default()));
                assert!((step.critical_courant / spectrum.critical_courant / longer - 1.0).abs() < 1e-8);
                assert!(step.lower <= step.critical_courant && step.critical_courant <= step.upper);
            }
        }
    }
}

/// Damped and undamped, bars by their own engines and as matrices give the same.
#[test]
fn damped_bars_agree_with_their_matrices() {
    let (rod, matrices) = (
        AnyModel::Bars(bars("hunek", 5, MassMatrix::CONSISTENT)),
        AnyModel::Mesh(Box::new(as_matrices(&bars("hunek", 5, MassMatrix::CONSISTENT)))),
    );
    for damping in dampings(&rod) {
        for (beta_s, ratio) in [(0.0, 1.0), (3.0, 0.4), (1e3, 2.0), (1e3, f64::INFINITY)] {
            let asking = Asking { limit: LimitOf::Damped(damping), ..Asking::default() };
            let seconds = |model: &AnyModel| {
                let step = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
                (model.time_step(step.lower).unwrap(), model.time_step(step.upper).unwrap())
            };
            let (own, other) = (seconds(&rod), seconds(&matrices));
            assert!(
                own.0 <= other.1 && other.0 <= own.1,
                "{damping:?}, {beta_s}, {ratio}: {own:?} {other:?}"
            );
        }
    }
}

#[test]
fn what_is_not_derived_with_damping_is_refused() {
    let model = AnyModel::Mesh(Box::new(as_matrices(&bars("signorini", 4, MassMatrix::LUMPED))));
    let asking = Asking { limit: LimitOf::Damped(dampings(&model)[1]), ..Asking::default() };
    let place = |error: Error| match error {
        Error::Refused(refusal) => refusal.place,
        other => panic!("{other}"),
    };
    let rod = AnyModel::Bars(bars("signorini", 4, MassMatrix::LUMPED));
    assert_eq!(place(model.optimal_ratio(1.0, &asking).unwrap_err()), "limit");
    assert_eq!(place(rod.optimal_ratio(1.0, &asking).unwrap_err()), "limit");
    assert_eq!(place(model.governs(1.0, 1.0, &asking).unwrap_err()), "limit");
    let damped = bipenalty::schemes::damped(SchemeName::PredictorCorrector, dampings(&model)[0]).unwrap();
    let asking = Asking { limit: LimitOf::Scheme(damped), ..Asking::default() };
    assert_eq!(model.critical_step(1.0, 1.0, &asking).unwrap_err().place, "limit");
}
