//! Elastic bodies in the plane and in space, meshed by boxes or by Gmsh, in node-to-face contact: K, M and the gaps.
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::mesh::MeshScene;
//! let text = r#"
//! name = "block"
//! dimension = 2
//! plane = "strain"
//! [[body]]
//! name = "block"
//! box = [2.0, 1.0]
//! cells = [4, 2]
//! element = "quad4"
//! youngs_modulus = 1.0
//! poissons_ratio = 0.3
//! density = 1.0
//! [[contact]]
//! surfaces = ["block.bottom", "wall"]
//! "#;
//! let scene = MeshScene::parse(text, "block.toml")?;
//! let assembled = scene.assemble(MassMatrix::LUMPED)?;
//! assert_eq!((assembled.stiffness.rows(), assembled.contacts.len()), (30, 5));
//! # Ok::<(), bipenalty::error::Error>(())
//! ```

// The indices of loops are those of the formulas.
#![allow(clippy::needless_range_loop)]

pub mod assembly;
mod contact;
pub mod elasticity;
pub mod element;
mod file;
pub mod gmsh;
mod heirs;
mod partition;
mod row;
mod scene;
mod stress;
pub mod structured;
pub mod topology;
mod vtu;

pub use assembly::{Body, Elements, HELD};
pub use scene::{Assembled, BodySource, MeshImpact, MeshScene, Opponent, Place, SurfaceContact, SurfaceName};
pub use stress::von_mises;
pub use vtu::{Field, write_pvd};
