//! The charts of the tools, made of records only.

mod curve;
pub mod fields;
mod forces;
pub mod impacts;
mod levels;
mod maps;
pub mod meshes;
pub mod opening;
mod optimal;
pub mod precision;
pub mod studies;
mod units;
pub mod verification;

pub use forces::per_force;
pub use levels::{ContourLines, Level, interpolated_contours, levels};
pub use maps::{costs, curves, is_logarithmic, map, mass_family, titled_by_limit};
pub use optimal::optimal_ratio;
pub use units::{in_si, stiffness_in_si};
