//! The charts of the tools, made of records only.

mod curve;
pub mod impacts;
mod maps;
pub mod meshes;
pub mod opening;
pub mod precision;
mod units;
pub mod verification;

pub use maps::{
    ContourLines, costs, curves, interpolated_contours, is_logarithmic, levels, map, mass_family,
    optimal_ratio, titled_by_limit,
};
pub use units::in_si;
