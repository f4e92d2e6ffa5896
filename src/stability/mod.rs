//! From eigenvalues to time steps: the critical step, grids of penalties, maps, contour lines, the optimal ratio.

mod closed_form;
mod grid;
mod map;
mod model;

pub use closed_form::{ClosedForm, UniformBar};
pub use grid::{Axis, Grid};
pub use map::{Curve, Point, map};
pub use model::{CriticalStep, EngineName, Model};
