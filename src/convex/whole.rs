//! Proofs by factorising the whole matrix: as it stands, and far below t = 0 in unknowns of which some are the gaps.
//!
//! For t < 0 the terms of -t P cancel in all that f(t) is made of, the modes that hold the gaps closed: as it stands a proof loses n
//! roundings of |t| mu. In the unknowns of `GapUnknowns` P stands at the gaps alone. Scaled there by
//! (1 + |t| p_ss/(u m_ss))^(-1/2), the matrix has entries of size u or less, and a proof loses n roundings of u, whatever t is.

use std::sync::OnceLock;

use super::factor::{Factorisation, TooLarge, Verdict};
use super::gaps::GapUnknowns;
use super::pencil::MeshPencil;

/// The part of a margin that roundings of t P may take before gaps are made unknowns.
const SHARE: f64 = 0.05;

/// What the rounding of K and M alone takes, times this, is tried first as the margin of all.
const ROOM: f64 = 8.0;

/// A pencil whose matrices are factorised.
#[derive(Debug)]
pub struct Whole {
    pencil: MeshPencil,
    allowed: usize,
    plain: Factorisation,
    /// Made where it is needed first; none where it cannot be made.
    gapped: OnceLock<Option<Box<Gapped>>>,
}

/// The pencil in unknowns of which some are gaps.
#[derive(Debug)]
struct Gapped {
    factorisation: Factorisation,
    /// What T'KT and T'MT are off by at most, scaled: parts of a and of u.
    lost: (f64, f64),
}

impl Whole {
    /// Analyses the pencil; a factor may take `allowed` bytes.
    ///
    /// # Errors
    /// It would take more.
    pub fn new(pencil: &MeshPencil, allowed: usize) -> Result<Self, TooLarge> {
        let plain = Factorisation::new(pencil, allowed)?;
        Ok(Self { pencil: pencil.clone(), allowed, plain, gapped: OnceLock::new() })
    }

    /// Bytes of the factor.
    pub fn memory(&self) -> usize {
        self.plain.memory()
    }

    /// Multiplications of a proof.
    pub fn operations(&self) -> f64 {
        self.plain.operations()
    }

    /// Whether u M - a K - t P is positive semidefinite; `margin` is the part of u that rounding may use.
    pub(super) fn prove(&self, u: f64, (a, t): (f64, f64), margin: f64) -> Verdict {
        let far = t < 0.0 && self.plain.penalty_rounding(t) > SHARE * margin * u;
        let gapped = || {
            let made = || Gapped::new(&self.pencil, self.allowed).map(Box::new);
            self.gapped.get_or_init(made).as_ref().map(|gapped| gapped.prove(u, (a, t), margin))
        };
        if far && let Some(verdict) = gapped() {
            return verdict;
        }
        let verdict = self.plain.prove(u, a, t, margin);
        match verdict {
            Verdict::TooClose(_) if t < 0.0 && !far => gapped().unwrap_or(verdict),
            _ => verdict,
        }
    }

    /// Whether M >= `share` diag(M)/2, with `margin` for rounding.
    pub(super) fn proves_mass(&self, share: f64, margin: f64) -> bool {
        self.plain.prove_beyond(1.0, (0.0, 0.0), margin, share) == Verdict::Proven
    }
}

impl Gapped {
    /// `None` where gaps do not make good unknowns, or the factor does not fit.
    fn new(pencil: &MeshPencil, allowed: usize) -> Option<Self> {
        let unknowns = GapUnknowns::new(pencil.contacts(), pencil.mass_diagonal())?;
        let (stiffness, mass) = (unknowns.congruent(pencil.stiffness()), unknowns.congruent(pencil.mass()));
        let gaps: Vec<_> = pencil.contacts().iter().map(|contact| unknowns.gap(contact)).collect();
        let factorisation = Factorisation::of((&stiffness.matrix, &mass.matrix), &gaps, allowed).ok()?;
        let scaling = factorisation.scaling();
        if !scaling.iter().all(|d| d.is_normal()) {
            return None;
        }
        // Doubling covers the rounding of the sums.
        let lost = |unit: f64, size: f64| 2.0 * unit * size;
        let lost = (
            lost(stiffness.unit, unknowns.size(pencil.stiffness(), scaling)),
            lost(mass.unit, unknowns.size(pencil.mass(), scaling)),
        );
        Some(Self { factorisation, lost })
    }

    /// With no more for rounding than it takes: in these unknowns M may be far from its diagonal, beside which margins count.
    fn prove(&self, u: f64, at: (f64, f64), margin: f64) -> Verdict {
        // A smaller scaling makes what is lost no larger.
        let beyond = 2.0 * (self.lost.0 * at.0.abs() + self.lost.1 * u);
        let prove = |margin: f64| self.factorisation.prove_scaled(u, at, margin, beyond);
        match prove(margin.min(ROOM * beyond / u)) {
            Verdict::TooClose(needed) if needed < margin => prove(margin.min(2.0 * needed)),
            verdict => verdict,
        }
    }
}
