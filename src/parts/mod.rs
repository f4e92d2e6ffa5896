//! A mesh in parts, one for each process: what each holds, proves and sums up by itself.
//!
//! K, M and P are sums over patches of elements, and every patch lies in one part, with the shares of the contacts that it
//! carries. So the largest eigenvalue is at most the largest of the patches, which each part proves alone, and every form
//! x'Kx is the sum of those of the parts, whose vectors share the unknowns between parts. No process needs more than its
//! part; the pencil that is enclosed is the sum of the matrices as the parts store them.
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::mesh::MeshScene;
//! use bipenalty::parts::{Part, split};
//! let text = r#"
//! name = "block"
//! dimension = 2
//! plane = "strain"
//! [[body]]
//! name = "block"
//! box = [2.0, 1.0]
//! cells = [8, 4]
//! element = "quad4"
//! youngs_modulus = 1.0
//! poissons_ratio = 0.3
//! density = 1.0
//! [[contact]]
//! surfaces = ["block.bottom", "wall"]
//! "#;
//! let scene = MeshScene::parse(text, "block.toml")?;
//! let (shares, elements) = split(&scene, MassMatrix::LUMPED, 2, 4)?;
//! let parts = shares.into_iter().map(|share| Part::new(share, 1 << 30)).collect::<Result<Vec<_>, _>>()?;
//! assert_eq!((parts.len(), elements), (2, 32));
//! assert!(parts.iter().all(|part| part.pencil().size() < 90 && part.patches().0 == 1));
//! # Ok::<(), bipenalty::error::Error>(())
//! ```

mod elements;
mod part;
mod share;
mod split;

pub use elements::elements;
pub use part::Part;
pub use share::Share;
pub use split::split;
