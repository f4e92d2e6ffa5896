//! Which unknowns may take over the mass of nodes in contact.

use crate::sparse::SparseVector;

/// The unknowns of nodes that carry a gap, all directions of each, ascending; each with shares, not negative and of the sum 1,
/// of unknowns of the same body and direction whose nodes carry none. Empty shares where the mesh has no such unknown beside
/// the node.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Heirs(pub Vec<(u32, SparseVector)>);
