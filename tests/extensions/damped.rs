//! Central differences damped by C = rate (M + M_p), the velocity half a step behind: (1 - rate dt) v instead of v.
//!
//! z = -1 is the way out: 4 - 2 rate h - h^2 l_max = 0 at the limit h.

use bipenalty::error::Refusal;
use bipenalty::pencil::Pencil;
use bipenalty::schemes::{Body, CentralDifference, Energy, Facts, Motion, Onset, Scheme, State, System};
use bipenalty::spectrum::{Engine, OfSpectrum, StepLimit};

#[derive(Debug)]
pub struct Damped {
    pub rate: f64,
}

impl Scheme for Damped {
    fn facts(&self) -> Facts {
        let (order, onset) = if self.rate > 0.0 { (1, Onset::Linear) } else { (2, Onset::SquareRoot) };
        Facts { name: "damped", order, onset, ..CentralDifference.facts() }
    }

    fn start(&self, system: System<'_>, u: Vec<f64>, mut v: Vec<f64>) -> Result<Box<dyn Motion>, Refusal> {
        let (body, mut kick) = (Body::new(&system, system.time_step)?, vec![0.0; u.len()]);
        body.operator.apply(&u, &mut kick);
        v.iter_mut()
            .zip(&kick)
            .for_each(|(v, kick)| *v = *v * (1.0 + 0.5 * self.rate * body.dt) - 0.5 * kick);
        let state = State::new(&body.contacts, u, v, body.dt);
        Ok(Box::new(Steps { rate: self.rate, kick, body, state }))
    }

    fn limit<'a>(
        &self,
        _: &'a Pencil,
        spectrum: Box<dyn Engine + 'a>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        let half = 0.5 * self.rate;
        Ok(Box::new(OfSpectrum {
            spectrum,
            of: Box::new(move |l| (half + (half * half + l).sqrt()).powi(2)),
        }))
    }
}

struct Steps {
    rate: f64,
    body: Body,
    state: State,
    kick: Vec<f64>,
}

impl Motion for Steps {
    fn step(&mut self) {
        let Self { body, state, kick, .. } = self;
        body.kick(state, kick);
        state.velocity.iter_mut().for_each(|v| *v *= 1.0 - self.rate * body.dt);
        body.operator.drift(body.dt, kick, &mut state.velocity, &mut state.displacement);
        state.read_gaps(&body.contacts);
        state.steps += 1;
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn energy(&mut self) -> Energy {
        self.body.energy(&self.state, &self.state.velocity)
    }
}
