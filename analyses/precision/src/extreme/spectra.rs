//! Critical steps at the ends of every input, by every engine that can hold the scene.
//!
//! The allowed error of C_r, half that of l_max, has two parts: the backward error of the engine, and the rounding of the
//! data. EA/h, rho h A, s and m take at most 16 roundings together, each of which moves l_max by at most u (B + C) or u l
//! (B the bound of the stiffness, C that of the contacts, both relative to M + M_p).

use super::case::{Case, Found};
use super::short;
use bipenalty::fem::{MassMatrix, assemble_shortened};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::spectrum::{UNIT_ROUNDOFF, WIDEST_ENCLOSURE};
use bipenalty::stability::{EngineName, Model};

const EVERY_ENGINE: &[EngineName] =
    &[EngineName::ClosedForm, EngineName::Secular, EngineName::Sturm, EngineName::Dense];
/// The dense engine would need 16 TB for 1e6 elements.
const SPARSE_ENGINES: &[EngineName] = &[EngineName::ClosedForm, EngineName::Sturm];
const RATIOS: [f64; 3] = [1.0, 2.0, f64::INFINITY];
const RATIOS_AND_HALF: [f64; 4] = [0.5, 1.0, 2.0, f64::INFINITY];
const FACTORS: [f64; 2] = [1e12, 1e-12];
const MILLION: usize = 1_000_000;

/// What is asked of a spectrum, with its name in records.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Quantity {
    /// C_r, dimensionless.
    CriticalCourant,
    /// omega_max, rad/s.
    OmegaMax,
    /// dt_cr, s.
    CriticalStep,
}

impl Quantity {
    fn name(self) -> &'static str {
        match self {
            Self::CriticalCourant => "critical Courant number",
            Self::OmegaMax => "omega_max",
            Self::CriticalStep => "critical time step",
        }
    }
}

/// One point of one scene.
#[derive(Debug, Clone)]
struct Problem {
    name: String,
    bars: Vec<Bar>,
    ends: (End, End),
    gamma: f64,
    beta_s: f64,
    ratio: f64,
    quantity: Quantity,
    engines: &'static [EngineName],
}

/// The extreme critical steps.
pub(super) fn cases() -> Vec<Case> {
    let lists = [penalties(), gammas(), elements(), contrasts(), ends_of_the_range(), near_ties(), units()];
    lists.into_iter().flatten().flat_map(|point| point.cases()).collect()
}

/// One bar with its right end on a wall, beta_s = 10.
fn on_wall(name: String, bar: Bar, gamma: f64, ratio: f64) -> Problem {
    Problem {
        name,
        bars: vec![bar],
        ends: (End::Free, End::Wall),
        gamma,
        beta_s: 10.0,
        ratio,
        quantity: Quantity::CriticalCourant,
        engines: EVERY_ENGINE,
    }
}

/// Two bars with free outer ends, beta_s = 10.
fn pair(name: String, bars: [Bar; 2], gamma: f64, ratio: f64) -> Problem {
    let [first, second] = bars;
    let alone = on_wall(name, first.clone(), gamma, ratio);
    Problem { bars: vec![first, second], ends: (End::Free, End::Free), ..alone }
}

fn penalties() -> Vec<Problem> {
    let mut points = Vec::new();
    for beta_s in [1e-300, 1e-12, 1e12, 1e16, 1e300] {
        for r in RATIOS {
            let name = format!("beta-s-{}-r-{}", short(beta_s), short(r));
            points.push(Problem { beta_s, ..on_wall(name, Bar::unit(3), 0.5, r) });
        }
    }
    for r in [1e-12, 0.999_999_999_999_999, 1.000_000_000_000_001, 1e12, f64::INFINITY] {
        for beta_s in [1.0, 1e8] {
            let name = format!("ratio-{}-beta-s-{}", short(r), short(beta_s));
            points.push(Problem { beta_s, ..on_wall(name, Bar::unit(3), 1.0, r) });
        }
    }
    points
}

fn gammas() -> Vec<Problem> {
    let point = |gamma: f64, r: f64| {
        on_wall(format!("gamma-{}-r-{}", short(gamma), short(r)), Bar::unit(3), gamma, r)
    };
    [0.0, 1e-16, 1.0].into_iter().flat_map(|gamma| RATIOS.map(|r| point(gamma, r))).collect()
}

/// One, two and 1e6 elements. The top of the spectrum of 1e6 elements is clustered: neighbours are 1e-12 apart.
fn elements() -> Vec<Problem> {
    let mut points = Vec::new();
    for n in [1, 2, MILLION] {
        let engines = if n == MILLION { SPARSE_ENGINES } else { EVERY_ENGINE };
        for r in RATIOS_AND_HALF {
            for (end, text) in [(End::Free, "free"), (End::Fixed, "fixed")] {
                let bar = on_wall(format!("elements-{n}-{text}-r-{}", short(r)), Bar::unit(n), 0.0, r);
                points.push(Problem { ends: (end, End::Wall), engines, ..bar });
            }
            let bars =
                pair(format!("pair-elements-{n}-r-{}", short(r)), [Bar::unit(n), Bar::unit(n)], 0.0, r);
            points.push(Problem { engines, ..bars });
        }
    }
    points
}

fn contrasts() -> Vec<Problem> {
    let mut points = Vec::new();
    for factor in FACTORS {
        let contrasting = [
            ("size", Bar { length: 3.0 * factor, ..Bar::unit(3) }),
            ("density", Bar { density: factor, ..Bar::unit(3) }),
            ("area", Bar { area: factor, ..Bar::unit(3) }),
        ];
        for (what, bar) in contrasting {
            let name = |r: f64| format!("{what}-contrast-{}-r-{}", short(factor), short(r));
            points.extend(RATIOS.map(|r| pair(name(r), [Bar::unit(2), bar.clone()], 0.0, r)));
        }
    }
    points
}

/// Moduli and densities whose elements are next to what is refused, and bars next to nothing in mass.
fn ends_of_the_range() -> Vec<Problem> {
    let data = [
        ("stiff-and-light", 1e145, 1e-145),
        ("soft-and-heavy", 1e-144, 1e145),
        ("largest-stiffness-and-mass", 1e289, 1e289),
        ("smallest-stiffness-and-mass", 1e-289, 1e-289),
    ];
    let mut points = Vec::new();
    for (what, youngs_modulus, density) in data {
        let bar = Bar { youngs_modulus, density, ..Bar::unit(3) };
        points.extend(RATIOS.map(|r| Problem {
            quantity: Quantity::OmegaMax,
            ..on_wall(format!("{what}-r-{}", short(r)), bar.clone(), 1.0, r)
        }));
    }
    for r in RATIOS_AND_HALF {
        let massless = Bar { density: 1e-200, ..Bar::unit(1) };
        let weightless = Bar { youngs_modulus: 1e-200, ..massless.clone() };
        for (what, bar) in [("massless-contact-node", massless), ("weightless-bar", weightless)] {
            points.push(pair(format!("{what}-r-{}", short(r)), [Bar::unit(3), bar], 1.0, r));
        }
    }
    points
}

/// Bars whose frequencies are equal to the last bit, and top modes that do not move the gap.
fn near_ties() -> Vec<Problem> {
    let mut points = Vec::new();
    let next = 1.0 + f64::EPSILON;
    for r in RATIOS_AND_HALF {
        let stiffer = Bar { youngs_modulus: next, ..Bar::unit(3) };
        let heavier = Bar { density: next, ..Bar::unit(3) };
        for (what, bar) in [("modulus", stiffer), ("density", heavier)] {
            points.push(pair(format!("{what}-one-bit-off-r-{}", short(r)), [Bar::unit(3), bar], 0.0, r));
        }
    }
    for r in [1e-12, 0.5] {
        for beta_s in [10.0, 1e16] {
            let name = format!("top-mode-orthogonal-r-{}-beta-s-{}", short(r), short(beta_s));
            points.push(Problem { beta_s, ..pair(name, [Bar::unit(4), Bar::unit(4)], 0.0, r) });
        }
    }
    points
}

/// A steel striker on an aluminium rod in m, kg, s and in mm, tonne, s: the critical time step is one and the same.
fn units() -> Vec<Problem> {
    let bar = |elements, length, youngs_modulus, density, area| Bar {
        length,
        elements,
        youngs_modulus,
        density,
        area,
        velocity: 0.0,
    };
    let si = [bar(80, 0.2, 210e9, 7850.0, 4e-4), bar(300, 1.0, 70e9, 2700.0, 3e-4)];
    let mm = [bar(80, 200.0, 210e3, 7.85e-9, 400.0), bar(300, 1000.0, 70e3, 2.7e-9, 300.0)];
    let mut points = Vec::new();
    for (what, bars) in [("units-si", si), ("units-mm-tonne-s", mm)] {
        for r in [1.0, f64::INFINITY] {
            let point = pair(format!("{what}-r-{}", short(r)), bars.clone(), 1.0, r);
            points.push(Problem { quantity: Quantity::CriticalStep, ..point });
        }
    }
    points
}

impl Problem {
    /// One case an engine.
    fn cases(self) -> Vec<Case> {
        let case = |engine: &EngineName| {
            let (point, engine) = (self.clone(), *engine);
            Case {
                name: self.name.clone(),
                quantity: self.quantity.name(),
                by: engine.text(),
                formula: allowed_formula(engine),
                refusal: None,
                compute: Box::new(move || point.compute(engine)),
            }
        };
        self.engines.iter().map(case).collect()
    }

    fn compute(&self, engine: EngineName) -> Result<Found, String> {
        let scene = Scene::new("extreme", self.ends.0, self.bars.clone(), self.ends.1, None).map_err(text)?;
        let mass = MassMatrix::new(self.gamma).map_err(text)?;
        let beta_s = StiffnessPenalty::new(self.beta_s).map_err(text)?;
        let ratio = Ratio::new(self.ratio).map_err(text)?;
        let model = Model::new(scene, mass, PenaltyMass::Consistent);
        model.check(beta_s, ratio).map_err(text)?;
        let (penalty, pencil) = (model.penalty(beta_s, ratio), model.pencil());
        let l = model.engine(engine, &pencil).map_err(text)?.enclose(&penalty, None).map_err(text)?;
        let short_pencil = assemble_shortened(model.scene(), mass);
        let bars = short_pencil.chain().ok_or("bars are a chain")?;
        let bounds = bars.stiffness_bound(&bars.terms(&penalty)) + bars.contact_bound(&bars.terms(&penalty));
        let step = model.critical_step(l);
        let courant = (step.critical_courant, (step.lower, step.upper));
        let (value, enclosure) = match self.quantity {
            Quantity::CriticalCourant => courant,
            Quantity::OmegaMax => (step.omega_max, (l.lower.sqrt(), l.upper.sqrt())),
            Quantity::CriticalStep => (
                model.time_step(step.critical_courant),
                (model.time_step(step.lower), model.time_step(step.upper)),
            ),
        };
        Ok(Found { value, allowed: allowed(engine, 1.0 + bounds / l.value), enclosure: Some(enclosure) })
    }
}

/// The backward error of the engine (8 or 28 roundings; 3.2 times 8 and 64 for the compressed function; an enclosure
/// for the dense reduction) and 16 roundings of the data, all halved by the square root.
fn allowed(engine: EngineName, amplification: f64) -> f64 {
    match engine {
        EngineName::Secular => 64.0 * UNIT_ROUNDOFF * amplification,
        EngineName::Dense => 24.0 * UNIT_ROUNDOFF * amplification + 0.5 * WIDEST_ENCLOSURE,
        _ => 24.0 * UNIT_ROUNDOFF * amplification,
    }
}

fn allowed_formula(engine: EngineName) -> &'static str {
    match engine {
        EngineName::Secular => "64 u (1 + (B + C)/l)",
        EngineName::Dense => "24 u (1 + (B + C)/l) + 1e-13",
        _ => "24 u (1 + (B + C)/l)",
    }
}

fn text(error: impl ToString) -> String {
    error.to_string()
}
