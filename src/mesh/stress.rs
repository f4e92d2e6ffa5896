//! The stress of every element of a mesh, and one number of it.

use rayon::prelude::*;

use super::assembly::{Elements, HELD};
use super::elasticity::mean_stress;
use crate::error::Refusal;

impl Elements {
    /// The mean stress of every element for u on the free degrees of freedom, Pa: xx, yy, zz, xy, yz, xz.
    ///
    /// # Errors
    /// A Jacobian determinant that is not positive, which assembling refuses first.
    pub fn stresses(&self, u: &[f64]) -> Result<Vec<[f64; 6]>, Refusal> {
        let of = |e: usize| {
            let body = self.body(e);
            let mesh = &self.bodies[body].mesh;
            let local = e - self.first[body].1;
            let held = |dof: &u32| if *dof == HELD { 0.0 } else { u[*dof as usize] };
            let own: Vec<f64> = self.dofs(e).iter().map(held).collect();
            let element = mesh.kind(local).element();
            mean_stress(element, &mesh.places(local), &self.bodies[body].material, self.plane, &own)
        };
        (0..self.len()).into_par_iter().map(of).collect()
    }
}

/// The equivalent stress of von Mises, Pa: (3 s:s/2)^(1/2) of the deviator s.
pub fn von_mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, xz] = stress;
    let square = |x: f64| x * x;
    let normal = square(xx - yy) + square(yy - zz) + square(zz - xx);
    (0.5 * normal + 3.0 * (square(*xy) + square(*yz) + square(*xz))).sqrt()
}
