//! A bound of the stiffness of a chain, as far as the mass penalty can outweigh the bars' own mass.

use super::{BarRows, Terms, Tridiagonal, last_pivot};

/// The bars of a chain by what bounds their stiffness.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Blocks {
    /// |K| <= element_bound M.
    element_bound: f64,
    /// The same for the bars of three or more nodes: an inner node bears no mass penalty.
    long: f64,
    short: Vec<ShortBlock>,
}

/// A bar of one or two nodes: K and M as (K_11, K_12, K_22), and what its ends touch.
#[derive(Debug, Clone, PartialEq)]
struct ShortBlock {
    stiffness: [f64; 3],
    mass: [f64; 3],
    two_nodes: bool,
    left: Option<Touch>,
    right: Option<Touch>,
}

/// A contact by its index, and 1/(e' M^-1 e) of the node on its other side, kg; infinite for a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Touch {
    contact: usize,
    partner: f64,
}

impl Touch {
    /// A mass D, kg, with which the contact weighs at least on the node: m (u_a - u_b)^2 + mu u_b^2 >= D u_a^2 for
    /// any u_b, with D = m mu/(m + mu), the two masses in series.
    fn mass(&self, terms: &[Terms]) -> f64 {
        let p = &terms[self.contact];
        let partner = self.partner + p.nodal_mass;
        let series = if partner.is_finite() { p.mass * (partner / (p.mass + partner)) } else { p.mass };
        p.nodal_mass + series
    }
}

impl Blocks {
    pub(super) fn new(
        stiffness: &Tridiagonal,
        mass: &Tridiagonal,
        bars: &[BarRows],
        element_bound: f64,
    ) -> Self {
        let mut blocks = Self { element_bound, long: 0.0, short: Vec::new() };
        for (i, bar) in bars.iter().enumerate() {
            let (first, last) = (bar.nodes.start, bar.nodes.end - 1);
            if last > first + 1 {
                blocks.long = blocks.long.max(dominance_bound(stiffness, mass, first..last + 1));
                continue;
            }
            let entries = |a: &Tridiagonal| match first == last {
                true => [a.diagonal[first], 0.0, 0.0],
                false => [a.diagonal[first], a.off_diagonal[first], a.diagonal[last]],
            };
            // A contact at an outer end of the row is a wall.
            let partner = |outer: bool, node: usize| if outer { f64::INFINITY } else { inertia(mass, node) };
            let touch = |contact: Option<usize>, outer: bool, node: usize| {
                contact.map(|contact| Touch { contact, partner: partner(outer, node) })
            };
            blocks.short.push(ShortBlock {
                stiffness: entries(stiffness),
                mass: entries(mass),
                two_nodes: first < last,
                left: touch(bar.left, i == 0, first.wrapping_sub(1)),
                right: touch(bar.right, i + 1 == bars.len(), last + 1),
            });
        }
        blocks
    }

    /// min(element bound, long bars + sum of the short bars): |K| <= B (M + M_p), because each bar alone obeys it.
    pub(super) fn stiffness_bound(&self, terms: &[Terms]) -> f64 {
        let short: f64 = self.short.iter().map(|block| block.stiffness_bound(terms)).sum();
        self.element_bound.min(self.long + short)
    }
}

impl ShortBlock {
    /// trace((M + D)^-1 |K|), D the masses of the contacts: at least the largest eigenvalue.
    fn stiffness_bound(&self, terms: &[Terms]) -> f64 {
        let weight = |touch: &Option<Touch>| touch.as_ref().map_or(0.0, |touch| touch.mass(terms));
        let (left, right) = (weight(&self.left), weight(&self.right));
        let ([k1, k12, k2], [m1, m12, m2]) = (self.stiffness, self.mass);
        if !self.two_nodes {
            return k1 / (m1 + left + right);
        }
        let (m1, m2) = (m1 + left, m2 + right);
        // Divided through by m1 m2, which may leave the range of f64.
        let coupling = (m12 / m1) * (m12 / m2);
        (k1 / m1 + k2 / m2 + 2.0 * (k12 / m1).abs() * (m12 / m2).abs()) / (1.0 - coupling)
    }
}

/// 2 max_i K_ii/(M_ii - sum |M_ij|) over `rows`: |K| <= 2 diag(K), and M exceeds the diagonal that its dominance
/// leaves. Equal to the largest element eigenvalue for uniform bars; infinite if M is not dominant.
fn dominance_bound(stiffness: &Tridiagonal, mass: &Tridiagonal, rows: std::ops::Range<usize>) -> f64 {
    let quotient = |i: usize| {
        let rest = mass.diagonal[i] - mass.left(i).abs() - mass.right(i).abs();
        if rest > 0.0 { 2.0 * stiffness.diagonal[i] / rest } else { f64::INFINITY }
    };
    rows.map(quotient).fold(0.0, f64::max)
}

/// 1/(e' M^-1 e) of a node that ends its bar, kg: the last pivot of the elimination of its bar towards it.
pub(super) fn inertia(mass: &Tridiagonal, node: usize) -> f64 {
    let coupled = |i: usize| mass.off_diagonal[i] != 0.0;
    let row = |i: usize, off: usize| (mass.diagonal[i], mass.off_diagonal[off]);
    let n = mass.diagonal.len();
    let towards = if node > 0 && coupled(node - 1) {
        let first = (0..node).rev().take_while(|i| coupled(*i)).last().unwrap_or(node);
        last_pivot(mass.diagonal[first], (first + 1..=node).map(|i| row(i, i - 1)), |_, _| true)
    } else if node + 1 < n && coupled(node) {
        let last = (node..n - 1).take_while(|i| coupled(*i)).last().unwrap_or(node) + 1;
        last_pivot(mass.diagonal[last], (node..last).rev().map(|i| row(i, i)), |_, _| true)
    } else {
        None
    };
    towards.unwrap_or(mass.diagonal[node])
}
