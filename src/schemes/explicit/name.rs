//! The schemes by the names that users type.

use std::str::FromStr;

use super::{ExplicitFacts, ExplicitScheme, chung_lee, generalised_alpha, noh_bathe, tchamwa_wielgosz};
use crate::error::Refusal;

/// An explicit scheme with the contact in its internal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExplicitName {
    /// The scheme of Noh and Bathe, two forces a step.
    NohBathe,
    /// The scheme of Chung and Lee; beta = 1 does not damp.
    ChungLee,
    /// The scheme of Tchamwa and Wielgosz; phi = 1 does not damp.
    TchamwaWielgosz,
    /// The explicit generalised-alpha scheme of Hulbert and Chung, without damping.
    GeneralisedAlpha,
}

impl ExplicitName {
    /// Every scheme.
    pub const ALL: [Self; 4] =
        [Self::NohBathe, Self::ChungLee, Self::TchamwaWielgosz, Self::GeneralisedAlpha];

    /// What is known of it.
    pub fn facts(self) -> &'static ExplicitFacts {
        match self {
            Self::NohBathe => &noh_bathe::FACTS,
            Self::ChungLee => &chung_lee::FACTS,
            Self::TchamwaWielgosz => &tchamwa_wielgosz::FACTS,
            Self::GeneralisedAlpha => &generalised_alpha::FACTS,
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
    pub fn with(self, parameter: Option<f64>) -> Result<ExplicitScheme, Refusal> {
        ExplicitScheme::new(self.facts(), parameter.unwrap_or(self.facts().usual))
    }
}

impl FromStr for ExplicitName {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        let names = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|scheme| scheme.name() == text);
        found.ok_or_else(|| {
            Refusal::new("limit", format!("{text:?}"), names()).suggesting(text, Self::ALL.map(Self::name))
        })
    }
}
