//! Any mesh, any number of contacts: one convex function holds the whole map of critical steps.
//!
//! ```text
//! f(t) = l_max(K + t P, M)      P = sum_j w_j z_j z_j'
//! l_max(K + s P, M + m P) = l   exactly when   l = f(s - l m)      s = beta_s      m = beta_s/(r omega^2)
//! ```
//! since K + s P - l (M + m P) = K + (s - l m) P - l M. f is a maximum of Rayleigh quotients, each linear in t: convex, nondecreasing,
//! of slope at most mu = l_max(P, M). So a dozen eigenproblems bound it from below everywhere ([`subspace`]), a few dozen proven
//! points from above ([`upper`]), and every point of a map is enclosed by a scalar equation. M + m P never enters an eigensolver.

pub mod curve;
pub mod factor;
pub mod lanczos;
pub mod operator;
pub mod patches;
pub mod pencil;
mod point;
pub mod subspace;
pub mod upper;
mod vectors;

pub use curve::{Curve, Effort, Options, Prover};
pub use patches::{Elements, Patches};
pub use pencil::MeshPencil;
pub use point::{Asked, Enclosed, TooWide};
