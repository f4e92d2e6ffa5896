//! From eigenvalues to time steps: the critical step, grids of penalties, maps, contour lines, the optimal ratio.
//!
//! ```text
//! dt_cr = 2/omega_max      C_r = c0 dt_cr/h      l_max(K + K_p, M + M_p) <= max(l_max(K, M), r omega_e^2)
//! ```
//! The inequality, of mediants, is why r = l_max(K, M)/omega_e^2 costs no step at any beta_s. [`AnyModel`] is a scene of bars,
//! matrices or meshes with its masses, and [`Asking`] whose limit is wanted, by which engine and how closely. One point is
//! [`AnyModel::critical_step`], a [`Grid`] of them [`AnyModel::map`]; the other way round, [`AnyModel::largest_penalty`] and
//! [`AnyModel::largest_ratio`] tell what a time step in hand stands, and [`AnyModel::optimal_ratio`] what costs nothing.
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::penalty::PenaltyMass;
//! use bipenalty::stability::{AnyModel, AnyScene, Asking};
//! let scene = AnyScene::load("signorini")?;
//! let model = AnyModel::new(&scene, Some(MassMatrix::LUMPED), PenaltyMass::Consistent)?;
//! let asking = Asking::default();
//! let free = model.contact_free(&asking)?.step.ok().map(|step| step.lower);
//! // r = 1 keeps the contact-free limit, to rounding, however stiff the penalty; r = 4 comes to half of it.
//! let at = |ratio| Ok::<_, bipenalty::error::Error>(model.critical_step(1e8, ratio, &asking)?.step.ok().map(|step| step.lower));
//! assert!(at(1.0)? > free.map(|free| free * (1.0 - 1e-14)));
//! assert!(at(4.0)? < free.map(|free| 0.51 * free));
//! # Ok::<(), bipenalty::error::Error>(())
//! ```

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
    AnyModel, AnyScene, Asking, ContactShare, Governing, Largest, LimitOf, MeshModel, Plan, Prover, Work,
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
