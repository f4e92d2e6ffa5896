//! One part, ready to be asked.

use crate::convex::MeshPencil;
use crate::convex::factor::Verdict;
use crate::convex::patches::Patches;
use crate::convex::span::{Row, Sizes};
use crate::convex::subspace::Vectors;
use crate::error::Refusal;
use crate::parts::Share;

/// The pencil of one part, its patches, and what lies on it of the sampled vectors.
#[derive(Debug)]
pub struct Part {
    unknowns: Vec<u64>,
    pencil: MeshPencil,
    patches: Patches,
    sizes: Sizes,
    vectors: Vectors,
}

impl Part {
    /// The part of a share; a patch may take `memory` bytes.
    ///
    /// # Errors
    /// As [`Share::check`]; a mass that is not positive; a patch that needs more memory.
    pub fn new(share: Share, memory: usize) -> Result<Self, Refusal> {
        share.check()?;
        let groups = share.groups()?;
        let (stiffness, mass) = share.elements.assemble(share.unknowns.len());
        let contacts = groups.iter().flat_map(|(_, contacts)| contacts.iter().cloned()).collect();
        let pencil = MeshPencil::new(stiffness, mass, contacts)?;
        let patches = Patches::of(&pencil, &share.elements, &groups, memory)?;
        // The forms are of the elements as stored: an entry sums up those of its elements besides.
        let (rho_k, rho_m, count) = share.elements.sizes(pencil.mass_diagonal());
        let own = Sizes::of(&pencil);
        let room = 1.0 + (count + own.row + 64) as f64 * f64::EPSILON;
        let sizes = Sizes { rho: (rho_k * room, rho_m * room), row: own.row + count, ..own };
        Ok(Self { unknowns: share.unknowns, pencil, patches, sizes, vectors: Vectors::default() })
    }

    /// The unknowns by their numbers in the whole mesh, ascending.
    pub fn unknowns(&self) -> &[u64] {
        &self.unknowns
    }

    /// K, M and the contacts of the part.
    pub fn pencil(&self) -> &MeshPencil {
        &self.pencil
    }

    /// What bounds the rounding of its forms.
    pub fn sizes(&self) -> Sizes {
        self.sizes
    }

    /// Number of patches, and of those among them that differ; the unknowns of the largest.
    pub fn patches(&self) -> (usize, usize, usize) {
        let (total, distinct) = self.patches.counts();
        (total, distinct, self.patches.largest())
    }

    /// Adds its part of a vector to the sampled ones: see [`Vectors::add`].
    pub fn add(&mut self, x: &[f64], unknowns: usize, sum: &mut dyn FnMut(&mut [f64])) -> Option<Row> {
        self.vectors.add(&self.pencil, x, unknowns, sum)
    }

    /// Its part of V y.
    pub fn combine(&self, y: &[f64]) -> Vec<f64> {
        self.vectors.combine(y)
    }

    /// Whether u M - a K - t P of this part is positive semidefinite, patch by patch.
    pub fn prove(&self, u: f64, (a, t): (f64, f64), margin: f64) -> Verdict {
        self.patches.prove(u, a, t, margin)
    }
}
