//! The inertia of a pencil with its contacts in double-double arithmetic: the judge of every engine.
//!
//! A contact c(l) = s - l m is not summed into K - l M, where s = 1e16 K would drown K, but bordered: with the contact
//! force as an unknown of its own the matrix [A z; z' -1/c] has the inertia of A + c z z' plus the sign of -1/c. Its
//! rows, a force between the two nodes it acts on, are again tridiagonal, and no entry is a sum of s with anything.
//! (The engines eliminate the contact as d c/(d + c) or sum it in gap coordinates: neither is used here.)

use bipenalty::pencil::{ChainPencil, EndGap, Penalty, Pencil, Terms};

use super::double_double::Dd;

/// Eigenvalues of K + K_p - l (M + M_p) above l, counted by the positive pivots of the bordered matrix.
///
/// Each entry takes at most 3 operations and each pivot 3 more, so the count is the exact one of an l that differs by
/// 6 * 16 * 2^-106 (3 l + B + C)/l relative, B and C the element and the contact bound: below 1e-28 for all the
/// scenes here ((B + C)/l < 100), that is 1e-14 of the rounding it judges.
pub fn count_above(pencil: &Pencil, penalty: &Penalty, l: Dd) -> usize {
    let chain = pencil.chain().unwrap();
    count_terms_above(chain, &chain.terms(penalty), l)
}

/// The same for contacts of any stiffness and mass.
pub fn count_terms_above(pencil: ChainPencil<'_>, terms: &[Terms], l: Dd) -> usize {
    let mut inertia = Inertia { l, pivot: None, positive: 0, negative_contacts: 0 };
    let (k, m) = (pencil.stiffness(), pencil.mass());
    let mut contacts = pencil.gaps().iter().zip(terms).peekable();
    if let Some((EndGap::Wall { node: 0 }, p)) = contacts.peek() {
        inertia.force(p);
        contacts.next();
    }
    for i in 0..pencil.size() {
        let mut nodal = Dd::from(0.0);
        for (gap, p) in pencil.gaps().iter().zip(terms) {
            if touches(gap, i) {
                nodal = nodal + Dd::from(p.nodal_mass);
            }
        }
        let mass = Dd::from(m.diagonal[i]) + nodal;
        let beside = match i {
            0 => Dd::from(0.0),
            i => Dd::from(k.off_diagonal[i - 1]) - l * Dd::from(m.off_diagonal[i - 1]),
        };
        inertia.node(Dd::from(k.diagonal[i]) - l * mass, beside);
        if let Some((gap, p)) = contacts.peek()
            && force_follows(gap, i)
        {
            inertia.force(p);
            contacts.next();
        }
    }
    assert!(contacts.next().is_none(), "a contact was not met in order");
    inertia.positive - inertia.negative_contacts
}

fn touches(gap: &EndGap, i: usize) -> bool {
    match *gap {
        EndGap::Wall { node } => node == i,
        EndGap::Pair { left } => left == i || left + 1 == i,
    }
}

fn force_follows(gap: &EndGap, i: usize) -> bool {
    matches!(*gap, EndGap::Wall { node } | EndGap::Pair { left: node } if node == i)
}

/// The last row that was eliminated.
#[derive(Clone, Copy)]
struct Pivot {
    value: Dd,
    is_force: bool,
}

struct Inertia {
    l: Dd,
    pivot: Option<Pivot>,
    positive: usize,
    negative_contacts: usize,
}

impl Inertia {
    /// Eliminates a node; `beside` couples it to the node before. Beside a contact force the coupling is 1.
    fn node(&mut self, diagonal: Dd, beside: Dd) {
        let value = match self.pivot {
            None => diagonal,
            Some(p) if p.is_force => {
                assert!(beside == Dd::from(0.0), "a contact and an element join the same two nodes");
                diagonal - Dd::from(1.0) / p.value
            }
            Some(p) => diagonal - beside * beside / p.value,
        };
        self.push(value, false);
    }

    /// Eliminates the force of a contact with its node before; c = 0 exerts none.
    fn force(&mut self, terms: &Terms) {
        let c = Dd::from(terms.stiffness) - self.l * Dd::from(terms.mass);
        if c == Dd::from(0.0) {
            return;
        }
        self.negative_contacts += usize::from(c < Dd::from(0.0));
        let diagonal = -(Dd::from(1.0) / c);
        let value = match self.pivot {
            None => diagonal,
            Some(p) => diagonal - Dd::from(1.0) / p.value,
        };
        self.push(value, true);
    }

    fn push(&mut self, value: Dd, is_force: bool) {
        // A vanishing pivot is moved by far less than the rounding of its row (Kahan 1966).
        let value = if value == Dd::from(0.0) { Dd::from(-1e-200) } else { value };
        assert!(value.hi.is_finite(), "the judge itself overflowed");
        self.positive += usize::from(value > Dd::from(0.0));
        self.pivot = Some(Pivot { value, is_force });
    }
}

/// Whether l_max lies in [lower, upper].
pub fn holds(pencil: &Pencil, penalties: &Penalty, lower: Dd, upper: Dd) -> bool {
    lower <= upper && count_above(pencil, penalties, lower) > 0 && count_above(pencil, penalties, upper) == 0
}

/// l_max relative to `value`, minus 1, by bisection to 1e-24; `None` if it is off by more than `reach`.
pub fn relative_error(pencil: &Pencil, penalties: &Penalty, value: f64, reach: f64) -> Option<f64> {
    let at = |e: f64| Dd::from(value) + Dd::from(value) * Dd::from(e);
    let (mut low, mut high) = (-reach, reach);
    if !holds(pencil, penalties, at(low), at(high)) {
        return None;
    }
    while high - low > 1e-20 {
        let middle = 0.5 * (low + high);
        if count_above(pencil, penalties, at(middle)) > 0 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}
