//! The state of a run and the stepper that advances it; the schemes themselves are in their own modules.

use super::Scheme;
use super::contact::{Contact, Contacts};
use super::operator::Operator;
use super::park::Pullback;
use super::predictor_corrector;
use crate::error::Refusal;
use crate::pencil::{Pencil, Tridiagonal};

/// Which contacts are closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ContactRule {
    /// Those with g > 0.
    #[default]
    Unilateral,
    /// All, in tension too: the linear system whose stability the maps show.
    HeldClosed,
    /// None.
    HeldOpen,
}

/// The parameters of the Park scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Park {
    /// theta in [0, 1], the weight of the pullback.
    pub theta: f64,
    /// dt_c, s: the critical step of the contact-free system, to which the pullback extrapolates.
    pub critical_step: f64,
}

/// What a stepper is made of.
#[derive(Debug, Clone)]
pub struct Setup<'a> {
    /// K and M, contact-free.
    pub pencil: &'a Pencil,
    /// From left to right.
    pub contacts: Vec<Contact>,
    /// Nodal forces f, N; empty for none.
    pub load: Vec<f64>,
    /// The scheme.
    pub scheme: Scheme,
    /// dt, s.
    pub time_step: f64,
    /// Which contacts are closed.
    pub rule: ContactRule,
    /// Used by [`Scheme::Park`] only.
    pub park: Park,
    /// Whether the loss of the Park scheme is summed up step by step; the other schemes need no sum.
    pub account: bool,
}

/// Displacements, velocities and accelerations of n nodes, gaps of k contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Steps done.
    pub(super) steps: u64,
    /// u, m.
    pub(super) displacement: Vec<f64>,
    /// v, m/s: central differences at the last mid-point, the others at the time of u.
    pub(super) velocity: Vec<f64>,
    /// Central differences and predictor-corrector: the last dt a, m/s; Park: a, m/s^2.
    pub(super) rate: Vec<f64>,
    /// g, m.
    pub(super) gap: Vec<f64>,
    /// Z'v, m/s, at the time of v.
    pub(super) gap_velocity: Vec<f64>,
    /// Z' of `rate`.
    pub(super) gap_rate: Vec<f64>,
    /// Z' of the contact-free dt a, m/s; central differences only.
    pub(super) free_kick: Vec<f64>,
    /// g one step ago, m; central differences only.
    pub(super) previous_gap: Vec<f64>,
    /// g after the last step minus g before it, m.
    pub(super) last_gap_change: Vec<f64>,
    /// lambda, N, positive in compression.
    pub(super) force: Vec<f64>,
    pub(super) closed: Vec<bool>,
    /// Changes between open and closed since the start, all contacts together.
    pub(super) switches: u64,
    /// Work that the bars have done on the contacts, J.
    pub(super) contact_work: f64,
    /// The same with the weights that the scheme's own energy balance uses, J.
    pub(super) balance_work: f64,
    /// Energy lost to the pullback of the Park scheme, J.
    pub(super) pullback_loss: f64,
    /// Whether force, rate and `closed` belong to the present displacement.
    pub(super) synchronised: bool,
}

impl State {
    /// Steps done since the start.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// u, m.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// v as the scheme stores it, m/s: central differences half a step before the time of u.
    pub fn stored_velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// g of every contact, m, positive in penetration; with the digits that u has lost.
    pub fn gaps(&self) -> &[f64] {
        &self.gap
    }

    /// lambda of every contact, N, positive in compression; see [`Stepper::synchronise`].
    pub fn forces(&self) -> &[f64] {
        &self.force
    }

    /// Which contacts are closed.
    pub fn closed(&self) -> &[bool] {
        &self.closed
    }

    /// How often a contact has opened or closed.
    pub fn switches(&self) -> u64 {
        self.switches
    }

    /// Work done on the contacts, J.
    pub fn contact_work(&self) -> f64 {
        self.contact_work
    }

    /// The same with the weights of the scheme's own energy balance, J: minus what the contacts have added to the energy
    /// that the scheme keeps without them; see [`Stepper::synchronise`].
    pub fn balance_work(&self) -> f64 {
        self.balance_work
    }

    /// Notes which contacts are closed; true closed contacts take part in the step.
    pub(super) fn search(&mut self, rule: ContactRule) {
        for (closed, gap) in self.closed.iter_mut().zip(&self.gap) {
            let now = match rule {
                ContactRule::Unilateral => *gap > 0.0,
                ContactRule::HeldClosed => true,
                ContactRule::HeldOpen => false,
            };
            self.switches += u64::from(now != *closed);
            *closed = now;
        }
    }

    /// Sets u and v of the contact nodes from the gaps, which have kept more digits.
    pub(super) fn settle(&mut self, contacts: &Contacts) {
        for (j, contact) in contacts.list.iter().enumerate() {
            contact.set_across(self.gap[j] - contact.initial_gap, &mut self.displacement);
            contact.set_across(self.gap_velocity[j], &mut self.velocity);
        }
    }
}

/// Advances a [`State`] by one scheme; a step allocates nothing.
#[derive(Debug, Clone)]
pub struct Stepper {
    pub(super) scheme: Scheme,
    pub(super) dt: f64,
    pub(super) rule: ContactRule,
    /// Central differences and predictor-corrector: dt M^-1 (f - K u); Park: without dt.
    pub(super) operator: Operator,
    pub(super) contacts: Contacts,
    pub(super) pullback: Pullback,
    pub(super) account: bool,
    pub(super) load: Vec<f64>,
    pub(super) stiffness: Tridiagonal,
    pub(super) mass: Tridiagonal,
    /// n entries each.
    pub(super) scratch: [Vec<f64>; 2],
    /// k entries each.
    pub(super) contact_scratch: [Vec<f64>; 2],
    pub(super) gap_scratch: [Vec<f64>; 2],
    /// m - dt^2 s of each contact, kg.
    pub(super) relief: Vec<f64>,
    /// Whether 1/2 < q <= 1, q = dt^2 s mu/(1 + m mu), of each contact: sums of gap and gap rate would cancel.
    pub(super) delicate: Vec<bool>,
    /// u and v of contact nodes after the step: node, displacement, velocity.
    pub(super) touched: Vec<(usize, f64, f64)>,
}

impl Stepper {
    /// The stepper of `setup`.
    ///
    /// # Errors
    /// Refuses a step that is not positive and finite, theta outside [0, 1], a critical step that is not positive and
    /// finite, and the diagonalised mass penalty.
    pub fn new(setup: Setup) -> Result<Self, Refusal> {
        let Setup { pencil, contacts, load, scheme, time_step, rule, park, account } = setup;
        let positive = |place: &str, value: f64| {
            let held = value > 0.0 && value.is_finite();
            held.then_some(()).ok_or_else(|| Refusal::new(place, value, "a positive finite number (s)"))
        };
        positive("time step", time_step)?;
        if scheme == Scheme::Park {
            positive("critical step of the Park scheme", park.critical_step)?;
            if !(0.0..=1.0).contains(&park.theta) {
                return Err(Refusal::new("theta", park.theta, "a number in [0, 1]"));
            }
        }
        let n = pencil.size();
        let scale = if scheme == Scheme::Park { 1.0 } else { time_step };
        let k = contacts.len();
        let relief =
            |c: &Contact| predictor_corrector::difference(c.penalty.mass, time_step, c.penalty.stiffness);
        let relief: Vec<f64> = contacts.iter().map(relief).collect();
        let contacts = Contacts::new(pencil, contacts)?;
        let delicate = |(j, contact): (usize, &Contact)| {
            let mu = contacts.compliance(j);
            let kept = (1.0 + mu * relief[j]) / (1.0 + mu * contact.penalty.mass);
            (0.0..0.5).contains(&kept)
        };
        Ok(Self {
            delicate: contacts.list.iter().enumerate().map(delicate).collect(),
            relief,
            touched: Vec::with_capacity(2 * k),
            scheme,
            dt: time_step,
            rule,
            operator: Operator::new(pencil, &load, scale),
            contacts,
            pullback: Pullback::new(park, time_step),
            account,
            load,
            stiffness: pencil.stiffness().clone(),
            mass: pencil.mass().clone(),
            scratch: [vec![0.0; n], vec![0.0; n]],
            contact_scratch: [vec![0.0; k], vec![0.0; k]],
            gap_scratch: [vec![0.0; k], vec![0.0; k]],
        })
    }

    /// dt, s.
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// mu_j = z_j' M^-1 z_j, 1/kg.
    pub fn compliance(&self, contact: usize) -> f64 {
        self.contacts.compliance(contact)
    }

    /// The state at time 0 from u and v (n entries each). The gaps are those of the contacts plus Z'u.
    pub fn start(&mut self, displacement: Vec<f64>, velocity: Vec<f64>) -> State {
        let (n, k) = (displacement.len(), self.contacts.list.len());
        let across = |x: &[f64]| self.contacts.list.iter().map(|c| c.across(x)).collect::<Vec<_>>();
        let mut gap = across(&displacement);
        gap.iter_mut().zip(&self.contacts.list).for_each(|(gap, contact)| *gap += contact.initial_gap);
        let gap_velocity = across(&velocity);
        let last_gap_change = gap_velocity.iter().map(|w| self.dt * w).collect();
        let mut state = State {
            steps: 0,
            displacement,
            velocity,
            rate: vec![0.0; n],
            gap,
            gap_velocity,
            gap_rate: vec![0.0; k],
            free_kick: vec![0.0; k],
            previous_gap: vec![0.0; k],
            last_gap_change,
            force: vec![0.0; k],
            closed: vec![false; k],
            switches: 0,
            contact_work: 0.0,
            balance_work: 0.0,
            pullback_loss: 0.0,
            synchronised: false,
        };
        match self.scheme {
            Scheme::CentralDifference => self.start_central_difference(&mut state),
            Scheme::PredictorCorrector => self.start_predictor_corrector(&mut state),
            Scheme::Park => self.start_park(&mut state),
        }
        state.switches = 0;
        state
    }

    /// One step.
    pub fn step(&mut self, state: &mut State) {
        match self.scheme {
            Scheme::CentralDifference => self.step_central_difference(state),
            Scheme::PredictorCorrector => self.step_predictor_corrector(state),
            Scheme::Park => self.step_park(state),
        }
        state.steps += 1;
    }

    /// Brings forces and accelerations to the time of u. Central differences would find them in the next step only;
    /// that step then uses what is found here, so that nothing is computed twice and no result changes.
    pub fn synchronise(&mut self, state: &mut State) {
        if self.scheme == Scheme::CentralDifference && !state.synchronised {
            self.accelerate_central_difference(state);
        }
    }

    /// v at the time of u, m/s, into `velocity`; the state must be synchronised.
    pub fn nodal_velocity(&self, state: &State, velocity: &mut [f64]) {
        velocity.copy_from_slice(&state.velocity);
        if self.scheme == Scheme::CentralDifference {
            velocity.iter_mut().zip(&state.rate).for_each(|(v, kick)| *v += 0.5 * kick);
        }
    }
}
