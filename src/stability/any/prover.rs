//! What proves the bounds of a mesh: the whole matrix where its factor fits, patches of elements where it does not.

use super::asking::{Asking, Prover};
use super::mesh::{MeshModel, Meshed};
use crate::convex::{self, Chance, Patches};
use crate::error::Refusal;
use crate::parts;

/// Edges of a patch in cells that leave a bound about 0.2 % too high: of squares (with contact) and of cubes.
const EDGES: [usize; 2] = [8, 6];

/// More entries of a factor than this are not even looked for, in multiples of n^(4/3), for meshes in space: nested
/// dissection leaves no fewer (George 1973; Lipton, Rose, Tarjan 1979), and to analyse the pattern takes memory too.
const LEAST_FILL: f64 = 4.0;

impl MeshModel {
    /// The prover for what is asked, and what to call it.
    pub(super) fn prover(&self, asking: &Asking) -> Result<(convex::Prover, Prover), Refusal> {
        let allowed = Self::allowed(asking);
        let whole =
            || convex::Prover::whole(self.pencil(), allowed).map(|prover| (prover, Prover::Factorisation));
        match (&self.meshed, asking.patch) {
            (Some(meshed), Some(edge)) => self.patches(meshed, edge, allowed),
            (Some(meshed), None) => {
                if self.may_fit(meshed, allowed)
                    && let Ok(prover) = whole()
                {
                    return Ok(prover);
                }
                let edge = EDGES[usize::from(meshed.elements.dimension == 3)];
                self.patches(meshed, edge, allowed)
            }
            (None, _) => whole().or_else(|refusal| match asking.limit.scheme() {
                // A bound below another bound would hide its probability.
                Some(_) => Err(refusal),
                None => self.chance(asking, refusal),
            }),
        }
    }

    /// Without elements and without the memory for a factor.
    fn chance(&self, asking: &Asking, refusal: Refusal) -> Result<(convex::Prover, Prover), Refusal> {
        if !self.pencil().mass().is_diagonal() {
            return Err(refusal);
        }
        let chance = Chance::new(self.pencil(), asking.tolerance.unwrap_or(Asking::MANY))?;
        let named = Prover::Chance { probability: chance.probability(), steps: chance.steps() };
        Ok((convex::Prover::Chance(Box::new(chance)), named))
    }

    /// Whether the factor of the whole matrix may fit: its least size is known before its pattern.
    fn may_fit(&self, meshed: &Meshed, allowed: usize) -> bool {
        let power = if meshed.elements.dimension == 3 { 4.0 / 3.0 } else { 1.0 };
        let entries = LEAST_FILL * (self.pencil().size() as f64).powf(power);
        entries * size_of::<f64>() as f64 <= allowed as f64
    }

    fn patches(
        &self,
        meshed: &Meshed,
        edge: usize,
        allowed: usize,
    ) -> Result<(convex::Prover, Prover), Refusal> {
        let elements = parts::elements(&meshed.elements)?;
        let patches = Patches::new(self.pencil(), &elements, &meshed.elements.patches(edge), allowed)?;
        let ((total, different), largest) = (patches.counts(), patches.largest());
        let named = Prover::Patches { edge, total, different, largest };
        Ok((convex::Prover::Patches(Box::new(patches)), named))
    }
}
