//! Inputs that f64 cannot hold, or that have no meaning: each must be refused by a message that names the quantity.

use super::case::{Case, Found};
use super::stepping::run;
use bipenalty::error::Refusal;
use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Recording, Run};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::{Bar, End, MAX_ELEMENTS, Scene};
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

/// The inputs that must be refused.
pub(super) fn cases() -> Vec<Case> {
    let mut cases = penalties();
    cases.extend(materials());
    cases.extend(runs());
    cases
}

/// A case that holds when `attempt` is refused by a message with the words `names`; a value that comes out instead is
/// reported.
fn refused(
    name: impl Into<String>,
    names: &'static str,
    attempt: impl Fn() -> Result<f64, String> + Send + Sync + 'static,
) -> Case {
    Case {
        name: name.into(),
        quantity: "refusal",
        by: "",
        formula: "",
        refusal: Some(names),
        compute: Box::new(move || attempt().map(|value| Found { value, allowed: 0.0, enclosure: None })),
    }
}

const UNIT: Bar = Bar::unit(3);

/// C_r of `bar` on a wall.
fn courant(bar: &Bar, gamma: f64, beta_s: f64, ratio: f64) -> Result<f64, Refusal> {
    let scene = Scene::new("refused", End::Free, vec![bar.clone()], End::Wall, None)?;
    let model = Model::new(scene, MassMatrix::new(gamma)?, PenaltyMass::Consistent);
    let (beta_s, ratio) = (StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?);
    model.check(beta_s, ratio)?;
    Ok(model.critical_courant(model.closed_form().unproven(&model.penalty(beta_s, ratio))))
}

fn penalties() -> Vec<Case> {
    let stiff = Bar { youngs_modulus: 1e20, ..UNIT };
    let soft = Bar { youngs_modulus: 1e-20, ..UNIT };
    let cases = [
        ("stiffness-penalty-overflows", "penalty stiffness s", stiff.clone(), 1.0, 1e300, 1.0),
        ("stiffness-penalty-underflows", "penalty stiffness s", soft, 1.0, 1e-300, 1.0),
        ("mass-penalty-overflows", "penalty mass m", UNIT, 1.0, 1e300, 1e-12),
        ("mass-penalty-underflows", "penalty mass m", UNIT, 1.0, 1e-300, 1e12),
        ("frequency-overflows", "beta_s omega_e^2", Bar { area: 1e-20, ..stiff }, 1.0, 1e300, f64::INFINITY),
        ("beta-s-inf", "beta_s", UNIT, 1.0, f64::INFINITY, 1.0),
        ("beta-s-nan", "beta_s", UNIT, 1.0, f64::NAN, 1.0),
        ("beta-s-negative", "beta_s", UNIT, 1.0, -1e-300, 1.0),
        ("ratio-zero", "r: ", UNIT, 1.0, 1.0, 0.0),
        ("ratio-nan", "r: ", UNIT, 1.0, 1.0, f64::NAN),
        ("gamma-negative", "gamma", UNIT, -1e-16, 1.0, 1.0),
        ("gamma-above-1", "gamma", UNIT, 1.0 + f64::EPSILON, 1.0, 1.0),
    ];
    let case = |(name, names, bar, gamma, beta_s, ratio)| {
        refused(name, names, move || courant(&bar, gamma, beta_s, ratio).map_err(|r| r.to_string()))
    };
    cases.into_iter().map(case).collect()
}

fn materials() -> Vec<Case> {
    let bar = |length: f64, youngs_modulus: f64, density: f64, area: f64| Bar {
        length,
        youngs_modulus,
        density,
        area,
        ..UNIT
    };
    let cases = [
        ("element-stiffness-overflows", "element stiffness E A/h", bar(3.0, 1e300, 1.0, 1.0)),
        ("element-stiffness-underflows", "element stiffness E A/h", bar(3.0, 1e-300, 1.0, 1.0)),
        ("element-mass-overflows", "element mass rho A h", bar(3.0, 1.0, 1e300, 1.0)),
        ("element-mass-underflows", "element mass rho A h", bar(3.0, 1.0, 1e-300, 1.0)),
        ("squared-frequency-overflows", "squared frequency (c0/h)^2", bar(3.0, 1e150, 1e-150, 1.0)),
        ("squared-frequency-underflows", "squared frequency (c0/h)^2", bar(3.0, 1e-150, 1e150, 1.0)),
        ("stiffness-of-section-overflows", "section stiffness E A", bar(3e100, 1e200, 1e-200, 1e150)),
        // E A = 1e-320 has four digits left, E A/h = 1e-120 would have no more.
        ("stiffness-of-section-is-subnormal", "section stiffness E A", bar(3e-200, 1e-160, 1e200, 1e-160)),
        ("mass-of-section-is-subnormal", "section mass rho A", bar(3e200, 1e200, 1e-160, 1e-160)),
        ("element-length-is-subnormal", "element length h", bar(3e-310, 1e-150, 1e150, 1e100)),
        ("wave-speed-overflows", "squared wave speed E/rho", bar(3e120, 1e200, 1e-200, 1.0)),
        ("density-inf", "density", bar(3.0, 1.0, f64::INFINITY, 1.0)),
        ("length-nan", "length", bar(f64::NAN, 1.0, 1.0, 1.0)),
        ("area-zero", "area", bar(3.0, 1.0, 1.0, 0.0)),
        ("too-many-elements", "elements", Bar { elements: MAX_ELEMENTS + 1, ..UNIT }),
    ];
    let case = |(name, names, bar)| {
        refused(name, names, move || courant(&bar, 1.0, 1.0, 1.0).map_err(|r| r.to_string()))
    };
    cases.into_iter().map(case).collect()
}

fn runs() -> Vec<Case> {
    let shot = |velocity: f64| run(SchemeName::PredictorCorrector, 1.0, 1e4, 0.0, velocity);
    let with = move |change: fn(Run) -> Result<Run, Refusal>| {
        change(shot(0.1)?).map(|run| run.time_step()).map_err(|refusal| refusal.to_string())
    };
    vec![
        refused("kinetic-energy-overflows", "kinetic energy", move || shot(1e160).map(|run| run.time_step())),
        refused("velocity-inf", "velocity", move || shot(f64::INFINITY).map(|run| run.time_step())),
        refused("courant-number-nan", "relative Courant number", move || {
            with(|run| run.with_relative_courant(f64::NAN))
        }),
        refused("duration-inf", "duration", move || with(|run| run.with_duration(f64::INFINITY))),
        refused("too-many-steps", "duration", move || {
            with(|run| {
                let run = run.with_duration(1e300)?;
                run.check(&Recording::default()).map(|()| run)
            })
        }),
        refused("theta-above-1", "theta", || {
            let scheme = SchemeName::Park.with_theta(1.0 + f64::EPSILON);
            scheme.map(|_| 1.0).map_err(|refusal| refusal.to_string())
        }),
    ]
}
