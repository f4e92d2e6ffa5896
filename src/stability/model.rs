//! One scene with one mass matrix: everything a stability limit depends on but the penalties.

use std::str::FromStr;

use super::{ClosedForm, Grid};
use crate::error::Refusal;
use crate::fem::{MassMatrix, assemble};
use crate::penalty::{ContactScale, PenaltyMass, Ratio, StiffnessPenalty, reference_bar};
use crate::pencil::{Penalty, Pencil};
use crate::scene::Scene;
use crate::spectrum::{Dense, Enclosure, Engine, MAX_DENSE_NODES, Secular, Sturm};

/// The engines by the names that users type.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EngineName {
    /// The cheapest that is exact enough: `closed-form` for scenes of uniform bars.
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
        found
            .map(|(_, engine)| *engine)
            .ok_or_else(|| Refusal::new("engine", format!("{text:?}"), names.join(", ") + hint))
    }
}

/// A critical time step and its enclosure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CriticalStep {
    /// omega_max, rad/s.
    pub omega_max: f64,
    /// C_r = c0 dt_cr/h of the reference element.
    pub critical_courant: f64,
    /// Proven lower bound of C_r.
    pub lower: f64,
    /// Proven upper bound of C_r.
    pub upper: f64,
}

/// A scene with a mass matrix and a form of the mass penalty.
#[derive(Debug, Clone)]
pub struct Model {
    scene: Scene,
    mass: MassMatrix,
    form: PenaltyMass,
    scales: Vec<ContactScale>,
    reference_rate: f64,
    reference_eigenvalue: f64,
}

impl Model {
    /// The model; costs nothing, the pencil is assembled by the engines that need it.
    pub fn new(scene: Scene, mass: MassMatrix, form: PenaltyMass) -> Self {
        let reference = reference_bar(&scene, mass);
        let reference_rate = reference.element_stiffness() / reference.element_mass();
        let reference_eigenvalue = mass.element_eigenvalue(reference);
        let scales = ContactScale::of(&scene);
        Self { mass, form, scales, reference_rate, reference_eigenvalue, scene }
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
    pub fn scales(&self) -> &[ContactScale] {
        &self.scales
    }

    /// The contact-free pencil, assembled.
    pub fn pencil(&self) -> Pencil {
        assemble(&self.scene, self.mass)
    }

    /// The contact terms of all contacts for (beta_s, r); every contact is closed.
    pub fn penalties(&self, beta_s: StiffnessPenalty, ratio: Ratio) -> Vec<Penalty> {
        self.scales
            .iter()
            .map(|scale| scale.penalty(beta_s, ratio, self.reference_eigenvalue, self.form))
            .collect()
    }

    /// As [`Model::penalties`] into a buffer: a map needs them at every point.
    #[inline]
    pub fn set_penalties(&self, penalties: &mut Vec<Penalty>, beta_s: StiffnessPenalty, ratio: Ratio) {
        if penalties.len() != self.scales.len() {
            penalties.resize(self.scales.len(), Penalty::default());
        }
        for (penalty, scale) in penalties.iter_mut().zip(&self.scales) {
            *penalty = scale.penalty(beta_s, ratio, self.reference_eigenvalue, self.form);
        }
    }

    /// Refuses penalties that f64 cannot hold.
    ///
    /// # Errors
    /// See [`ContactScale::check`].
    pub fn check(&self, beta_s: StiffnessPenalty, ratio: Ratio) -> Result<(), Refusal> {
        self.scales.iter().try_for_each(|scale| scale.check(beta_s, ratio, self.reference_eigenvalue))
    }

    /// Refuses a grid whose penalties f64 cannot hold; s and m are monotone, so its corners tell.
    ///
    /// # Errors
    /// See [`ContactScale::check`].
    pub fn check_grid(&self, grid: &Grid) -> Result<(), Refusal> {
        let positive = || grid.stiffness_penalties.iter().filter(|b| b.get() > 0.0).copied();
        let smallest = positive().reduce(|a, b| if b < a { b } else { a });
        let largest = positive().reduce(|a, b| if b > a { b } else { a });
        for beta_s in [smallest, largest].into_iter().flatten() {
            for ratio in &grid.ratios {
                self.check(beta_s, *ratio)?;
            }
        }
        Ok(())
    }

    /// Refuses an engine that cannot hold the scene.
    ///
    /// # Errors
    /// The dense engines beyond [`MAX_DENSE_NODES`].
    pub fn check_engine(&self, engine: EngineName) -> Result<(), Refusal> {
        let nodes = self.scene.elements() + self.scene.bars().len();
        if engine.is_dense() && nodes > MAX_DENSE_NODES {
            let value = format!("{} with {nodes} nodes", engine.text());
            return Err(Refusal::new("--engine", value, format!("at most {MAX_DENSE_NODES} nodes, or auto")));
        }
        Ok(())
    }

    /// The engine called `name`. Engines that work on the pencil need it; without one, the closed form serves.
    pub fn engine<'a>(&self, name: EngineName, pencil: Option<&'a Pencil>) -> Box<dyn Engine + 'a> {
        let Some(pencil) = pencil else { return Box::new(ClosedForm::new(&self.scene, self.mass)) };
        match name {
            EngineName::Auto | EngineName::ClosedForm => Box::new(ClosedForm::new(&self.scene, self.mass)),
            EngineName::Secular => Box::new(Secular::new(pencil)),
            EngineName::Sturm => Box::new(Sturm::new(pencil)),
            EngineName::Dense => Box::new(Dense::new(pencil)),
            #[cfg(feature = "lapack")]
            EngineName::Lapack => Box::new(crate::spectrum::lapack::Lapack::new(pencil)),
        }
    }

    /// omega_e^2 of the reference element, rad^2/s^2: M_p = K_p/(r omega_e^2) for every contact.
    pub fn reference_eigenvalue(&self) -> f64 {
        self.reference_eigenvalue
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

    /// The critical step of an enclosed eigenvalue. Division and square root round three times, hence the margin.
    pub fn critical_step(&self, l: Enclosure) -> CriticalStep {
        let margin = 2.0 * f64::EPSILON;
        CriticalStep {
            omega_max: l.value.sqrt(),
            critical_courant: self.critical_courant(l.value),
            lower: self.critical_courant(l.upper) * (1.0 - margin),
            upper: self.critical_courant(l.lower) * (1.0 + margin),
        }
    }
}
