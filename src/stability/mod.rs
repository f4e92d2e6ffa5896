//! From eigenvalues to time steps: the critical step, grids of penalties, maps, contour lines, the optimal ratio.

mod any;
mod auto;
mod band;
mod closed_form;
mod contour;
mod grid;
mod map;
mod model;
mod optimal_ratio;
mod uniform_bar;

pub use any::{
    AnyModel, AnyScene, Asking, ContactShare, Governing, Largest, LimitOf, MeshModel, Plan, Prover,
    eigenvalue, with_limit,
};
pub use auto::Auto;
pub use closed_form::ClosedForm;
pub use contour::{contour, scheme_contour};
pub use grid::{Grid, Sweep};
pub use map::{Curve, MapPoint, map};
pub use model::{CriticalStep, EngineName, Model};
pub use optimal_ratio::{
    Expectation, OptimalRatio, check_has_contact, governing_bar, optimal_ratio, optimal_scheme_ratio,
};
pub use uniform_bar::UniformBar;
