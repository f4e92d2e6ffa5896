//! Who may take over the mass of nodes in contact.
//!
//! Element by element: what the lumped element has at nodes that carry a gap goes to its other nodes in proportion to what
//! they have of it, in each direction for itself. So each element keeps its mass, and a row of boxes that moves as a bar still
//! does: its next row of nodes becomes heavier everywhere by the same factor. An element without another node leaves its part to
//! the elements beside it.

use std::collections::BTreeMap;

use super::assembly::{Elements, HELD};
use crate::error::Refusal;
use crate::pencil::{Gap, Heirs};
use crate::sparse::SparseVector;

/// The parts of each heir of each unknown, kg.
type Parts = BTreeMap<u32, BTreeMap<u32, f64>>;

impl Elements {
    /// The heirs of the nodes in `gaps`.
    ///
    /// # Errors
    /// As [`Elements::matrices`].
    pub(crate) fn heirs(&self, gaps: &[Gap]) -> Result<Heirs, Refusal> {
        let in_contact = self.nodes_of(gaps);
        let mut parts = Parts::new();
        for (body, of) in self.bodies.iter().enumerate() {
            let first = self.first[body].0;
            for e in 0..of.mesh.elements() {
                let nodes = of.mesh.element(e);
                let touched: Vec<bool> =
                    nodes.iter().map(|node| in_contact[first + *node as usize]).collect();
                if touched.contains(&true) {
                    self.share(body, e, &touched, &mut parts)?;
                }
            }
        }
        let normal = |(unknown, parts): (u32, BTreeMap<u32, f64>)| {
            let sum: f64 = parts.values().sum();
            (unknown, SparseVector(parts.into_iter().map(|(heir, part)| (heir, part / sum)).collect()))
        };
        Ok(Heirs(parts.into_iter().map(normal).collect()))
    }

    /// Whether each node carries a gap.
    fn nodes_of(&self, gaps: &[Gap]) -> Vec<bool> {
        let mut touched = vec![false; self.unknowns()];
        let unknowns = gaps.iter().flat_map(|gap| &gap.column.0);
        unknowns.for_each(|(unknown, _)| touched[*unknown as usize] = true);
        let carries = |dof: &u32| *dof != HELD && touched[*dof as usize];
        self.dofs.chunks(self.dimension).map(|node| node.iter().any(carries)).collect()
    }

    /// Adds the parts of one element.
    fn share(&self, body: usize, e: usize, touched: &[bool], parts: &mut Parts) -> Result<(), Refusal> {
        let (d, nodes) = (self.dimension, self.bodies[body].mesh.element(e));
        let mass = self.lumped_masses(body, e)?;
        for i in 0..d {
            let dof = |a: usize| self.dofs[(self.first[body].0 + nodes[a] as usize) * d + i];
            let free = |kind: bool| {
                (0..nodes.len()).filter(move |a| touched[*a] == kind).filter(|a| dof(*a) != HELD)
            };
            let total: f64 = free(false).map(|b| mass[b]).sum();
            for a in free(true) {
                let heirs = parts.entry(dof(a)).or_default();
                free(false).for_each(|b| *heirs.entry(dof(b)).or_default() += mass[a] * mass[b] / total);
            }
        }
        Ok(())
    }
}
