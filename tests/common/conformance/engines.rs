//! What every engine of a row of bars must do: the same scenes and penalties, the same demands. An engine joins by one
//! line of [`engine_conformance`](crate::engine_conformance).
//!
//! The judge is bisection on the sign of the pivots, whose enclosure is proven. An engine's value must lie in it,
//! widened by the accuracy the engine states, and the two enclosures must meet.

use bipenalty::error::Refusal;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Pencil;
use bipenalty::scene::{BUILT_IN, Bar, End, Scene, built_in};
use bipenalty::spectrum::{Enclosure, Engine, Sturm};
use bipenalty::stability::Model;

use super::as_mesh;

/// Makes the engine for a model and its pencil.
pub type Maker<'m> = &'m dyn for<'a> Fn(&Model, &'a Pencil) -> Result<Box<dyn Engine + 'a>, Refusal>;

/// What the engine is asked on.
#[derive(Clone, Copy, PartialEq)]
pub enum On {
    /// Rows of bars.
    Bars,
    /// The same matrices without their structure, the unknowns in another order.
    Meshes,
}

const GAMMAS: [f64; 5] = [0.0, 1e-16, 0.3, 0.5, 1.0];
const ELEMENTS: [usize; 4] = [1, 2, 3, 57];
const STIFFNESS_PENALTIES: [f64; 8] = [0.0, 1e-8, 1e-3, 0.7, 2.0, 1e4, 1e10, 1e16];
const RATIOS: [f64; 11] =
    [1e-6, 1e-2, 0.5, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 1.5, 3.0, 1e3, 1e12, f64::INFINITY];
const FORMS: [PenaltyMass; 2] = [PenaltyMass::Consistent, PenaltyMass::Diagonalised];

/// A model and the pairs (beta_s, r) to solve it for.
pub struct Case {
    model: Model,
    penalties: Vec<(f64, f64)>,
}

/// Every beta_s with every r.
fn all_penalties() -> Vec<(f64, f64)> {
    let over_ratios = |b: &f64| RATIOS.map(|r| (*b, r));
    STIFFNESS_PENALTIES.iter().flat_map(over_ratios).collect()
}

fn models(scene: &Scene) -> impl Iterator<Item = Model> {
    let masses = GAMMAS.into_iter().flat_map(|gamma| FORMS.map(|form| (gamma, form)));
    masses.map(|(gamma, form)| Model::new(scene.clone(), MassMatrix::new(gamma).unwrap(), form))
}

pub fn reference_scenes_over_the_penalties() -> Vec<Case> {
    let scenes = BUILT_IN.iter().map(|(name, _)| built_in(name).unwrap().unwrap());
    let sized = scenes.flat_map(|scene| [1, 2, 3, 20].map(|n| scene.with_elements(n).unwrap()));
    sized
        .flat_map(|scene| models(&scene).collect::<Vec<_>>())
        .map(|model| Case { model, penalties: all_penalties() })
        .collect()
}

/// Free, fixed and wall at either end of one to four bars; fewer penalties, thinned in turn.
pub fn every_pair_of_ends() -> Vec<Case> {
    let ends = [End::Free, End::Fixed, End::Wall];
    let mut random = Random(17);
    let mut cases = Vec::new();
    for (left, right) in ends.into_iter().flat_map(|left| ends.map(|right| (left, right))) {
        for bars in 1..=4 {
            for elements in ELEMENTS {
                let row =
                    (0..bars).map(|i| Bar::unit(if i % 2 == 0 { elements } else { elements.div_ceil(2) }));
                // A single element between fixed ends has no node to move.
                let Ok(scene) = Scene::new("row", left, row.collect(), right, None) else { continue };
                let gamma = GAMMAS[random.below(GAMMAS.len())];
                let form = FORMS[random.below(FORMS.len())];
                let model = Model::new(scene, MassMatrix::new(gamma).unwrap(), form);
                let penalties = all_penalties().into_iter().filter(|_| random.below(8) == 0).collect();
                cases.push(Case { model, penalties });
            }
        }
    }
    cases
}

/// One to four bars that differ by up to twelve decades in area, density, element size and modulus each.
pub fn random_bars() -> Vec<Case> {
    let mut random = Random(42);
    let mut cases = Vec::new();
    while cases.len() < 400 {
        let decades = [0.3, 3.0, 12.0][random.below(3)];
        let bars = (0..1 + random.below(4)).map(|_| random.bar(decades)).collect();
        let ends = [End::Free, End::Fixed, End::Wall];
        let (left, right) = (ends[random.below(3)], ends[random.below(3)]);
        let Ok(scene) = Scene::new("random", left, bars, right, None) else { continue };
        let gamma = GAMMAS[random.below(GAMMAS.len())];
        let model = Model::new(scene, MassMatrix::new(gamma).unwrap(), FORMS[random.below(2)]);
        let penalties = (0..12).map(|_| random.penalties()).collect();
        cases.push(Case { model, penalties });
    }
    cases
}

/// splitmix64: the same numbers on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A factor within `decades` of 1 at most, half of them below 1.
    fn factor(&mut self, decades: f64) -> f64 {
        10f64.powf(decades * (self.unit() - 0.5))
    }

    fn bar(&mut self, decades: f64) -> Bar {
        let elements = [1, 2, 3, 7, 19][self.below(5)];
        Bar {
            length: elements as f64 * self.factor(decades),
            elements,
            youngs_modulus: self.factor(decades),
            density: self.factor(decades),
            area: self.factor(decades),
            velocity: 0.0,
        }
    }

    fn penalties(&mut self) -> (f64, f64) {
        let beta_s = match self.below(4) {
            0 => STIFFNESS_PENALTIES[self.below(STIFFNESS_PENALTIES.len())],
            _ => 10f64.powf(24.0 * self.unit() - 8.0),
        };
        let ratio = match self.below(2) {
            0 => RATIOS[self.below(RATIOS.len())],
            _ => 10f64.powf(18.0 * self.unit() - 6.0),
        };
        (beta_s, ratio)
    }
}

/// Small scenes and penalties without extremes, for engines that know no structure.
pub fn moderate_bars() -> Vec<Case> {
    let mut random = Random(7);
    let mut cases = Vec::new();
    while cases.len() < 120 {
        let bars = (0..1 + random.below(3)).map(|_| random.bar(0.6)).collect();
        let ends = [End::Free, End::Fixed, End::Wall];
        let Ok(scene) = Scene::new("random", ends[random.below(3)], bars, ends[random.below(3)], None) else {
            continue;
        };
        let model =
            Model::new(scene, MassMatrix::new(GAMMAS[random.below(5)]).unwrap(), FORMS[random.below(2)]);
        let any = |random: &mut Random| {
            (10f64.powf(6.0 * random.unit() - 2.0), 10f64.powf(4.0 * random.unit() - 2.0))
        };
        cases.push(Case { model, penalties: (0..10).map(|_| any(&mut random)).collect() });
    }
    cases
}

/// Solves every case and reports all that fail.
pub fn check(name: &str, engine: Maker<'_>, on: On, accuracy: f64, cases: Vec<Case>) {
    let (mut failures, mut points, mut worst) = (Vec::new(), 0, 0.0);
    for Case { model, penalties } in &cases {
        let pencil = model.pencil();
        let mesh = if on == On::Meshes { as_mesh(&pencil) } else { pencil.clone() };
        let engine = engine(model, &mesh).unwrap();
        let judge = Sturm::new(pencil.chain().unwrap());
        for (beta_s, ratio) in penalties {
            let (b, r) = (StiffnessPenalty::new(*beta_s).unwrap(), Ratio::new(*ratio).unwrap());
            if model.check(b, r).is_err() {
                continue;
            }
            points += 1;
            let penalties = model.penalty(b, r);
            let found = engine.enclose(&penalties, None).map_err(|e| format!("not certified: {e}"));
            let exact = judge.enclose(&penalties, None).map_err(|e| format!("no verdict: {e}"));
            let error = exact.and_then(|exact| misses(found?, exact, accuracy));
            match error {
                Ok(error) => worst = f64::max(worst, error),
                Err(why) => failures.push(format!("{} {why}", describe(model, *beta_s, *ratio))),
            }
        }
    }
    println!("{}: {points} points, worst distance from the judge {worst:e}", name);
    assert!(points > 1000, "only {points} points were solved");
    let shown = failures.iter().take(12).cloned().collect::<Vec<_>>().join("\n");
    assert!(failures.is_empty(), "{}: {} of {points} points fail\n{shown}", name, failures.len());
}

/// The distance of the values, or why the answer is wrong.
fn misses(found: Enclosure, exact: Enclosure, accuracy: f64) -> Result<f64, String> {
    let margin = accuracy * exact.value;
    let error = (found.value / exact.value - 1.0).abs();
    let inside = exact.lower - margin <= found.value && found.value <= exact.upper + margin;
    let meet = found.lower <= exact.upper && exact.lower <= found.upper;
    if inside && meet && error <= accuracy {
        Ok(error)
    } else {
        Err(format!("error {error:e}, found {found:?}, judge {exact:?}"))
    }
}

/// Everything needed to repeat the point.
fn describe(model: &Model, beta_s: f64, ratio: f64) -> String {
    let scene = model.scene();
    let bar = |b: &Bar| {
        let (h, e, rho, a) = (b.element_length(), b.youngs_modulus, b.density, b.area);
        format!("{}x(h {h:e} E {e:e} rho {rho:e} A {a:e})", b.elements)
    };
    let bars: Vec<String> = scene.bars().iter().map(bar).collect();
    format!(
        "{:?} {} {:?}, gamma {:e} {:?}, beta_s {beta_s:e} r {ratio:e}:",
        scene.left(),
        bars.join(" | "),
        scene.right(),
        model.mass().gamma(),
        model.form(),
    )
}
