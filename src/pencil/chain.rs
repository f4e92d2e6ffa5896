//! The row of bars in a pencil: what only a chain can do is asked of this type.
//!
//! K and M are tridiagonal, and every gap lies at the end of a bar: a node against a wall at an outer end of the row, or
//! the difference of two neighbours that no matrix couples. The bars are cut from the gaps once, here.

use std::ops::Range;

use super::blocks::{Blocks, inertia};
use super::{Gap, Penalty, Pencil, Terms, Tridiagonal};

/// Where a contact of a chain acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EndGap {
    /// One node against a rigid wall; the node is the first or the last.
    Wall {
        /// Index of the node.
        node: usize,
    },
    /// Node `left` against its right neighbour `left + 1`, which begins the next bar.
    Pair {
        /// Index of the left node.
        left: usize,
    },
}

impl EndGap {
    /// The one or two nodes of the contact.
    pub fn nodes(&self) -> impl Iterator<Item = usize> + use<> {
        match *self {
            Self::Wall { node } => node..node + 1,
            Self::Pair { left } => left..left + 2,
        }
    }

    fn of(gap: &Gap, size: usize) -> Option<Self> {
        match gap.column.0[..] {
            [(node, z)] if z.abs() == 1.0 && (node == 0 || node as usize + 1 == size) => {
                Some(Self::Wall { node: node as usize })
            }
            [(left, a), (right, b)] if a == -b && a.abs() == 1.0 && right == left + 1 => {
                Some(Self::Pair { left: left as usize })
            }
            _ => None,
        }
    }
}

/// What beta_s multiplies at one contact of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// w_j, N/m.
    pub stiffness: f64,
    /// Whether two nodes touch, rather than a node and a wall.
    pub pair: bool,
}

/// The rows of one bar and the contacts at its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct BarRows {
    /// The rows.
    pub nodes: Range<usize>,
    /// The contact at the first of them.
    pub left: Option<usize>,
    /// The contact at the last of them.
    pub right: Option<usize>,
}

/// What the gaps make of a row of bars.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cuts {
    gaps: Vec<EndGap>,
    scales: Vec<Scale>,
    bars: Vec<BarRows>,
    compliance: Vec<f64>,
    largest_free_node: f64,
    blocks: Blocks,
}

impl Cuts {
    /// `None` where a gap is not at the end of a bar, or the gaps do not run from left to right.
    pub(super) fn new(
        stiffness: &Tridiagonal,
        mass: &Tridiagonal,
        gaps: &[Gap],
        element_bound: f64,
    ) -> Option<Self> {
        let n = stiffness.diagonal.len();
        let ends: Vec<EndGap> = gaps.iter().map(|gap| EndGap::of(gap, n)).collect::<Option<_>>()?;
        let mut bars = vec![BarRows { nodes: 0..n, left: None, right: None }];
        for (contact, gap) in ends.iter().enumerate() {
            let last = bars.len() - 1;
            match *gap {
                EndGap::Wall { node: 0 } if contact == 0 && n > 1 => bars[0].left = Some(0),
                EndGap::Wall { node } if node + 1 == n && contact + 1 == ends.len() => {
                    bars[last].right = Some(contact);
                }
                EndGap::Wall { .. } => return None,
                EndGap::Pair { left } => {
                    let uncoupled = stiffness.off_diagonal[left] == 0.0 && mass.off_diagonal[left] == 0.0;
                    if !uncoupled || left < bars[last].nodes.start {
                        return None;
                    }
                    bars[last].nodes.end = left + 1;
                    bars[last].right = Some(contact);
                    bars.push(BarRows { nodes: left + 1..n, left: Some(contact), right: None });
                }
            }
        }
        let pair = |gap: &EndGap| matches!(gap, EndGap::Pair { .. });
        let scales = gaps.iter().zip(&ends).map(|(gap, end)| Scale { stiffness: gap.scale, pair: pair(end) });
        Some(Self {
            scales: scales.collect(),
            compliance: ends.iter().map(|gap| gap.nodes().map(|i| 1.0 / inertia(mass, i)).sum()).collect(),
            largest_free_node: largest_free_node(stiffness, mass, &ends),
            blocks: Blocks::new(stiffness, mass, &bars, element_bound),
            gaps: ends,
            bars,
        })
    }
}

/// The largest K_ii/M_ii over the nodes that no contact touches; 0 if there is none.
fn largest_free_node(stiffness: &Tridiagonal, mass: &Tridiagonal, gaps: &[EndGap]) -> f64 {
    let touched: Vec<usize> = gaps.iter().flat_map(EndGap::nodes).collect();
    let quotients = stiffness.diagonal.iter().zip(&mass.diagonal).map(|(k, m)| k / m).enumerate();
    // Gaps run from left to right, and so do their nodes.
    quotients
        .filter(|(i, _)| touched.binary_search(i).is_err())
        .map(|(_, quotient)| quotient)
        .fold(0.0, f64::max)
}

/// A pencil whose K and M are tridiagonal, with gaps at the ends of its bars; see [`Pencil::chain`].
#[derive(Debug, Clone, Copy)]
pub struct ChainPencil<'a> {
    pub(super) pencil: &'a Pencil,
    pub(super) stiffness: &'a Tridiagonal,
    pub(super) mass: &'a Tridiagonal,
    pub(super) cuts: &'a Cuts,
}

impl<'a> ChainPencil<'a> {
    /// Number of nodes n.
    pub fn size(&self) -> usize {
        self.stiffness.diagonal.len()
    }

    /// The pencil that this is a view of.
    pub fn pencil(&self) -> &'a Pencil {
        self.pencil
    }

    /// K, N/m.
    pub fn stiffness(&self) -> &'a Tridiagonal {
        self.stiffness
    }

    /// M, kg.
    pub fn mass(&self) -> &'a Tridiagonal {
        self.mass
    }

    /// The contacts from left to right.
    pub fn gaps(&self) -> &'a [EndGap] {
        &self.cuts.gaps
    }

    /// What beta_s multiplies at each contact.
    pub fn scales(&self) -> &'a [Scale] {
        &self.cuts.scales
    }

    /// The bars from left to right.
    pub fn bars(&self) -> &'a [BarRows] {
        &self.cuts.bars
    }

    /// mu_j = z_j' M^-1 z_j of every contact, 1/kg.
    pub fn compliance(&self) -> &'a [f64] {
        &self.cuts.compliance
    }

    /// s_j, m_j and d_j of every contact.
    pub fn terms(&self, penalty: &Penalty) -> Vec<Terms> {
        self.scales().iter().map(|scale| penalty.terms(*scale)).collect()
    }

    /// A number B with |K| <= B (M + M_p), rad^2/s^2: the element bound, or less where the mass penalty weighs down
    /// every node of the bars that reach it.
    pub fn stiffness_bound(&self, terms: &[Terms]) -> f64 {
        self.cuts.blocks.stiffness_bound(terms)
    }

    /// A bound of the contact stiffness relative to M + M_p, rad^2/s^2: the smaller of the sum
    /// over the contacts and of what each has against half of the mass of its bars.
    pub fn contact_bound(&self, terms: &[Terms]) -> f64 {
        contact_bound(self.compliance(), terms)
    }

    /// An upper bound of l_max of the pencil with contacts: the smaller of the mediant bound max(element bound, s/m) and
    /// the sum of the element and contact bounds (Weyl). With the diagonalised mass penalty s z z' <= s/d * diag(d), up
    /// to the factor 2 of a pair.
    pub fn upper_bound(&self, terms: &[Terms]) -> f64 {
        let ratio = |(scale, p): (&Scale, &Terms)| {
            let mass = p.mass + p.nodal_mass / if scale.pair { 2.0 } else { 1.0 };
            if p.stiffness == 0.0 { 0.0 } else { p.stiffness / mass }
        };
        let element_bound = self.pencil.bounds().stiffness;
        let mediant = self.scales().iter().zip(terms).map(ratio).fold(element_bound, f64::max);
        mediant.min(element_bound + self.contact_bound(terms))
    }

    /// A lower bound of l_max: the largest Rayleigh quotient of a single node, its contact included.
    pub fn lower_bound(&self, terms: &[Terms]) -> f64 {
        let (k, m) = (&self.stiffness.diagonal, &self.mass.diagonal);
        let touching =
            self.gaps().iter().zip(terms).flat_map(|(gap, p)| {
                gap.nodes().map(|i| (k[i] + p.stiffness) / (m[i] + p.mass + p.nodal_mass))
            });
        touching.fold(self.cuts.largest_free_node, f64::max)
    }
}

/// A bound of the contact stiffness of a chain relative to M + M_p, rad^2/s^2, from mu_j or more: the smaller of
///
/// ```text
/// sum_j s_j min(mu_j/(1 + m_j mu_j), 2/d_j)      max_j s_j min(2 mu_j/(1 + 2 m_j mu_j), 2/d_j)
/// ```
/// because z z' <= mu/(1 + m mu) (M + m z z') and z z' <= 2/d diag(d). A bar is touched by two contacts at most; for
/// the second, each of them has half of its mass, against which the compliance is 2 mu, and the parts add up to M at most.
fn contact_bound(compliance: &[f64], terms: &[Terms]) -> f64 {
    let halved = compliance.iter().zip(terms).map(|(mu, p)| contact_stiffness(2.0 * mu, p));
    halved.fold(0.0, f64::max).min(contact_sum(compliance, terms))
}

/// The first of the two: the sum over the contacts.
pub fn contact_sum(compliance: &[f64], terms: &[Terms]) -> f64 {
    compliance.iter().zip(terms).map(|(mu, p)| contact_stiffness(*mu, p)).sum()
}

fn contact_stiffness(mu: f64, p: &Terms) -> f64 {
    p.stiffness * (mu / (1.0 + p.mass * mu)).min(2.0 / p.nodal_mass)
}
