//! The schemes by the names that users type.

use std::str::FromStr;
use std::sync::Arc;

use super::{ChungLee, ExplicitFacts, ExplicitScheme, GeneralisedAlpha, NohBathe, TchamwaWielgosz};
use crate::error::Refusal;

/// An explicit scheme with the contact in its internal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExplicitName {
    /// [`NohBathe`].
    NohBathe,
    /// [`ChungLee`].
    ChungLee,
    /// [`TchamwaWielgosz`].
    TchamwaWielgosz,
    /// [`GeneralisedAlpha`].
    GeneralisedAlpha,
}

impl ExplicitName {
    /// Every scheme.
    pub const ALL: [Self; 4] =
        [Self::NohBathe, Self::ChungLee, Self::TchamwaWielgosz, Self::GeneralisedAlpha];

    /// What is known of it.
    pub fn facts(self) -> ExplicitFacts {
        match self {
            Self::NohBathe => NohBathe::FACTS,
            Self::ChungLee => ChungLee::FACTS,
            Self::TchamwaWielgosz => TchamwaWielgosz::FACTS,
            Self::GeneralisedAlpha => GeneralisedAlpha::FACTS,
        }
    }

    /// The name in records.
    pub fn name(self) -> &'static str {
        self.facts().name
    }

    /// The scheme with its parameter, the usual one for `None`.
    ///
    /// # Errors
    /// A parameter for which the limit is not proven.
    pub fn with(self, parameter: Option<f64>) -> Result<Arc<dyn ExplicitScheme>, Refusal> {
        let value = parameter.unwrap_or(self.facts().usual);
        Ok(match self {
            Self::NohBathe => Arc::new(NohBathe::new(value)?),
            Self::ChungLee => Arc::new(ChungLee::new(value)?),
            Self::TchamwaWielgosz => Arc::new(TchamwaWielgosz::new(value)?),
            Self::GeneralisedAlpha => Arc::new(GeneralisedAlpha::new(value)?),
        })
    }
}

impl FromStr for ExplicitName {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        let names = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|scheme| scheme.name() == text);
        found.ok_or_else(|| Refusal::new("limit", format!("{text:?}"), names()))
    }
}
