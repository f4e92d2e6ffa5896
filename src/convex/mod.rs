//! Any mesh, any number of contacts: one convex function holds the whole map of critical steps.
//!
//! ```text
//! f(t) = l_max(K + t P, M)      P = sum_j w_j z_j z_j'
//! l_max(K + s P, M + m P) = l   exactly when   l = f(s - l m)      s = beta_s      m = beta_s/(r omega^2)
//! ```
//! since K + s P - l (M + m P) = K + (s - l m) P - l M. f is a maximum of Rayleigh quotients, each linear in t: convex, nondecreasing,
//! of slope at most mu = l_max(P, M). So a dozen eigenproblems bound it from below everywhere ([`span`]), a few dozen proven
//! points from above ([`upper`]), and every point of a map is enclosed by a scalar equation. M + m P never enters an eigensolver.
//!
//! ```
//! use bipenalty::convex::{Asked, Curve, MeshPencil, Options};
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::mesh::MeshScene;
//! use bipenalty::pencil::Matrix;
//! let text = r#"
//! name = "two-blocks"
//! dimension = 2
//! plane = "strain"
//! [[body]]
//! name = "lower"
//! box = [3.0, 2.0]
//! cells = [6, 4]
//! element = "quad4"
//! youngs_modulus = 210e9
//! poissons_ratio = 0.3
//! density = 7850.0
//! [[body]]
//! name = "upper"
//! box = [2.0, 1.0]
//! cells = [5, 3]
//! origin = [0.5, 2.0]
//! element = "quad4"
//! youngs_modulus = 70e9
//! poissons_ratio = 0.3
//! density = 2700.0
//! [[contact]]
//! surfaces = ["upper.bottom", "lower.top"]
//! [[hold]]
//! surface = "lower.bottom"
//! directions = ["x", "y"]
//! "#;
//! let assembled = MeshScene::parse(text, "two-blocks.toml")?.assemble(MassMatrix::LUMPED)?;
//! let gaps = assembled.gaps();
//! let pencil = MeshPencil::new(Matrix::Sparse(assembled.stiffness), assembled.mass, gaps)?;
//!
//! let mut curve = Curve::new(&pencil, Options::default())?;
//! let free = curve.mesh(); // omega^2 of the contact-free mesh, the reference of r
//! let ratios = [0.5, 1.0, 10.0, f64::INFINITY];
//! let map: Vec<Asked> = ratios.iter().map(|r| Asked::of(1e4, *r, free)).collect();
//! let steps = curve.enclose(&map).into_iter().collect::<Result<Vec<_>, _>>()?; // each within 1e-3
//! // r = 1 costs no time step; the pure penalty method divides it by more than ten.
//! assert!(steps[1].lower <= free * 1.002 && steps[3].lower > 100.0 * free);
//! assert!(steps.windows(2).all(|pair| pair[0].lower <= pair[1].upper));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chance;
mod closed;
pub mod curve;
mod dense;
mod elements;
pub mod factor;
mod gaps;
mod inverse;
pub mod lanczos;
mod narrow;
pub mod operator;
pub mod patches;
pub mod pencil;
mod point;
mod response;
mod ritz;
pub mod session;
pub mod sharing;
pub mod source;
pub mod span;
mod start;
pub mod subspace;
pub mod upper;
mod vectors;
pub mod whole;

pub use chance::Chance;
pub use closed::{Flexibilities, Given, Poles, Share};
pub use curve::{Curve, Effort, Options, Prover};
pub use inverse::Passing;
pub use patches::{Elements, Patches};
pub use pencil::MeshPencil;
pub use point::{Asked, Enclosed, TooWide};
pub use start::Start;
