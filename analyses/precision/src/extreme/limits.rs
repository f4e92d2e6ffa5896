//! A million steps just below and just above the stability limit.
//!
//! The top mode of a free bar of equal elements, u_j = (-1)^j, keeps its frequency omega_e in closed contact with r = 1.
//! Started from u = 0 with unit velocity, the central difference recurrence has the exact solution
//!
//! ```text
//! v_j = cos((j - 1/2) t)/cos(t/2)      cos t = 1 - 2 C^2
//! ```
//! which below the limit stays within 1/sqrt(1 - C^2) and above it grows by acosh(2 C^2 - 1) a step. Both depend on 1 - C,
//! which 16 roundings of C, of dt_cr and of the matrices change by 16 u/|1 - C|, halved by a square root.

use super::case::{Case, Found};
use super::short;
use super::stepping::run;
use bipenalty::schemes::{ContactRule, SchemeName, System};
use bipenalty::spectrum::UNIT_ROUNDOFF;

const STEPS: u64 = 1_000_000;
const DISTANCE_FROM_LIMIT: f64 = 1e-9;

/// Steps at C = 1 -+ 1e-9: central differences in closed contact, the predictor-corrector scheme without.
pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for courant in [1.0 - DISTANCE_FROM_LIMIT, 1.0 + DISTANCE_FROM_LIMIT] {
        for gamma in [0.0, 1.0] {
            let held = [
                (SchemeName::CentralDifference, ContactRule::HeldClosed),
                (SchemeName::PredictorCorrector, ContactRule::HeldOpen),
            ];
            cases.extend(held.map(|(scheme, rule)| case(scheme, rule, gamma, courant)));
        }
    }
    cases
}

fn case(scheme: SchemeName, rule: ContactRule, gamma: f64, courant: f64) -> Case {
    Case {
        name: format!("step-{}-{}-gamma-{}", short(courant), scheme.name(), short(gamma)),
        quantity: if courant > 1.0 { "ln of the growth" } else { "largest amplitude" },
        by: scheme.name(),
        formula: "8 u/|1 - C|",
        refusal: None,
        compute: Box::new(move || {
            let value = amplitude(scheme, rule, gamma, courant)?;
            let value = if courant > 1.0 { value.1.ln() } else { value.0 };
            let allowed = 8.0 * UNIT_ROUNDOFF / DISTANCE_FROM_LIMIT;
            Ok(Found { value, allowed, enclosure: None })
        }),
    }
}

/// The largest and the last velocity of node 0, m/s.
fn amplitude(scheme: SchemeName, rule: ContactRule, gamma: f64, courant: f64) -> Result<(f64, f64), String> {
    let beta_s = 1e4;
    let run = run(scheme, gamma, beta_s, 0.0, 0.0)?;
    let pencil = run.model().pencil();
    let system = System {
        pencil: &pencil,
        penalty: run.penalty(),
        load: Vec::new(),
        time_step: courant * run.critical_step(),
        critical_step: run.critical_step(),
        rule,
        account: false,
    };
    let mode = (0..pencil.size()).map(|node| if node % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let motion = run.scheme().start(system, vec![0.0; pencil.size()], mode);
    let mut motion = motion.map_err(|refusal| refusal.to_string())?;
    let mut largest = 0.0_f64;
    for _ in 0..STEPS {
        motion.step();
        let now = motion.state().velocity[0].abs();
        if !now.is_finite() {
            return Err(format!("the velocity became {now} after {} steps", motion.state().steps));
        }
        largest = largest.max(now);
    }
    Ok((largest, motion.state().velocity[0].abs()))
}
