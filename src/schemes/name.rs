//! The schemes of this crate by the names that users type.

use std::str::FromStr;
use std::sync::Arc;

use super::{
    Buffered, CentralDifference, Facts, Lagrange, MassRedistribution, MoreauJean, PaoliSchatzman, Park,
    PredictorCorrector, Scheme,
};
use crate::error::Refusal;

/// A scheme of this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SchemeName {
    /// [`CentralDifference`].
    CentralDifference,
    /// [`PredictorCorrector`].
    PredictorCorrector,
    /// [`Park`].
    Park,
    /// [`Buffered`].
    Buffered,
    /// [`Lagrange`].
    Lagrange,
    /// [`MoreauJean`].
    MoreauJean,
    /// [`PaoliSchatzman`].
    PaoliSchatzman,
    /// [`MassRedistribution`].
    MassRedistribution,
}

impl SchemeName {
    /// The schemes of the paper.
    pub const PAPER: [Self; 3] = [Self::CentralDifference, Self::PredictorCorrector, Self::Park];

    /// Every scheme.
    pub const ALL: [Self; 8] = [
        Self::CentralDifference,
        Self::PredictorCorrector,
        Self::Park,
        Self::Buffered,
        Self::Lagrange,
        Self::MoreauJean,
        Self::PaoliSchatzman,
        Self::MassRedistribution,
    ];

    /// The scheme with its usual parameters.
    pub fn scheme(self) -> &'static dyn Scheme {
        match self {
            Self::CentralDifference => &CentralDifference,
            Self::PredictorCorrector => &PredictorCorrector,
            Self::Park => &Park::USUAL,
            Self::Buffered => &Buffered,
            Self::Lagrange => &Lagrange,
            Self::MoreauJean => &MoreauJean::USUAL,
            Self::PaoliSchatzman => &PaoliSchatzman::USUAL,
            Self::MassRedistribution => &MassRedistribution,
        }
    }

    /// The facts of this scheme.
    pub fn facts(self) -> Facts {
        self.scheme().facts()
    }

    /// The name in records.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// The scheme; `theta` is the averaging of [`Park`], which the others do not have.
    ///
    /// # Errors
    /// As [`Park::new`].
    pub fn with_theta(self, theta: f64) -> Result<Arc<dyn Scheme>, Refusal> {
        Ok(match self {
            Self::Park => Arc::new(Park::new(theta)?),
            other => other.into(),
        })
    }
}

impl From<SchemeName> for Arc<dyn Scheme> {
    fn from(name: SchemeName) -> Self {
        match name {
            SchemeName::CentralDifference => Arc::new(CentralDifference),
            SchemeName::PredictorCorrector => Arc::new(PredictorCorrector),
            SchemeName::Park => Arc::new(Park::USUAL),
            SchemeName::Buffered => Arc::new(Buffered),
            SchemeName::Lagrange => Arc::new(Lagrange),
            SchemeName::MoreauJean => Arc::new(MoreauJean::USUAL),
            SchemeName::PaoliSchatzman => Arc::new(PaoliSchatzman::USUAL),
            SchemeName::MassRedistribution => Arc::new(MassRedistribution),
        }
    }
}

impl FromStr for SchemeName {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        let names = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|scheme| scheme.name() == text);
        found.ok_or_else(|| {
            Refusal::new("scheme", format!("{text:?}"), names()).suggesting(text, Self::ALL.map(Self::name))
        })
    }
}
