//! What is asked of a model, and what will be done for it.

use std::sync::Arc;

use crate::damping::Damping;
use crate::error::Refusal;
use crate::schemes::explicit::ExplicitScheme;
use crate::schemes::{DampedCentralDifference, Scheme, SchemeName};
use crate::stability::EngineName;

/// Whose limit of the time step.
#[derive(Debug, Clone, Default)]
pub enum LimitOf {
    /// 2/omega_max of the penalised pencil.
    #[default]
    Spectrum,
    /// A scheme with its parameters, contacts closed.
    Scheme(Arc<dyn Scheme>),
    /// Central differences damped by C, the velocity half a step behind.
    Damped(Damping),
    /// Another explicit scheme, the contact in its internal force: the step of the spectrum times a number.
    Explicit(ExplicitScheme),
}

impl LimitOf {
    /// The name in records.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Spectrum => "spectrum",
            Self::Scheme(scheme) => scheme.facts().name,
            Self::Damped(damping) => DampedCentralDifference::new(*damping).facts().name,
            Self::Explicit(scheme) => scheme.facts().name,
        }
    }

    /// Whether it is 2/omega_max of the penalised pencil.
    pub fn is_spectrum(&self) -> bool {
        match self {
            Self::Spectrum => true,
            Self::Scheme(_) => self.scheme().is_none(),
            Self::Damped(_) | Self::Explicit(_) => false,
        }
    }

    /// The scheme whose limit is no function of the spectrum's.
    pub fn scheme(&self) -> Option<&dyn Scheme> {
        match self {
            Self::Scheme(scheme) if scheme.facts().name != SchemeName::CentralDifference.name() => {
                Some(&**scheme)
            }
            Self::Spectrum | Self::Scheme(_) | Self::Damped(_) | Self::Explicit(_) => None,
        }
    }
}

impl From<SchemeName> for LimitOf {
    fn from(name: SchemeName) -> Self {
        Self::Scheme(name.into())
    }
}

/// What is asked, beside the points.
#[derive(Debug, Clone, Default)]
pub struct Asking {
    /// Whose limit.
    pub limit: LimitOf,
    /// What finds it; of matrices and meshes `auto` alone, which is the convex curve.
    pub engine: EngineName,
    /// The widest enclosure of a step, relative; by default [`Asking::FEW`] where up to 64 points are asked and
    /// [`Asking::MANY`] for more. Bars are always enclosed to 1e-13.
    pub tolerance: Option<f64>,
    /// Elements along an edge of a patch, for the proof by patches; chosen where there is none.
    pub patch: Option<usize>,
    /// Bytes that one factor may take; by default what the machine has left.
    pub memory: Option<u64>,
}

/// Up to this many points are enclosed to [`Asking::FEW`].
const FEW_POINTS: usize = 64;

impl Asking {
    /// The width of a few points.
    pub const FEW: f64 = 1e-9;
    /// The width of a map.
    pub const MANY: f64 = 1e-3;

    /// The width that an enclosure by patches may have where no width is asked for: they are too high by what they are too
    /// small. A step that is not known to a factor of 2 is none; single elements with contact come near that.
    pub const BY_PATCHES: f64 = 1.0;

    /// The width asked for at each of `points` points.
    pub fn width(&self, points: usize) -> f64 {
        self.tolerance.unwrap_or(if points <= FEW_POINTS { Self::FEW } else { Self::MANY })
    }

    /// The same of the spectrum.
    pub(super) fn of_spectrum(&self) -> Self {
        Self { limit: LimitOf::Spectrum, ..self.clone() }
    }

    /// Refuses values that mean nothing.
    ///
    /// # Errors
    /// A tolerance outside of 1e-13, the rounding of a step, to 1; a patch of no element.
    pub fn check(&self) -> Result<(), Refusal> {
        if let Some(tolerance) = self.tolerance.filter(|e| !(NARROWEST..=1.0).contains(e)) {
            return Err(Refusal::new("tolerance", tolerance, format!("a number from {NARROWEST:e} to 1")));
        }
        match self.patch {
            Some(0) => Err(Refusal::new("patch", 0, "at least 1 element along an edge")),
            _ => Ok(()),
        }
    }
}

/// The narrowest enclosure of a step that can be asked for: the certificates of bars reach no further.
const NARROWEST: f64 = 1e-13;

/// What proves a bound of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prover {
    /// A sparse Cholesky factorisation of the whole matrix.
    Factorisation,
    /// Small Cholesky factorisations of patches of elements.
    Patches {
        /// Elements along an edge of a patch.
        edge: usize,
        /// Patches.
        total: usize,
        /// Of them those that differ, and are factorised.
        different: usize,
        /// Unknowns of the largest.
        largest: usize,
    },
    /// Nothing: Lanczos from a random start, with a probability of being wrong.
    Chance {
        /// That probability, for each search.
        probability: f64,
        /// Steps of each search.
        steps: usize,
    },
}

/// What a whole matrix takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Multiplications of a factorisation.
    pub operations: f64,
    /// Entries of the factor.
    pub factor: usize,
    /// Entries of K.
    pub stiffness: usize,
}

/// What will be computed for an [`Asking`] and a number of points, before it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Unknowns n.
    pub unknowns: usize,
    /// Contacts.
    pub contacts: usize,
    /// Elements, where the scene has them.
    pub elements: Option<usize>,
    /// Points asked for.
    pub points: usize,
    /// The width each is enclosed to, relative; `None` where the bound itself decides.
    pub tolerance: Option<f64>,
    /// The engine of the rows.
    pub engine: &'static str,
    /// What proves; `None` for bars, whose engines prove each point as they find it.
    pub prover: Option<Prover>,
    /// About how many eigenproblems of n unknowns are solved.
    pub eigenproblems: usize,
    /// About how many bounds are proven.
    pub proofs: usize,
    /// About how many flexibilities of all contacts are computed; 0 where the limit takes none.
    pub flexibilities: usize,
    /// What one proof and one product take; `None` unless a whole matrix is factorised.
    pub work: Option<Work>,
    /// Bytes that it takes at most: the matrices, the vectors and one factor; `None` where nothing is assembled.
    pub memory: Option<u64>,
}
