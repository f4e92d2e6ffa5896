//! The largest penalty and ratio of a step, the optimal ratio and contour lines, held against the limits themselves.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::schemes::SchemeName;
use bipenalty::stability::{AnyModel, AnyScene, Asking, LimitOf};

use crate::bars::{as_matrices, bars};
use crate::scenes::TWO_BLOCKS;
use crate::transformed;

pub fn models() -> Vec<AnyModel> {
    let mesh = AnyScene::parse(TWO_BLOCKS, "blocks.toml").unwrap();
    let mut models = vec![AnyModel::new(&mesh, None, PenaltyMass::Consistent).unwrap()];
    for (name, elements, mass) in [("signorini", 8, MassMatrix::LUMPED), ("hunek", 5, MassMatrix::CONSISTENT)]
    {
        models.push(AnyModel::Mesh(Box::new(as_matrices(&bars(name, elements, mass)))));
        models.push(AnyModel::Bars(bars(name, elements, mass)));
    }
    models
}

fn limits() -> [Asking; 2] {
    let of = |limit| Asking { limit, ..Asking::default() };
    [of(LimitOf::Spectrum), of(SchemeName::PredictorCorrector.into())]
}

/// A step to which the limit only tends, 1/beta_s = 2 (C^2 - 1/(4 r)) = 0: rounding decides near the end, and yet almost every
/// penalty is proven.
#[test]
fn a_step_that_the_limit_tends_to_stands_every_penalty_that_can_be_told_from_infinity() {
    let model = AnyModel::Bars(bars("hunek", 50, MassMatrix::LUMPED));
    let asking = Asking { limit: SchemeName::PredictorCorrector.into(), ..Asking::default() };
    let half = model.time_step(0.5).unwrap();
    let found = model.largest_penalty(half, 1.0, &asking).unwrap().unwrap();
    // Between the asymptote and the limit lies 1/(4 beta_s) of the step: some 1e-15 are lost to rounding.
    assert!(found.lower > 1e12 && found.lower <= found.value, "{found:?}");
    let step = model.critical_step(found.lower, 1.0, &asking).unwrap().step.unwrap();
    assert!(step.lower >= 0.5, "{step:?}");
}

/// What is given as within the limit is within it; what is given as beyond it is beyond.
#[test]
fn the_largest_penalty_and_ratio_are_where_the_step_is_the_limit() {
    for model in models() {
        for asking in limits().into_iter().chain(transformed::limits(&model).into_iter().skip(2).step_by(4)) {
            let free = model.contact_free(&asking).unwrap().step.unwrap();
            let seconds = |courant: f64| model.time_step(courant).unwrap();
            // Far below t = 0 rounding forbids the width of a few points.
            let wider = Asking { tolerance: Some(1e-6), ..asking.clone() };
            let of = |b: f64, r: f64| model.critical_step(b, r, &wider).unwrap().step.unwrap();
            assert_eq!(
                model.largest_penalty(seconds(free.critical_courant * 1.01), 1.0, &asking).unwrap(),
                None
            );
            for share in [0.9, 0.5, 0.1, 1e-3] {
                let courant = share * free.lower;
                for ratio in [1e-2, 0.5, 3.0, 1e4, f64::INFINITY] {
                    let found = model.largest_penalty(seconds(courant), ratio, &asking).unwrap().unwrap();
                    let place =
                        format!("{}, {}, {share}, r = {ratio}: {found:?}", model.name(), asking.limit.name());
                    if found.lower.is_infinite() {
                        assert!(of(1e6, ratio).lower >= courant * (1.0 - 2e-6), "{place}");
                        continue;
                    }
                    assert!(
                        found.lower > 0.0 && found.lower <= found.value && found.value <= found.upper,
                        "{place}"
                    );
                    assert!(of(found.lower, ratio).lower >= courant * (1.0 - 2e-6), "{place}");
                    if found.upper.is_finite() {
                        assert!(found.upper / found.lower - 1.0 < 1e-6, "{place}");
                        assert!(of(found.upper * 1.001, ratio).upper < courant, "{place}");
                    }
                    // The ratio is the inverse in the other direction.
                    let back = model.largest_ratio(seconds(courant), found.lower, &asking).unwrap().unwrap();
                    assert!(back.lower >= ratio.min(1e9) * (1.0 - 1e-5), "{place} {back:?}");
                }
            }
        }
    }
}

/// "Any penalty" is said where a theorem says so; of the Park scheme no more than the last penalty that was held.
#[test]
fn any_penalty_is_said_by_a_theorem_only() {
    let scene = AnyScene::load("signorini").unwrap().with_elements(4).unwrap();
    let model = AnyModel::new(&scene, None, PenaltyMass::Consistent).unwrap();
    let largest = |limit: LimitOf| {
        let asking = Asking { limit, ..Asking::default() };
        let free = model.contact_free(&asking).unwrap().step.unwrap();
        let half = model.time_step(0.5 * free.lower).unwrap();
        model.largest_penalty(half, 0.01, &asking).unwrap().unwrap()
    };
    assert!(largest(LimitOf::Spectrum).lower.is_infinite());
    assert!(largest(SchemeName::PredictorCorrector.into()).lower.is_infinite());
    let park = largest(SchemeName::Park.into());
    assert!(park.lower > 1e6 && park.lower.is_finite() && park.value.is_infinite(), "{park:?}");
}

/// The spectrum: r* costs nothing, and a little more costs a step. The predictor-corrector: a quarter of it for large beta_s.
#[test]
fn the_optimal_ratio_is_where_a_step_begins_to_cost() {
    for model in models() {
        let [spectrum, corrector] = limits();
        let free = model.contact_free(&spectrum).unwrap().step.unwrap();
        for beta_s in [0.5, 1e3] {
            let best = model.optimal_ratio(beta_s, &spectrum).unwrap().unwrap();
            let expected = model.optimal_ratios(&[beta_s], &spectrum, &|_| ()).unwrap()[0].1.unwrap();
            let place = format!("{}, {beta_s}: {best:?}, expected {expected}", model.name());
            assert!(
                best.lower <= expected && best.lower <= best.value && best.value <= best.upper,
                "{place}"
            );
            let of = |r: f64| model.critical_step(beta_s, r, &spectrum).unwrap().step.unwrap();
            assert!(of(best.lower).upper >= free.lower * (1.0 - 1e-9), "{place}");
            assert!(of(best.upper * 1.001).lower < free.upper, "{place}");
        }
        let best = model.optimal_ratio(1e9, &corrector).unwrap().unwrap();
        let quarter = model.optimal_ratios(&[1e9], &spectrum, &|_| ()).unwrap()[0].1.unwrap() / 4.0;
        assert!((best.lower / quarter - 1.0).abs() < 1e-6, "{}: {best:?} {quarter}", model.name());
    }
}

/// Every point of a contour line has the step of the line.
#[test]
fn contour_lines_have_their_step() {
    for model in models() {
        for asking in limits().into_iter().chain(transformed::limits(&model).into_iter().skip(2).step_by(4)) {
            let free = model.contact_free(&asking).unwrap().step.unwrap();
            let level = 0.6 * free.critical_courant;
            let line = model.contour(level, (1e-2, 1e6), (0.1, 1e3), &asking).unwrap();
            let several = matches!(model, AnyModel::Bars(_)) && model.contacts() > 1;
            assert!(line.len() > 20 || several, "{}: {} points", model.name(), line.len());
            for (beta_s, ratio) in line.iter().step_by(29) {
                let step = model.critical_step(*beta_s, *ratio, &asking).unwrap().step.unwrap();
                assert!(
                    (step.critical_courant / level - 1.0).abs() < 1e-6,
                    "{}: {beta_s}, {ratio}",
                    model.name()
                );
            }
        }
    }
}
