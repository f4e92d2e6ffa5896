//! Facts of the penalised spectrum, on random scenes. Every comparison is between enclosures, or with the exact inertia
//! of the pencil as stored: a tolerance appears only where two pencils differ by the rounding of their entries.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Penalty;
use bipenalty::scene::{Bar, End, Scene, built_in};
use bipenalty::spectrum::{Enclosure, Engine as _, Sturm, UNIT_ROUNDOFF};
use bipenalty::stability::{CriticalStep, EngineName, Model};
use common::double_double::Dd;
use common::exact::count_above;
use common::scenes::{any_beta_s, any_mass, any_ratio, any_scene, bar, decades, model, one_contact, penalty};
use proptest::prelude::*;

/// l_max by the engine that users get, and by Sturm; the property is skipped where neither may be certified.
fn l_max(model: &Model, penalty: &Penalty) -> Result<Enclosure, TestCaseError> {
    let found = model.auto().enclose(penalty, None);
    found.map_err(|_| TestCaseError::reject("a penalty mass on every node: not certified"))
}

fn step(model: &Model, beta_s: f64, ratio: f64) -> Result<CriticalStep, TestCaseError> {
    Ok(model.critical_step(l_max(model, &penalty(model, beta_s, ratio))?))
}

/// Whether two enclosures, the second widened by `relative`, have a number in common.
fn agree(a: CriticalStep, b: CriticalStep, relative: f64) -> bool {
    a.lower <= b.upper * (1.0 + relative) && b.lower * (1.0 - relative) <= a.upper
}

/// How far C_r can move when every entry of the pencil moves by `roundings` unit roundoffs. Entries of K and M move
/// l by |x|'|K||x| <= B x'Mx and |x|'|M||x| <= 3 x'Mx (consistent mass; THEORY: B the element bound), the contact by C;
/// C_r goes with the square root.
fn entry_rounding(model: &Model, penalty: &Penalty, roundings: f64, l: f64) -> f64 {
    let pencil = model.pencil();
    let chain = pencil.chain().unwrap();
    let (b, c) = (pencil.bounds().stiffness, chain.contact_bound(&chain.terms(penalty)));
    0.5 * roundings * UNIT_ROUNDOFF * (3.0 + (b + c) / l)
}

fn scaled(scene: &Scene, factors: (f64, f64, f64, f64)) -> Scene {
    let scale = |b: &Bar| Bar {
        length: b.length * factors.0,
        youngs_modulus: b.youngs_modulus * factors.1,
        density: b.density * factors.2,
        area: b.area * factors.3,
        ..b.clone()
    };
    let bars = scene.bars().iter().map(scale).collect();
    Scene::new("scaled", scene.left(), bars, scene.right(), None).unwrap()
}

/// The largest element eigenvalue of all bars, rounded by no more than 4 units.
fn element_limit(model: &Model) -> f64 {
    model.scene().bars().iter().map(|bar| model.mass().element_eigenvalue(bar)).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(common::config(300))]

    #[test]
    fn scaling_of_units_leaves_the_critical_courant_number_alone(
        scene in any_scene(40), mass in any_mass(), beta_s in any_beta_s(), ratio in any_ratio(),
        length in decades(-9.0..9.0), modulus in decades(-9.0..9.0), density in decades(-9.0..9.0),
        area in decades(-9.0..9.0),
    ) {
        let before = model(&scene, mass);
        let after = model(&scaled(&scene, (length, modulus, density, area)), mass);
        let (a, b) = (step(&before, beta_s, ratio)?, step(&after, beta_s, ratio)?);
        // EA/h and rho A h take 3 roundings from the data, which took one each to scale: 6 an entry; s and m, made of
        // both, and (c0/h)^2 of the reference element twice that: 12 + 12 in each scene.
        let l = l_max(&before, &penalty(&before, beta_s, ratio))?.value;
        let allowed = entry_rounding(&before, &penalty(&before, beta_s, ratio), 48.0, l);
        prop_assert!(agree(a, b, allowed), "{:?} became {:?}", a, b);
    }

    #[test]
    fn a_ratio_of_one_never_costs_against_the_element_limit(
        scene in any_scene(40), mass in any_mass(), beta_s in any_beta_s(), diagonalised in any::<bool>(),
    ) {
        let form = if diagonalised { PenaltyMass::Diagonalised } else { PenaltyMass::Consistent };
        let model = Model::new(scene, mass, form);
        let (pencil, penalty) = (model.pencil(), penalty(&model, beta_s, 1.0));
        // m = s/omega_e^2, the entries and omega_e^2 itself are rounded 16 times together.
        let bound = element_limit(&model) * (1.0 + 16.0 * UNIT_ROUNDOFF);
        prop_assert_eq!(count_above(&pencil, &penalty, Dd::from(bound)), 0);
        let found = l_max(&model, &penalty)?;
        prop_assert!(found.lower <= bound, "{:?} lies above {:e}", found, bound);
        let (sturm, pure) = (Sturm::new(pencil.chain().unwrap()).enclose(&penalty, None), 0.5 * found.relative_width());
        prop_assert!(sturm.is_ok_and(|l| l.lower <= bound && l.value <= bound * (1.0 + l.relative_width())));
        prop_assert!(found.value <= bound * (1.0 + pure));
    }

    /// r < 1, one contact: l_{n-1} <= l_max <= l_n, the two largest contact-free eigenvalues.
    #[test]
    fn a_heavy_mass_penalty_interlaces(
        scene in one_contact(40), mass in any_mass(), beta_s in any_beta_s(), ratio in decades(-6.0..0.0),
    ) {
        let model = model(&scene, mass);
        let (pencil, loaded) = (model.pencil(), penalty(&model, beta_s, ratio));
        let found = l_max(&model, &loaded)?;
        let free = penalty(&model, 0.0, 1.0);
        // No more than one contact-free eigenvalue above the enclosure, at least one not below it. For the count at
        // `lower` an eigenvalue equal to it must not be missed by the judge's own 1e-28.
        prop_assert!(count_above(&pencil, &free, Dd::from(found.upper)) <= 1, "below l_n-1: {:?}", found);
        // r omega_e^2 <= l_n can fail for fixed ends, where l_n < omega_e^2: then only the mediant bound is left.
        let top = l_max(&model, &free)?;
        let p = loaded.terms(model.scales()[0]);
        let edge = p.stiffness / p.mass;
        let bound = if edge.is_nan() { top.upper } else { top.upper.max(edge * (1.0 + UNIT_ROUNDOFF)) };
        prop_assert!(found.lower <= bound, "{:?} lies above l_n = {:?}", found, top);
        if edge <= top.lower {
            let just_below = Dd::from(found.lower) * (Dd::from(1.0) - Dd::from(1e-25));
            prop_assert!(count_above(&pencil, &free, just_below) >= 1, "above l_n: {:?}", found);
        }
    }

    /// r > 1, one contact: the Rayleigh quotient rises with beta_s, because l_max <= max(l_n, s/m) <= s/m.
    #[test]
    fn the_step_falls_with_the_stiffness_penalty_above_one(
        scene in one_contact(40), mass in any_mass(), ratio in prop_oneof![1.0..2.0, decades(0.0..12.0), Just(f64::INFINITY)],
        around in any_beta_s(), factors in prop::collection::vec(0.25..4.0, 2..12),
    ) {
        // Close together, where a step the wrong way would show.
        let mut betas: Vec<f64> = factors.iter().map(|factor| factor * around).collect();
        betas.sort_by(f64::total_cmp);
        let model = model(&scene, mass);
        let steps: Vec<CriticalStep> = betas.iter().map(|b| step(&model, *b, ratio)).collect::<Result<_, _>>()?;
        for pair in steps.windows(2) {
            prop_assert!(pair[1].lower <= pair[0].upper, "{:?} rises to {:?}", pair[0], pair[1]);
        }
    }

    #[test]
    fn the_order_of_the_bars_does_not_matter(
        scene in any_scene(40), mass in any_mass(), beta_s in any_beta_s(), ratio in any_ratio(),
        diagonalised in any::<bool>(),
    ) {
        let form = if diagonalised { PenaltyMass::Diagonalised } else { PenaltyMass::Consistent };
        let there = Model::new(scene.clone(), mass, form);
        let back = Model::new(scene.mirrored(), mass, form);
        let (a, b) = (step(&there, beta_s, ratio)?, step(&back, beta_s, ratio)?);
        // The entries are the same numbers; only bars that tie for the reference element may differ, by the 4
        // roundings of (c0/h)^2.
        prop_assert!(agree(a, b, 4.0 * UNIT_ROUNDOFF), "{:?} mirrored {:?}", a, b);
    }

    /// m at r = 1e200 is 1e-200 of what a double can feel.
    #[test]
    fn pure_penalty_is_the_limit_of_large_ratios(
        scene in any_scene(40), mass in any_mass(), beta_s in any_beta_s(),
    ) {
        let model = model(&scene, mass);
        let (a, b) = (step(&model, beta_s, 1e200)?, step(&model, beta_s, f64::INFINITY)?);
        prop_assert!(agree(a, b, 0.0), "{:?} against {:?}", a, b);
        // On the way there the step only falls, with one contact.
        if model.scales().len() == 1 {
            let before = step(&model, beta_s, 1e8)?;
            prop_assert!(b.lower <= before.upper, "{:?} below {:?}", before, b);
        }
    }

    /// 2m I - m z z' = m [1 1; 1 1] >= 0 for a pair: more mass, never a smaller step. A wall has one form only.
    #[test]
    fn the_diagonalised_mass_penalty_never_costs_against_the_consistent_one(
        scene in any_scene(40), mass in any_mass(), beta_s in any_beta_s(), ratio in any_ratio(),
    ) {
        let consistent = step(&model(&scene, mass), beta_s, ratio)?;
        let diagonalised = step(&Model::new(scene, mass, PenaltyMass::Diagonalised), beta_s, ratio)?;
        prop_assert!(consistent.lower <= diagonalised.upper, "{:?} against {:?}", consistent, diagonalised);
    }
}

/// r = 1 is neutral for the built-in scenes: l_max is the element eigenvalue, with and without contact, to the 4
/// roundings of the entries that make it.
#[test]
fn a_ratio_of_one_is_neutral_for_the_built_in_scenes() {
    for name in ["signorini", "symmetric", "hunek"] {
        for elements in [1, 2, 7, 100, 1000] {
            let scene = built_in(name).unwrap().unwrap().with_elements(elements).unwrap();
            for gamma in [0.0, 0.3, 0.5, 1.0] {
                let model = model(&scene, MassMatrix::new(gamma).unwrap());
                let (pencil, element) = (model.pencil(), element_limit(&model));
                for beta_s in [0.0, 1e-3, 0.5, 1.0, 10.0, 1e4, 1e12, 1e16] {
                    let penalty = penalty(&model, beta_s, 1.0);
                    let what = format!("{name}, {elements} elements, gamma {gamma}, beta_s {beta_s:e}");
                    let (low, high) = (1.0 - 16.0 * UNIT_ROUNDOFF, 1.0 + 16.0 * UNIT_ROUNDOFF);
                    assert!(count_above(&pencil, &penalty, Dd::from(element * low)) > 0, "{what}");
                    assert_eq!(count_above(&pencil, &penalty, Dd::from(element * high)), 0, "{what}");
                    for engine in [EngineName::ClosedForm, EngineName::Secular, EngineName::Sturm] {
                        let found = model.engine(engine, &pencil).unwrap().enclose(&penalty, None).unwrap();
                        let holds = found.lower <= element * high && element * low <= found.upper;
                        assert!(holds, "{what}: {engine:?} {found:?} does not hold {element:e}");
                    }
                }
            }
        }
    }
}

/// The same C_r whatever stands beside a contact that never feels it: a second body without a contact of its own.
#[test]
fn a_scene_without_contact_ignores_the_penalties() {
    let bars = vec![bar(3.0, 3, 2.0, 1.0, 1.0)];
    let scene = Scene::new("free", End::Fixed, bars, End::Free, None).unwrap();
    let model = model(&scene, MassMatrix::AVERAGED);
    let steps: Vec<CriticalStep> = [(0.0, 1.0), (10.0, 0.1), (1e16, f64::INFINITY)]
        .map(|(beta_s, ratio)| step(&model, beta_s, ratio).unwrap())
        .to_vec();
    assert!(steps.iter().all(|other| *other == steps[0]), "{steps:?}");
}

/// The closed form's own value, which maps are drawn from, against bisection on the pivots of the pencil as stored:
/// both sides of every switch between its formulas, from 1 element to where the bar is long (beyond, only v_1 shrinks).
#[test]
fn the_uncertified_value_is_exact_to_rounding() {
    for elements in (1..=12).chain([20, 95, 96, 100, 400]) {
        for mass in [0.0, 0.3, 0.5, 1.0].map(|gamma| MassMatrix::new(gamma).unwrap()) {
            let scene = Scene::new(
                "wall",
                End::Free,
                vec![bar(elements as f64, elements, 1.0, 1.0, 1.0)],
                End::Wall,
                None,
            )
            .unwrap();
            let model = Model::new(scene, mass, PenaltyMass::Consistent);
            let pencil = model.pencil();
            let (engine, sturm) = (model.closed_form(), Sturm::new(pencil.chain().unwrap()));
            for beta_s in [1e-9, 1e-3, 0.1, 1.0, 3.0, 10.0, 1e3, 1e12] {
                for ratio in [1e-3, 0.1, 0.5, 0.8, 0.97, 0.999, 1.0, 1.001, 1.5, 10.0, 1e6] {
                    let penalty = penalty(&model, beta_s, ratio);
                    let exact = sturm.enclose(&penalty, None).unwrap();
                    let value = engine.unproven(&penalty);
                    // The accuracy promised of every reference row; the pencil is stored with 4 roundings an entry.
                    let allowed = 4e-15 * value + entry_rounding(&model, &penalty, 4.0, value) * 2.0 * value;
                    let miss = (exact.lower - value).max(value - exact.upper);
                    assert!(
                        miss <= allowed,
                        "n = {elements}, {mass:?}, beta_s {beta_s}, r {ratio}: {miss:e}"
                    );
                }
            }
        }
    }
}
