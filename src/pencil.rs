//! The meeting point of elements and eigenvalue engines: a symmetric pencil with rank-one contact terms.
//!
//! ```text
//! K + sum_j s_j z_j z_j'  -  l (M + sum_j m_j z_j z_j')            l = omega^2
//! ```
//! K and M (n x n, positive semidefinite and definite) are tridiagonal; the bars are uncoupled blocks. z_j is the
//! gap of contact j: one node against a wall, or the difference of two neighbouring nodes. The contact terms are
//! kept apart from K and M: summed, `K_nn + s` would lose K at s = 1e16 K, and a map needs K and M only once.

/// A symmetric tridiagonal matrix, n x n.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tridiagonal {
    /// The n diagonal entries.
    pub diagonal: Vec<f64>,
    /// The n - 1 entries beside the diagonal.
    pub off_diagonal: Vec<f64>,
}

impl Tridiagonal {
    /// y = A x, with x and y of length n.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        let n = self.diagonal.len();
        for i in 0..n {
            let left = if i > 0 { self.off_diagonal[i - 1] * x[i - 1] } else { 0.0 };
            let right = if i + 1 < n { self.off_diagonal[i] * x[i + 1] } else { 0.0 };
            y[i] = left + self.diagonal[i] * x[i] + right;
        }
    }
}

/// Where a contact acts: the column z of the gap Z'u. Its sign does not matter to the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gap {
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

/// The contact terms of one contact: what its closing adds to the pencil.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Penalty {
    /// s, N/m, multiplies z z' in the stiffness.
    pub stiffness: f64,
    /// m, kg, multiplies z z' in the mass.
    pub mass: f64,
    /// d, kg, added to the mass of each node of the contact: the diagonalised mass penalty.
    pub nodal_mass: f64,
}

impl Penalty {
    /// c(l) = s - l m, the dynamic stiffness of the contact.
    #[inline]
    pub fn dynamic_stiffness(&self, l: f64) -> f64 {
        self.stiffness - l * self.mass
    }
}

/// The contact-free pencil (K, M), the gaps of its contacts, and a bound of its spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Pencil {
    stiffness: Tridiagonal,
    mass: Tridiagonal,
    gaps: Vec<Gap>,
    element_bound: f64,
    compliance: Vec<f64>,
    largest_node: f64,
    blocks: Blocks,
}

impl Pencil {
    /// A pencil of matrices of equal size n >= 1.
    ///
    /// `gaps` run from left to right. `element_bound` is a number with |K| <= bound * M (entries of K in absolute
    /// value), such as the largest element eigenvalue; it bounds the contact-free spectrum from above.
    pub fn new(stiffness: Tridiagonal, mass: Tridiagonal, gaps: Vec<Gap>, element_bound: f64) -> Self {
        let compliance = gaps.iter().map(|gap| contact_compliance(&mass, *gap)).collect();
        let largest_node = largest_free_node(&stiffness, &mass, &gaps);
        let blocks = Blocks::new(&stiffness, &mass, &gaps, element_bound);
        Self { stiffness, mass, gaps, element_bound, compliance, largest_node, blocks }
    }

    /// Number of nodes n.
    pub fn size(&self) -> usize {
        self.stiffness.diagonal.len()
    }

    /// K, N/m.
    pub fn stiffness(&self) -> &Tridiagonal {
        &self.stiffness
    }

    /// M, kg.
    pub fn mass(&self) -> &Tridiagonal {
        &self.mass
    }

    /// The gaps of the contacts from left to right.
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// A bound of |K| relative to M, rad^2/s^2: no contact-free eigenvalue exceeds it.
    pub fn element_bound(&self) -> f64 {
        self.element_bound
    }

    /// A number B with |K| <= B (M + M_p), rad^2/s^2: the element bound, or less where the mass penalty weighs down
    /// every node of the bars that reach it.
    pub fn stiffness_bound(&self, penalties: &[Penalty]) -> f64 {
        self.blocks.stiffness_bound(penalties)
    }

    /// mu_j = z_j' M^-1 z_j of every contact, 1/kg.
    pub fn compliance(&self) -> &[f64] {
        &self.compliance
    }

    /// A bound of the contact stiffness relative to M + M_p, rad^2/s^2: the smaller of
    ///
    /// ```text
    /// sum_j s_j min(mu_j/(1 + m_j mu_j), 2/d_j)      max_j s_j min(2 mu_j/(1 + 2 m_j mu_j), 2/d_j)
    /// ```
    /// because z z' <= mu/(1 + m mu) (M + m z z') and z z' <= 2/d diag(d). A bar is touched by two contacts at most; for
    /// the second, each of them has half of its mass, against which the compliance is 2 mu, and the parts add up to M at most.
    pub fn contact_bound(&self, penalties: &[Penalty]) -> f64 {
        let term = |mu: f64, p: &Penalty| p.stiffness * (mu / (1.0 + p.mass * mu)).min(2.0 / p.nodal_mass);
        let contacts = || self.compliance.iter().zip(penalties);
        let sum: f64 = contacts().map(|(mu, p)| term(*mu, p)).sum();
        contacts().map(|(mu, p)| term(2.0 * mu, p)).fold(0.0, f64::max).min(sum)
    }

    /// An upper bound of l_max of the pencil with `penalties`: the smaller of the mediant bound
    /// max(element bound, s/m) and the sum of the element and contact bounds (Weyl). With the diagonalised mass
    /// penalty s z z' <= s/d * diag(d), up to the factor 2 of a pair.
    pub fn upper_bound(&self, penalties: &[Penalty]) -> f64 {
        let ratio = |(gap, p): (&Gap, &Penalty)| {
            let norm = if matches!(gap, Gap::Pair { .. }) { 2.0 } else { 1.0 };
            let mass = p.mass + p.nodal_mass / norm;
            if p.stiffness == 0.0 { 0.0 } else { p.stiffness / mass }
        };
        let mediant = self.gaps.iter().zip(penalties).map(ratio).fold(self.element_bound, f64::max);
        mediant.min(self.element_bound + self.contact_bound(penalties))
    }

    /// A lower bound of l_max: the largest Rayleigh quotient of a single node, its contact included.
    pub fn lower_bound(&self, penalties: &[Penalty]) -> f64 {
        let (k, m) = (&self.stiffness.diagonal, &self.mass.diagonal);
        let touching =
            self.gaps.iter().zip(penalties).flat_map(|(gap, p)| {
                gap.nodes().map(|i| (k[i] + p.stiffness) / (m[i] + p.mass + p.nodal_mass))
            });
        touching.fold(self.largest_node, f64::max)
    }
}

/// The largest K_ii/M_ii over the nodes that no contact touches; 0 if there is none.
fn largest_free_node(stiffness: &Tridiagonal, mass: &Tridiagonal, gaps: &[Gap]) -> f64 {
    let touched: Vec<usize> = gaps.iter().flat_map(Gap::nodes).collect();
    let quotients = stiffness.diagonal.iter().zip(&mass.diagonal).map(|(k, m)| k / m).enumerate();
    quotients.filter(|(i, _)| !touched.contains(i)).map(|(_, quotient)| quotient).fold(0.0, f64::max)
}

impl Gap {
    /// The one or two nodes of the contact.
    pub fn nodes(&self) -> impl Iterator<Item = usize> + use<> {
        match *self {
            Gap::Wall { node } => node..node + 1,
            Gap::Pair { left } => left..left + 2,
        }
    }
}

/// The bars of a pencil, as far as the mass penalty can outweigh their own mass.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blocks {
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
    fn mass(&self, penalties: &[Penalty]) -> f64 {
        let p = &penalties[self.contact];
        let partner = self.partner + p.nodal_mass;
        let series = if partner.is_finite() { p.mass * (partner / (p.mass + partner)) } else { p.mass };
        p.nodal_mass + series
    }
}

impl Blocks {
    pub(crate) fn new(stiffness: &Tridiagonal, mass: &Tridiagonal, gaps: &[Gap], element_bound: f64) -> Self {
        let n = stiffness.diagonal.len();
        let pair = |gap: &Gap| if let Gap::Pair { left } = *gap { Some(left + 1) } else { None };
        let mut cuts: Vec<usize> = std::iter::once(0).chain(gaps.iter().filter_map(pair)).collect();
        cuts.push(n);
        let touch = |node: usize, on_left: bool| {
            let here = |gap: &Gap| match *gap {
                Gap::Wall { node: at } => (at == node && (at == 0) == on_left).then_some(f64::INFINITY),
                Gap::Pair { left } if on_left => (left + 1 == node).then(|| inertia(mass, left)),
                Gap::Pair { left } => (left == node).then(|| inertia(mass, left + 1)),
            };
            let mut touching = gaps.iter().map(here).enumerate();
            touching.find_map(|(contact, partner)| Some(Touch { contact, partner: partner? }))
        };
        let mut blocks = Self { element_bound, long: 0.0, short: Vec::new() };
        for cut in cuts.windows(2) {
            let (first, last) = (cut[0], cut[1] - 1);
            if last > first + 1 {
                blocks.long = blocks.long.max(dominance_bound(stiffness, mass, first..last + 1));
                continue;
            }
            let entries = |a: &Tridiagonal| match first == last {
                true => [a.diagonal[first], 0.0, 0.0],
                false => [a.diagonal[first], a.off_diagonal[first], a.diagonal[last]],
            };
            blocks.short.push(ShortBlock {
                stiffness: entries(stiffness),
                mass: entries(mass),
                two_nodes: first < last,
                left: touch(first, true),
                right: touch(last, false),
            });
        }
        blocks
    }

    /// min(element bound, long bars + sum of the short bars): |K| <= B (M + M_p), because each bar alone obeys it.
    pub(crate) fn stiffness_bound(&self, penalties: &[Penalty]) -> f64 {
        let short: f64 = self.short.iter().map(|block| block.stiffness_bound(penalties)).sum();
        self.element_bound.min(self.long + short)
    }
}

impl ShortBlock {
    /// trace((M + D)^-1 |K|), D the masses of the contacts: at least the largest eigenvalue.
    fn stiffness_bound(&self, penalties: &[Penalty]) -> f64 {
        let weight = |touch: &Option<Touch>| touch.as_ref().map_or(0.0, |touch| touch.mass(penalties));
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
    let beside = |i: usize| mass.off_diagonal.get(i).map_or(0.0, |off| off.abs());
    let quotient = |i: usize| {
        let left = if i > 0 { beside(i - 1) } else { 0.0 };
        let rest = mass.diagonal[i] - left - beside(i);
        if rest > 0.0 { 2.0 * stiffness.diagonal[i] / rest } else { f64::INFINITY }
    };
    rows.map(quotient).fold(0.0, f64::max)
}

/// z' M^-1 z. M does not couple bars, so each node of the gap contributes its own.
fn contact_compliance(mass: &Tridiagonal, gap: Gap) -> f64 {
    gap.nodes().map(|node| 1.0 / inertia(mass, node)).sum()
}

/// 1/(e' M^-1 e) of a node that ends its bar, kg: the last pivot of the elimination of its bar towards it.
fn inertia(mass: &Tridiagonal, node: usize) -> f64 {
    let coupled = |i: usize| mass.off_diagonal[i] != 0.0;
    let step = |pivot: f64, i: usize, off: usize| {
        mass.diagonal[i] - mass.off_diagonal[off] * (mass.off_diagonal[off] / pivot)
    };
    let n = mass.diagonal.len();
    if node > 0 && coupled(node - 1) {
        let first = (0..node).rev().take_while(|i| coupled(*i)).last().unwrap_or(node);
        return (first + 1..=node).fold(mass.diagonal[first], |p, i| step(p, i, i - 1));
    }
    if node + 1 < n && coupled(node) {
        let last = (node..n - 1).take_while(|i| coupled(*i)).last().unwrap_or(node) + 1;
        return (node..last).rev().fold(mass.diagonal[last], |p, i| step(p, i, i));
    }
    mass.diagonal[node]
}
