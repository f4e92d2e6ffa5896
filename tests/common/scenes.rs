//! Random scenes: one to four bars whose data differ by up to twelve decades.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Penalty;
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::stability::Model;
use proptest::prelude::*;

/// A bar at rest.
pub fn bar(length: f64, elements: usize, youngs_modulus: f64, density: f64, area: f64) -> Bar {
    Bar { length, elements, youngs_modulus, density, area, velocity: 0.0 }
}

/// 10^x for x uniform in the range.
pub fn decades(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    range.prop_map(|x| 10f64.powf(x))
}

fn any_bar(elements: std::ops::Range<usize>) -> impl Strategy<Value = Bar> {
    // Element size, modulus, density and area: 12 decades each in half of the bars, one in the other half.
    let wide = || prop_oneof![decades(-0.5..0.5), decades(-6.0..6.0)];
    (elements, wide(), wide(), wide(), wide()).prop_map(|(n, h, e, rho, a)| bar(h * n as f64, n, e, rho, a))
}

pub fn any_end() -> impl Strategy<Value = End> {
    prop_oneof![Just(End::Free), Just(End::Fixed), Just(End::Wall)]
}

fn scene_of(bars: Vec<Bar>, left: End, right: End) -> Option<Scene> {
    Scene::new("random", left, bars, right, None).ok()
}

/// Scenes of 1 to 4 bars of fewer than `elements` elements each, with any number of contacts.
pub fn any_scene(elements: usize) -> impl Strategy<Value = Scene> {
    let bars = prop::collection::vec(any_bar(1..elements), 1..5);
    (bars, any_end(), any_end())
        .prop_filter_map("one element between two fixed ends", |(bars, left, right)| {
            scene_of(bars, left, right)
        })
}

/// Scenes with exactly one contact: a bar on a wall, or two bars.
pub fn one_contact(elements: usize) -> impl Strategy<Value = Scene> {
    let held = || prop_oneof![Just(End::Free), Just(End::Fixed)];
    let on_wall =
        (any_bar(1..elements), held(), any::<bool>()).prop_filter_map("nothing", |(bar, far, flip)| {
            let scene = scene_of(vec![bar], far, End::Wall)?;
            Some(if flip { scene.mirrored() } else { scene })
        });
    let two = (prop::collection::vec(any_bar(1..elements), 2..3), held(), held())
        .prop_filter_map("nothing", |(bars, left, right)| scene_of(bars, left, right));
    prop_oneof![on_wall, two]
}

/// The three named mass matrices and any gamma.
pub fn any_mass() -> impl Strategy<Value = MassMatrix> {
    prop_oneof![Just(0.0), Just(0.5), Just(1.0), 0.0..1.0].prop_map(|gamma| MassMatrix::new(gamma).unwrap())
}

/// r from 1e-6 to 1e12, 1 and infinity among them.
pub fn any_ratio() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(1.0), 1 => Just(f64::INFINITY), 2 => 0.5..2.0, 5 => decades(-6.0..12.0)]
}

/// beta_s from 1e-6 to 1e16, and 0.
pub fn any_beta_s() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 9 => decades(-6.0..16.0)]
}

/// The model with the consistent mass penalty.
pub fn model(scene: &Scene, mass: MassMatrix) -> Model {
    Model::new(scene.clone(), mass, PenaltyMass::Consistent)
}

/// The penalty of `model` for plain numbers.
pub fn penalty(model: &Model, beta_s: f64, ratio: f64) -> Penalty {
    model.penalty(StiffnessPenalty::new(beta_s).unwrap(), Ratio::new(ratio).unwrap())
}
