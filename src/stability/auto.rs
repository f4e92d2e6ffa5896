//! The engine `auto`: the closed form, and where it certifies nothing, bisection on the assembled pencil.
//!
//! The closed form proves a value by two signs of its own function. Where many bars are alike, their eigenvalues lie
//! closer together than its rounding, and the signs contradict the value; the pivots of the pencil, whose backward error
//! does not grow with the number of contacts, still decide. The secular engine is not asked: it has the same backward
//! error with several contacts and 3.2 times that with one, so that it certifies nothing that Sturm's bisection does not.

use std::sync::OnceLock;

use super::ClosedForm;
use crate::fem::{MassMatrix, assemble, pencil_bytes};
use crate::memory;
use crate::pencil::{Penalty, Pencil};
use crate::scene::Scene;
use crate::spectrum::{Condensed, Enclosure, Engine, Sturm, Uncertified};

/// The engine `auto`, for every scene of uniform bars.
#[derive(Debug)]
pub struct Auto {
    closed_form: ClosedForm,
    scene: Scene,
    mass: MassMatrix,
    /// Assembled when a point needs it; `None` if the memory does not hold it.
    pencil: OnceLock<Option<Pencil>>,
}

impl Auto {
    /// The engine for `scene` with `mass`; assembles nothing.
    pub fn new(scene: &Scene, mass: MassMatrix) -> Self {
        let closed_form = ClosedForm::new(scene, mass);
        Self { closed_form, scene: scene.clone(), mass, pencil: OnceLock::new() }
    }

    fn pencil(&self) -> Option<&Pencil> {
        let assembled = || memory::fits(pencil_bytes(&self.scene)).then(|| assemble(&self.scene, self.mass));
        self.pencil.get_or_init(assembled).as_ref()
    }
}

impl Engine for Auto {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn enclose(&self, penalty: &Penalty, start: Option<f64>) -> Result<Enclosure, Uncertified> {
        self.enclose_by(penalty, start).0
    }

    fn enclose_by(
        &self,
        penalty: &Penalty,
        start: Option<f64>,
    ) -> (Result<Enclosure, Uncertified>, &'static str) {
        let first = self.closed_form.enclose_by(penalty, start);
        if first.0.is_ok() {
            return first;
        }
        match self.pencil().and_then(Pencil::chain) {
            Some(bars) => Sturm::new(bars).enclose_by(penalty, start),
            None => first,
        }
    }

    fn condensed(&self) -> Option<&dyn Condensed> {
        self.closed_form.condensed()
    }
}
