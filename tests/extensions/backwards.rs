//! An engine: elimination of the row from its right end to its left, and bisection on the sign of the last pivot.

use bipenalty::error::Refusal;
use bipenalty::pencil::{ChainPencil, Penalty, Pencil, Terms};
use bipenalty::spectrum::{Enclosure, Engine, Uncertified, bisect, certify, sturm_backward_error};

pub struct Backwards<'a>(ChainPencil<'a>);

impl<'a> Backwards<'a> {
    pub fn new(pencil: &'a Pencil) -> Result<Self, Refusal> {
        let chain = pencil.chain().ok_or_else(|| Refusal::new("engine", "right-to-left", "a row of bars"))?;
        Ok(Self(chain))
    }

    /// Whether K - l M with its contacts is negative definite.
    fn is_above(&self, terms: &[Terms], l: f64) -> bool {
        let (k, m) = (self.0.stiffness(), self.0.mass());
        let wall = |j: usize| terms[j].dynamic_stiffness(l) - l * terms[j].nodal_mass;
        let mut carried = 0.0;
        for (b, bar) in self.0.bars().iter().enumerate().rev() {
            // What the end of this bar meets: a wall, or the next bar behind a contact in series.
            if let Some(j) = bar.right.filter(|_| b + 1 == self.0.bars().len()) {
                carried = wall(j);
            }
            let mut pivot = f64::NEG_INFINITY;
            for i in bar.nodes.clone().rev() {
                let off = if i + 1 < bar.nodes.end { k.right(i) - l * m.right(i) } else { 0.0 };
                pivot =
                    k.diagonal[i] - l * m.diagonal[i] + std::mem::take(&mut carried) - off * (off / pivot);
                if i > bar.nodes.start && (pivot.is_nan() || pivot >= 0.0) {
                    return false;
                }
            }
            let Some(j) = bar.left else { return pivot < 0.0 };
            if b == 0 {
                return pivot + wall(j) < 0.0;
            }
            let (d, c) = (pivot - l * terms[j].nodal_mass, terms[j].dynamic_stiffness(l));
            if d + c >= 0.0 {
                return false;
            }
            carried = d * (c / (d + c)) - l * terms[j].nodal_mass;
        }
        true
    }
}

impl Engine for Backwards<'_> {
    fn name(&self) -> &'static str {
        "right-to-left"
    }

    fn enclose(&self, penalty: &Penalty, _: Option<f64>) -> Result<Enclosure, Uncertified> {
        let terms = self.0.terms(penalty);
        let (low, high) =
            (self.0.lower_bound(&terms) * (1.0 - 1e-12), self.0.upper_bound(&terms) * (1.0 + 1e-12));
        let (low, high) = bisect(low, high, |l| self.is_above(&terms, l));
        certify(Enclosure::from_bracket(low, high, sturm_backward_error(self.0, &terms, low)))
    }
}
