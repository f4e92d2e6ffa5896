//! The engines and schemes of this crate against the suites that any of one's own would pass.

#![allow(clippy::unwrap_used)]

#[path = "common/conformance/mod.rs"]
#[macro_use]
mod conformance;

use bipenalty::schemes::{
    Buffered, CentralDifference, Lagrange, MassRedistribution, MoreauJean, PaoliSchatzman, Park,
    PredictorCorrector,
};
use bipenalty::spectrum::Dense;
use bipenalty::stability::EngineName;

engine_conformance! {
    sturm => |model, pencil| model.engine(EngineName::Sturm, pencil), 1e-14;
    secular => |model, pencil| model.engine(EngineName::Secular, pencil), 1e-14;
    closed_form => |model, pencil| model.engine(EngineName::ClosedForm, pencil), 1e-14;
    dense => |model, pencil| model.engine(EngineName::Dense, pencil), 1e-13;
    #[cfg(feature = "lapack")]
    lapack => |model, pencil| model.engine(EngineName::Lapack, pencil), 1e-13;
}

mesh_engine_conformance! {
    dense_of_meshes => |_, pencil| Ok(Box::new(Dense::new(pencil)?)), 1e-12;
}

scheme_conformance! {
    central_difference => CentralDifference;
    predictor_corrector => PredictorCorrector;
    park => Park::USUAL;
    park_without_pullback => Park::new(0.0).unwrap();
    buffered => Buffered;
    lagrange => Lagrange;
    moreau_jean => MoreauJean::USUAL;
    moreau_jean_with_restitution => MoreauJean::new(0.5).unwrap();
    paoli_schatzman => PaoliSchatzman::USUAL;
    mass_redistribution => MassRedistribution;
}
