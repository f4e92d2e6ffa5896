//! One scene with one mass matrix: everything a stability limit depends on but the penalties.

use std::str::FromStr;

use super::{Auto, ClosedForm, Grid};
use crate::error::Refusal;
use crate::fem::{MassMatrix, assemble, contact_scales, pencil_bytes, reference_bar};
use crate::memory;
use crate::penalty::{self, PenaltyMass, Ratio, StiffnessPenalty};
use crate::pencil::{Penalty, Pencil, Scale};
use crate::scene::Scene;
use crate::schemes::{Onset, Scheme};
use crate::spectrum::{Dense, Enclosure, Engine, Evidence, MAX_DENSE_NODES, Secular, Step, StepLimit, Sturm};

/// The engines by the names that users type.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EngineName {
    /// `closed-form`, and point by point `sturm` where that certifies nothing.
    #[default]
    Auto,
    /// Wittrick-Williams on uniform bars, O(1) in the number of elements.
    ClosedForm,
    /// The compressed secular function of the assembled pencil.
    Secular,
    /// Bisection on the pivots of the assembled pencil.
    Sturm,
    /// The dense reduction with faer.
    Dense,
    /// The same dense reduction with LAPACK.
    #[cfg(feature = "lapack")]
    Lapack,
}

impl EngineName {
    /// Every engine, with its name.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("auto", Self::Auto),
        ("closed-form", Self::ClosedForm),
        ("secular", Self::Secular),
        ("sturm", Self::Sturm),
        ("dense", Self::Dense),
        #[cfg(feature = "lapack")]
        ("lapack", Self::Lapack),
    ];
}

impl EngineName {
    /// The name as typed.
    pub fn text(self) -> &'static str {
        Self::ALL.iter().find(|(_, engine)| *engine == self).map_or("auto", |(name, _)| name)
    }

    /// Whether the engine works on the assembled pencil.
    pub fn needs_pencil(self) -> bool {
        !matches!(self, Self::Auto | Self::ClosedForm)
    }

    /// Whether the engine needs memory quadratic in the number of nodes.
    pub fn is_dense(self) -> bool {
        #[cfg(feature = "lapack")]
        if self == Self::Lapack {
            return true;
        }
        self == Self::Dense
    }
}

impl FromStr for EngineName {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        let names: Vec<_> = Self::ALL.iter().map(|(name, _)| *name).collect();
        let hint = if text == "lapack" { " (lapack needs a build with --features lapack)" } else { "" };
        found.map(|(_, engine)| *engine).ok_or_else(|| {
            Refusal::new("engine", format!("{text:?}"), names.join(", ") + hint).suggesting(text, names)
        })
    }
}

/// A critical time step and its enclosure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalStep {
    /// omega_max, rad/s.
    pub omega_max: f64,
    /// C_r = c0 dt_cr/h of the reference element; `lower` where only a lower bound of it is known.
    pub critical_courant: f64,
    /// Proven lower bound of C_r.
    pub lower: f64,
    /// Proven upper bound of C_r; infinite where none is known.
    pub upper: f64,
    /// What stands behind it.
    pub evidence: Evidence,
}

impl CriticalStep {
    /// Whether C_r may lie anywhere above `lower`.
    pub fn is_lower_bound(&self) -> bool {
        self.evidence == Evidence::LowerBound
    }
}

/// A scene with a mass matrix and a form of the mass penalty.
#[derive(Debug, Clone)]
pub struct Model {
    scene: Scene,
    mass: MassMatrix,
    form: PenaltyMass,
    scales: Vec<Scale>,
    reference_eigenvalue: f64,
    reference_rate: f64,
}

impl Model {
    /// The model; costs nothing, the pencil is assembled by the engines that need it.
    pub fn new(scene: Scene, mass: MassMatrix, form: PenaltyMass) -> Self {
        let reference = reference_bar(&scene, mass);
        let reference_rate = reference.element_stiffness() / reference.element_mass();
        let (scales, reference_eigenvalue) = (contact_scales(&scene), mass.element_eigenvalue(reference));
        Self { mass, form, scales, reference_eigenvalue, reference_rate, scene }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The mass matrix.
    pub fn mass(&self) -> MassMatrix {
        self.mass
    }

    /// The form of the mass penalty.
    pub fn form(&self) -> PenaltyMass {
        self.form
    }

    /// The scales of the contacts from left to right.
    pub fn scales(&self) -> &[Scale] {
        &self.scales
    }

    /// omega^2, rad^2/s^2: the largest of the elements that touch a contact, in which the ratio is measured.
    pub fn reference_eigenvalue(&self) -> f64 {
        self.reference_eigenvalue
    }

    /// Whether the mass penalty of a contact is spread over its nodes: the diagonalised form between two bars.
    pub fn spreads_mass(&self) -> bool {
        self.form == PenaltyMass::Diagonalised && self.scales.iter().any(|scale| scale.pair)
    }

    /// The contact-free pencil, assembled.
    pub fn pencil(&self) -> Pencil {
        assemble(&self.scene, self.mass)
    }

    /// The penalty of all contacts for (beta_s, r); every contact is closed.
    #[inline]
    pub fn penalty(&self, beta_s: StiffnessPenalty, ratio: Ratio) -> Penalty {
        Penalty { stiffness: beta_s.get(), rate: ratio.get() * self.reference_eigenvalue, form: self.form }
    }

    /// Refuses penalties that f64 cannot hold.
    ///
    /// # Errors
    /// See [`penalty::check`].
    pub fn check(&self, beta_s: StiffnessPenalty, ratio: Ratio) -> Result<(), Refusal> {
        let check = |scale: &Scale| penalty::check(scale.stiffness, self.reference_eigenvalue, beta_s, ratio);
        self.scales.iter().try_for_each(check)
    }

    /// Refuses a grid whose penalties f64 cannot hold; s and m are monotone, so its corners tell.
    ///
    /// # Errors
    /// See [`penalty::check`].
    pub fn check_grid(&self, grid: &Grid) -> Result<(), Refusal> {
        let scales: Vec<f64> = self.scales.iter().map(|scale| scale.stiffness).collect();
        check_grid(&scales, self.reference_eigenvalue, grid)
    }

    /// Refuses a scene whose pencil the memory does not hold.
    ///
    /// # Errors
    /// Names the bytes needed and the number of elements that fit.
    pub fn check_pencil(&self) -> Result<(), Refusal> {
        let (elements, bytes) = (self.scene.elements(), pencil_bytes(&self.scene));
        let place = (&*format!("scene {}, elements", self.scene.name()), &*elements.to_string());
        memory::require(place, "matrices", bytes, |left| {
            format!("at most {} elements", left / bytes.div_ceil(elements as u64))
        })
    }

    /// Refuses an engine that cannot hold the scene.
    ///
    /// # Errors
    /// The dense engines beyond [`MAX_DENSE_NODES`], and those that need a pencil as [`Model::check_pencil`].
    pub fn check_engine(&self, engine: EngineName) -> Result<(), Refusal> {
        let nodes = self.scene.elements() + self.scene.bars().len();
        if engine.is_dense() && nodes > MAX_DENSE_NODES {
            let value = format!("{} with {nodes} nodes", engine.text());
            return Err(Refusal::new("engine", value, format!("at most {MAX_DENSE_NODES} nodes, or auto")));
        }
        if engine.needs_pencil() { self.check_pencil() } else { Ok(()) }
    }

    /// The closed form of this model, which needs no pencil.
    pub fn closed_form(&self) -> ClosedForm {
        ClosedForm::new(&self.scene, self.mass)
    }

    /// The engine `auto` of this model, which assembles a pencil where it needs one.
    pub fn auto(&self) -> Auto {
        Auto::new(&self.scene, self.mass)
    }

    /// The engine called `name`, of the pencil of this model.
    ///
    /// # Errors
    /// As [`Model::check_engine`]; a pencil that is no chain.
    pub fn engine<'a>(&self, name: EngineName, pencil: &'a Pencil) -> Result<Box<dyn Engine + 'a>, Refusal> {
        self.check_engine(name)?;
        let chain = || {
            pencil
                .chain()
                .ok_or_else(|| Refusal::new("engine", name.text(), "dense, for what is no row of bars"))
        };
        Ok(match name {
            EngineName::Auto => Box::new(self.auto()),
            EngineName::ClosedForm => Box::new(self.closed_form()),
            EngineName::Secular => Box::new(Secular::new(chain()?)),
            EngineName::Sturm => Box::new(Sturm::new(chain()?)),
            EngineName::Dense => Box::new(Dense::new(pencil)?),
            #[cfg(feature = "lapack")]
            EngineName::Lapack => Box::new(crate::spectrum::lapack::Lapack::new(chain()?)),
        })
    }

    /// The limit of `scheme` with closed contacts; `pencil` is that of this model.
    ///
    /// # Errors
    /// As [`Scheme::limit`]; the diagonalised mass penalty between two bars for all but the scheme of the spectrum, in
    /// which (M + M_p)^-1 Z is no multiple of M^-1 Z.
    pub fn limit<'a>(
        &self,
        scheme: &dyn Scheme,
        pencil: &'a Pencil,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        let name = scheme.facts().name;
        if self.spreads_mass() && scheme.facts().onset != Onset::SquareRoot {
            let value = format!("{name} with a diagonalised mass penalty between two bars");
            return Err(Refusal::new("limit", value, "the consistent mass penalty"));
        }
        scheme.limit(pencil, Box::new(self.auto()))
    }

    /// (c0/h)^2 of the reference element, 1/s^2: C_r = 2 sqrt(rate/l).
    pub fn reference_rate(&self) -> f64 {
        self.reference_rate
    }

    /// C_r of an eigenvalue l, dimensionless.
    pub fn critical_courant(&self, l: f64) -> f64 {
        2.0 * (self.reference_rate / l).sqrt()
    }

    /// dt_cr in s of a critical Courant number: dt = C_r h/c0.
    pub fn time_step(&self, critical_courant: f64) -> f64 {
        critical_courant / self.reference_rate.sqrt()
    }

    /// The critical step of an enclosed eigenvalue.
    pub fn critical_step(&self, l: Enclosure) -> CriticalStep {
        critical_step(self.reference_rate, Step::proven(l))
    }

    /// The critical step of a limit with its evidence.
    pub fn critical_step_of(&self, step: Step) -> CriticalStep {
        critical_step(self.reference_rate, step)
    }
}

/// The critical step of a limit where C_r = 2 sqrt(rate/l). Division and square root round three times, hence the margin.
pub(super) fn critical_step(rate: f64, step: Step) -> CriticalStep {
    let courant = |l: f64| 2.0 * (rate / l).sqrt();
    let margin = 2.0 * f64::EPSILON;
    let Step { l, evidence } = step;
    let lower = courant(l.upper) * (1.0 - margin);
    let upper = courant(l.lower) * (1.0 + margin);
    let value = match evidence {
        Evidence::LowerBound => lower,
        Evidence::Proven | Evidence::Probability(_) => courant(l.value),
    };
    CriticalStep { omega_max: l.value.sqrt(), critical_courant: value, lower, upper, evidence }
}

/// Refuses a grid whose penalties f64 cannot hold at contacts of these scales (N/m); s and m are monotone, so its
/// corners tell. `reference` is omega^2.
pub(super) fn check_grid(scales: &[f64], reference: f64, grid: &Grid) -> Result<(), Refusal> {
    let positive = || grid.stiffness_penalties.iter().filter(|b| b.get() > 0.0).copied();
    let smallest = positive().reduce(|a, b| if b < a { b } else { a });
    let largest = positive().reduce(|a, b| if b > a { b } else { a });
    for beta_s in [smallest, largest].into_iter().flatten() {
        for (ratio, scale) in grid.ratios.iter().flat_map(|r| scales.iter().map(move |w| (r, w))) {
            penalty::check(*scale, reference, beta_s, *ratio)?;
        }
    }
    Ok(())
}
