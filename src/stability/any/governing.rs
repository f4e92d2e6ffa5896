//! Who governs the step: where the critical mode has its energy.
//!
//! At l = f(t), t = s - l m, the mode x obeys (K + t P) x = l M x. What the contacts hold of it is x'Px, contact by contact;
//! what moves is x'Mx, body by body; what is strained is x_e'K_e x_e, element by element.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;

use rayon::prelude::*;

use super::AnyModel;
use super::asking::{Asking, LimitOf};
use super::curve::step;
use super::mesh::MeshModel;
use crate::convex::Asked;
use crate::error::{Refusal, Result};
use crate::mesh::{Field, HELD, Place};
use crate::penalty::{Ratio, StiffnessPenalty};
use crate::pencil::Matrix;
use crate::spectrum::Enclosure;
use crate::stability::Model;

/// Elements that are named.
const NAMED: usize = 10;

/// The part of a contact in x'Px.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactShare {
    /// Its number, from 0.
    pub contact: usize,
    /// x'P_j x/x'Px.
    pub share: f64,
    /// Where it is, where there is a mesh.
    pub place: Option<Place>,
}

impl fmt::Display for ContactShare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "contact {}", self.contact + 1)?;
        if let Some(place) = &self.place {
            write!(f, " {place}")?;
        }
        write!(f, ": {:.1} %", 100.0 * self.share)
    }
}

/// The critical mode of a point, and what has a part in it. Where several modes have nearly the same frequency, as in
/// contacts that are alike, it is one of many.
#[derive(Debug, Clone, PartialEq)]
pub struct Governing {
    /// l of the point, rad^2/s^2.
    pub l: Enclosure,
    /// beta_s x'Px/x'(K + beta_s P)x: what of the elastic energy is in the contacts.
    pub contact_energy: f64,
    /// All contacts, the largest share first; empty where the mode moves no gap.
    pub contacts: Vec<ContactShare>,
    /// The name of each body and its part of the kinetic energy; empty for matrices.
    pub bodies: Vec<(String, f64)>,
    /// The elements with the largest parts of x'Kx, numbered over all bodies from 0, the largest first; empty for
    /// matrices.
    pub elements: Vec<(usize, f64)>,
    /// x on the unknowns, x'Mx = 1 up to rounding.
    pub mode: Vec<f64>,
    /// Part of each element in x'Kx; empty for matrices.
    strain: Vec<f64>,
}

impl AnyModel {
    /// What governs the step of the spectrum at a point.
    ///
    /// # Errors
    /// As [`AnyModel::map`]; the limit of a scheme that is not the spectrum's; a limit that could not be enclosed.
    pub fn governs(&self, beta_s: f64, ratio: f64, asking: &Asking) -> Result<Governing> {
        self.check(asking)?;
        if asking.limit.scheme().is_some() || matches!(asking.limit, LimitOf::Damped(_)) {
            let allowed = "spectrum or central-difference, undamped, whose limit has a mode";
            return Err(Refusal::new("limit", asking.limit.name(), allowed).into());
        }
        let point = (StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?);
        match self {
            Self::Mesh(model) => model.governs(point, asking),
            Self::Bars(model) => as_matrices(model)?
                .governs(point, &Asking { tolerance: asking.tolerance, ..Asking::default() }),
        }
    }

    /// Writes the mesh with a mode (`mode`) and the parts of the elements in its strain energy (`strain_energy`) for ParaView.
    ///
    /// # Errors
    /// A model without a mesh; what the writer reports, as a refusal of `place`.
    pub fn write_mode(
        &self,
        governing: &Governing,
        out: &mut dyn std::io::Write,
        place: &str,
    ) -> Result<(), Refusal> {
        let mesh = match self {
            Self::Mesh(model) => model.mesh(),
            Self::Bars(_) => None,
        };
        let Some(mesh) = mesh else {
            let value = format!("vtu of scene {}", self.name());
            return Err(Refusal::new("format", value, "a scene of [[body]], which has a mesh"));
        };
        let fields = [
            ("mode", Field::Displacement(&governing.mode)),
            ("strain_energy", Field::Cells(&governing.strain)),
        ];
        mesh.write_vtu(out, &fields)
            .map_err(|error| Refusal::new(place, error, "a place that can be written"))
    }
}

/// Bars as what the curve takes.
fn as_matrices(model: &Model) -> Result<MeshModel, Refusal> {
    model.check_pencil()?;
    let pencil = model.pencil();
    let gaps = pencil.gaps().iter().map(|gap| gap.column.clone()).collect();
    let scales: Vec<f64> = pencil.gaps().iter().map(|gap| gap.scale).collect();
    let (stiffness, mass): (Matrix, Matrix) = (pencil.stiffness().clone(), pencil.mass().clone());
    MeshModel::from_matrices(stiffness, mass, gaps, &scales, Some(pencil.reference()))
}

impl MeshModel {
    fn governs(&self, (beta_s, ratio): (StiffnessPenalty, Ratio), asking: &Asking) -> Result<Governing> {
        let asked = Asked::of(beta_s.get(), ratio.get(), self.reference()?);
        let found = self.with_curve(asking, |curve| {
            let found = curve.enclose_to(&[asked], asking.width(1)).into_iter().next();
            Ok(found.map(|found| {
                let l = step(found, asking, curve.prover())?.l;
                Ok((l, curve.mode(asked.stiffness - l.value * asked.mass)))
            }))
        })?;
        let none = Refusal::new("point", "none", "one");
        let (l, mode) = found.ok_or(none)?.map_err(|wide: crate::spectrum::Uncertified| wide)?;
        let held: Vec<f64> =
            self.pencil().contacts().iter().map(|c| c.scale * c.column.dot(&mode).powi(2)).collect();
        let (all, (own, _)) = (held.iter().sum::<f64>(), self.pencil().quotients(&mode));
        let share = |(contact, held): (usize, &f64)| ContactShare {
            contact,
            share: held / all,
            place: self.places().map(|places| places[contact].clone()),
        };
        let mut contacts: Vec<ContactShare> =
            if all > 0.0 { held.iter().enumerate().map(share).collect() } else { Vec::new() };
        contacts.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.contact.cmp(&b.contact)));
        let strain = self.strain(&mode)?;
        let mut elements: Vec<(usize, f64)> = strain.iter().copied().enumerate().collect();
        elements.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        elements.truncate(NAMED);
        let sprung = asked.stiffness * all;
        Ok(Governing {
            l,
            contact_energy: if sprung > 0.0 { sprung / (own + sprung) } else { 0.0 },
            contacts,
            bodies: self.kinetic(&mode),
            elements,
            mode,
            strain,
        })
    }

    /// The name and the part of each body in x'Mx; M couples none.
    fn kinetic(&self, mode: &[f64]) -> Vec<(String, f64)> {
        let Some(mesh) = self.mesh() else { return Vec::new() };
        let mut image = vec![0.0; mode.len()];
        self.pencil().multiply_mass(mode, &mut image);
        let all: f64 = mode.iter().zip(&image).map(|(x, y)| x * y).sum();
        let of = |(body, ends): (usize, &[(usize, usize)])| {
            let dofs = &mesh.dofs[ends[0].0 * mesh.dimension..ends[1].0 * mesh.dimension];
            let free = dofs.iter().filter(|dof| **dof != HELD).map(|dof| *dof as usize);
            (mesh.bodies[body].name.clone(), free.map(|i| mode[i] * image[i]).sum::<f64>() / all)
        };
        mesh.first.windows(2).enumerate().map(of).collect()
    }

    /// The part of each element in x'Kx.
    fn strain(&self, mode: &[f64]) -> Result<Vec<f64>, Refusal> {
        let Some(mesh) = self.mesh() else { return Ok(Vec::new()) };
        // The matrices of translates once; those of other elements are made where they are used.
        let mut alike: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for e in (0..mesh.len())
            .map(|e| (e, mesh.alike(e)))
            .filter(|(e, alike)| e != alike)
            .map(|(_, alike)| alike)
        {
            if let Entry::Vacant(entry) = alike.entry(e) {
                entry.insert(mesh.matrices(e)?.0);
            }
        }
        let energy = |e: usize| {
            let own;
            let k = match alike.get(&mesh.alike(e)) {
                Some(k) => k,
                None => {
                    own = mesh.matrices(e)?.0;
                    &own
                }
            };
            let x: Vec<f64> =
                mesh.dofs(e).iter().map(|dof| if *dof == HELD { 0.0 } else { mode[*dof as usize] }).collect();
            let row = |i: usize| x.iter().zip(&k[i * x.len()..]).map(|(x, k)| k * x).sum::<f64>();
            Ok((0..x.len()).map(|i| x[i] * row(i)).sum::<f64>())
        };
        let mut strain: Vec<f64> =
            (0..mesh.len()).into_par_iter().map(energy).collect::<Result<_, Refusal>>()?;
        let all: f64 = strain.iter().sum();
        strain.iter_mut().for_each(|part| *part = if all > 0.0 { *part / all } else { 0.0 });
        Ok(strain)
    }
}
