//! Contact that opens and closes: the energy that a scheme gains from it inside its linear limit.
//!
//! # What counts as energy
//! Without contact each scheme keeps an energy H of the bars, less the work of the body force (see
//! [`schemes::Energy`](crate::schemes::Energy)): for central differences and the predictor-corrector it is the leapfrog
//! energy, positive for C < 1, in which no penalty takes part. What contact adds to it is, to rounding,
//!
//! ```text
//! H_n - H_0 = -W_n      W = work of the bars on the contacts with the weights of the scheme's own balance
//! energy gain = max over n of (H_n - H_0)/E_in = max over n of -W_n/E_in
//! ```
//! so that the error O(dt^2) of the kinetic and strain energy at one time is no gain, nor is what the pullback of the Park
//! scheme takes away a loss of the contact. E_in is all the energy put in: kinetic at the start, the work of the body force
//! until the first contact, and under a sustained load 4 V, V the strain energy at rest under it: a bar to which a load is
//! applied at once comes to rest at twice the static displacement, with four times its strain energy.
//! An open contact does no work. A closed one below its linear limit takes and returns energy in bounded motion; what is
//! misplaced at switches can add up.
//!
//! # What counts as a gain
//! A switch falls within one step and moves one contact node. What it misplaces is a part of the energy of that node, and
//! the next switch may give it back. A gain counts if it exceeds the mean energy of one element, E_in/elements: then the
//! errors of several switches have added up.
//!
//! # The predictor-corrector does not gain (any contacts, below the bound of the step; proven in exact arithmetic)
//! One contact, dt^2 s' mu <= 1: the corrected gap is g = (1 - dt^2 s' mu) g_pred, of the sign of g_pred. So the reaction is
//! lambda = k max(g, 0) with k = s'/(1 - dt^2 s' mu) >= 0 of the *new* gap: the slope at g of the convex f(g) =
//! k max(g, 0)^2/2. Its balance has the work lambda_n (g_n - g_{n-2})/2 >= (f(g_n) - f(g_{n-2}))/2, whose sum telescopes: from
//! an open start W_n >= (f(g_n) + f(g_{n-1}))/2 >= 0, for any mass matrix and load and any sequence of switches. At
//! dt^2 s' mu = 1, f is the barrier g <= 0. Several contacts, dt^2 < a + 1/l_max(S G): the same with a convex f of all gaps,
//! as reactions that act on each other are found together (beside the step in `schemes/predictor_corrector/motion.rs`). So
//! with C <= 1 what limits closed contact limits the scheme. In f64 it holds to rounding (measured on every run that is made,
//! at the tolerance of its row).
//!
//! # Meshes and matrices
//! They are run in the impact of their scene alone, and E_in is the kinetic energy at the start: how much a load puts into a
//! mesh is not known before. A gain counts from the mean energy of an element, or of an unknown where there are no elements.
//!
//! # Why central differences do gain
//! The mass m joins the bar with the velocity it is hit with, energy m (Z'v)^2/2 that nobody has paid for, and leaves with
//! another one. Between closing and opening the bars gain the difference; m = s/(r omega_e^2) grows with beta_s and 1/r.
//! Park: a stretch of contact gives s'/2 (g g+ at its end minus g g- at its start), g and g+- being the gaps on either
//! side of the switch: small as long as the contact stays closed for many steps.

use crate::error::Refusal;
use crate::impact::{Passage, Run, potential_at_start};
use crate::pencil::{Gap, Pencil};
use crate::scene::{Bar, ContactSite, End, Impact, Scene};
use crate::schemes::{Motion, Scheme};
use crate::stability::Model;

use super::{PenaltyPoint, Predictor};

/// Times that a wave runs through the row of bars under a sustained load.
pub const TRANSITS: f64 = 20.0;

/// A run that has gained this many times the energy put in has nothing more to tell.
pub const LARGEST_GAIN: f64 = 1e3;

/// Longer runs are not made: a fraction of a second each, but a scan has thousands.
pub const MOST_STEPS: u64 = 1_000_000;

/// What makes contacts open and close.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Load {
    /// The impact of the scene, over its duration.
    Impact,
    /// The same impact under a body force that lasts: the bars bounce and come to rest on the contact.
    Sustained,
}

impl Load {
    /// Every load.
    pub const ALL: [Self; 2] = [Self::Impact, Self::Sustained];

    /// The name in records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Impact => "impact",
            Self::Sustained => "sustained",
        }
    }

    /// `model` under this load; `None` if it cannot be put under it. A sustained load needs a row that is held at one end
    /// and free at the other, and a bar that moves. Its body force b gives the row the largest initial speed v within one
    /// transit, b = v/sum(L/c): on a single bar its weight is the contact force rho A c v of the impact.
    ///
    /// # Errors
    /// A body force that f64 cannot hold.
    pub fn on(self, model: &Model) -> Result<Option<Model>, Refusal> {
        let scene = model.scene();
        if self == Self::Impact {
            return Ok(Some(model.clone()));
        }
        let Some(impact) = scene.impact() else { return Ok(None) };
        let speed = scene.bars().iter().map(|bar| bar.velocity.abs()).fold(0.0, f64::max);
        let Some(direction) = towards_the_held_end(scene).filter(|_| speed > 0.0) else { return Ok(None) };
        let transit: f64 = scene.bars().iter().map(|bar| bar.length / bar.wave_speed()).sum();
        let impact = Impact {
            duration: TRANSITS * transit,
            gravity: direction * speed / transit,
            gaps: impact.gaps.clone(),
        };
        let bars = scene.bars().to_vec();
        let pressed = Scene::new(scene.name(), scene.left(), bars, scene.right(), Some(impact))?;
        Ok(Some(Model::new(pressed, model.mass(), model.form())))
    }

    /// Energy that the load can give beyond what the bars have at the start, J.
    fn available(self, run: &Run) -> f64 {
        let rest = match self {
            Self::Impact => 0.0,
            Self::Sustained => 4.0 * static_strain_energy(run.model().scene()),
        };
        potential_at_start(run) + rest
    }
}

/// +1 if the right end alone is held, -1 if the left end alone is.
fn towards_the_held_end(scene: &Scene) -> Option<f64> {
    match (scene.left() == End::Free, scene.right() == End::Free) {
        (true, false) => Some(1.0),
        (false, true) => Some(-1.0),
        _ => None,
    }
}

/// The sum of the integrals of N^2/(2 E A) over the bars, N being the weight between x and the free end, J.
fn static_strain_energy(scene: &Scene) -> f64 {
    let gravity = scene.impact().map_or(0.0, |impact| impact.gravity);
    let mut bars: Vec<&Bar> = scene.bars().iter().collect();
    if towards_the_held_end(scene) == Some(-1.0) {
        bars.reverse();
    }
    let (mut energy, mut above) = (0.0, 0.0);
    for bar in bars {
        let below = above + bar.density * bar.area * bar.length * gravity;
        let square = above * above + above * below + below * below;
        energy += bar.length / (6.0 * bar.youngs_modulus * bar.area) * square;
        above = below;
    }
    energy
}

/// What a run has gained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// The largest net work of the contacts on the bars over the energy put in; at least 0.
    pub energy_gain: f64,
    /// H at the end plus what the load can still give, over the energy put in: 1 for a perfect scheme.
    pub energy_ratio: f64,
    /// How often a contact has opened or closed.
    pub switches: u64,
    /// Steps done: fewer than those of the run if it gained [`LARGEST_GAIN`].
    pub steps: u64,
}

/// E_in of `run`, a run of a model under `load`, J.
///
/// # Errors
/// Refuses the diagonalised mass penalty, and a scene in which no energy is put in.
pub fn energy_put_in(run: &Run, load: Load) -> Result<f64, Refusal> {
    let supplied = run.prepare(false)?.energy().stored() + load.available(run);
    if supplied.is_normal() && supplied > 0.0 {
        return Ok(supplied);
    }
    let place = format!("scene {}, impact", run.model().scene().name());
    Err(Refusal::new(place, format!("{supplied:e} J put in"), "bars that move or fall towards a contact"))
}

/// The energy that `run`, a run of a model under `load`, gains from its contacts.
///
/// # Errors
/// As [`energy_put_in`].
pub fn energy_gain(run: &Run, load: Load) -> Result<Gain, Refusal> {
    gain_of(run.prepare(false)?, run.steps(), energy_put_in(run, load)?)
}

/// E_in of a passage, J.
///
/// # Errors
/// A load, and bodies that are at rest.
pub fn passage_energy(passage: &Passage) -> Result<f64, Refusal> {
    if !passage.encounter().load().is_empty() {
        let allowed =
            "none with opening contact: the energy that a load puts into a mesh is not known before";
        return Err(Refusal::new("scene, impact", "a gravity or load", allowed));
    }
    let supplied = passage.prepare(false)?.energy().stored();
    if supplied.is_normal() && supplied > 0.0 {
        return Ok(supplied);
    }
    Err(Refusal::new("scene, impact", format!("{supplied:e} J put in"), "bodies that move towards a contact"))
}

/// The energy that a passage gains from its contacts.
///
/// # Errors
/// As [`passage_energy`].
pub fn passage_gain(passage: &Passage) -> Result<Gain, Refusal> {
    gain_of(passage.prepare(false)?, passage.steps(), passage_energy(passage)?)
}

/// What a motion gains in so many steps, over the energy put in.
fn gain_of(mut motion: Box<dyn Motion>, steps: u64, supplied: f64) -> Result<Gain, Refusal> {
    let start = motion.energy();
    let mut gained: f64 = 0.0;
    for _ in 0..steps {
        motion.step();
        motion.synchronise();
        let now = -motion.state().balance_work / supplied;
        gained = if now.is_nan() { f64::INFINITY } else { gained.max(now) };
        if gained > LARGEST_GAIN {
            break;
        }
    }
    let end = motion.energy();
    let state = motion.state();
    let available = supplied - start.stored();
    // Without an account of the pullback this is H of the state alone.
    let bars = end.stored() + end.loss - state.balance_work;
    Ok(Gain {
        energy_gain: gained,
        energy_ratio: (bars + available - (end.body_work - start.body_work)) / supplied,
        switches: state.switches,
        steps: state.steps,
    })
}

/// The gain from which on it counts: the mean energy of an element over the energy put in.
pub fn least_gain(model: &Model) -> f64 {
    1.0 / model.scene().elements() as f64
}

/// Whether the premises hold under which a scheme is proven to gain nothing below its limit, in exact arithmetic: one with
/// [`Facts::gains_nothing`](crate::schemes::Facts::gains_nothing), and contacts that are open at the start and one step before it.
pub fn is_proven_passage(passage: &Passage) -> bool {
    let dt = passage.time_step();
    let velocity = passage.encounter().velocity();
    let open = |gap: &Gap| gap.initial <= 0.0 && gap.initial <= dt * gap.column.dot(velocity);
    passage.scheme().facts().gains_nothing && passage.encounter().pencil().gaps().iter().all(open)
}

/// Whether the premises hold under which a scheme with [`Facts::gains_nothing`](crate::schemes::Facts::gains_nothing) is proven,
/// in exact arithmetic, to gain nothing below its limit, or what bounds it from below ([module](self)): every contact is open
/// at the start and one step before it. A step below is the caller's to keep; false proves nothing.
pub fn is_proven(model: &Model, scheme: &dyn Scheme) -> bool {
    let scene = model.scene();
    let velocity = |bar: usize| scene.bars()[bar].velocity;
    let opens_backwards = |(j, site): (usize, &ContactSite)| {
        let distance = scene.impact().and_then(|impact| impact.gaps.get(j)).copied().unwrap_or(0.0);
        let approach = match *site {
            ContactSite::LeftWall => -velocity(0),
            ContactSite::Between(left) => velocity(left) - velocity(left + 1),
            ContactSite::RightWall => velocity(scene.bars().len() - 1),
        };
        distance >= 0.0 && approach >= 0.0
    };
    let sites = scene.contact_sites();
    scheme.facts().gains_nothing && !sites.is_empty() && sites.iter().enumerate().all(opens_backwards)
}

/// The linear limits of one scheme, dt over the contact-free critical step.
pub struct LinearLimit<'a> {
    model: &'a Model,
    predictor: Predictor<'a>,
}

impl<'a> LinearLimit<'a> {
    /// The limits of `scheme` for `model`, whose pencil is `pencil`.
    ///
    /// # Errors
    /// What [`Predictor::new`] refuses.
    pub fn new(model: &'a Model, pencil: &'a Pencil, scheme: &dyn Scheme) -> Result<Self, Refusal> {
        Ok(Self { model, predictor: Predictor::new(model, pencil, scheme)? })
    }

    /// The limit of closed contact, or 1 where open contact stands less.
    ///
    /// # Errors
    /// As [`Predictor::step`].
    pub fn relative(&self, point: PenaltyPoint) -> Result<f64, Refusal> {
        let (closed, contact_free) = (self.predictor.step(point)?.l.value, self.predictor.contact_free());
        Ok((contact_free / closed.max(contact_free)).sqrt())
    }

    /// c0 dt/h of the reference element of the contact-free critical step.
    pub fn contact_free_courant(&self) -> f64 {
        self.model.critical_courant(self.predictor.contact_free())
    }
}
