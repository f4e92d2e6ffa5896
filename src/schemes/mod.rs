//! Explicit time schemes with bi-penalty contact: one step each, on vectors, without allocation.
//!
//! A scheme knows matrices and contacts, never bars. The gaps and their rates are state of their own, advanced by
//! increments: where u is of size 1 and the penetration 1e-15, the difference of displacements has no digit left.
//! Sources: Kolman, Kopačka, González, Cho, Park, Math. Comput. Simulat. 189 (2021), 4.3 to 4.5 ("the paper"); Park, Lim,
//! Huh, Int. J. Numer. Meth. Eng. 91 (2012); Cho, Park, Huh, Comput. Mech. 52 (2013).
//!
//! ```
//! use bipenalty::schemes::{ContactSearch, Scheme};
//! // What distinguishes the schemes is one table.
//! assert_eq!(Scheme::Park.facts().search, ContactSearch::Predictor);
//! assert_eq!("central-difference".parse(), Ok(Scheme::CentralDifference));
//! ```

mod central_difference;
mod contact;
mod energy;
mod kernels;
mod operator;
mod park;
mod predictor_corrector;
mod stepper;
mod twisted;

use std::str::FromStr;

pub use contact::Contact;
pub use energy::Energy;
pub use stepper::{ContactRule, Park, Setup, State, Stepper};

use crate::error::Refusal;

/// An explicit time scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Central differences with M + M_p in the closed contact.
    CentralDifference,
    /// The stabilised predictor-corrector scheme of the paper.
    PredictorCorrector,
    /// The stabilised scheme of Park with pullback and averaging.
    Park,
}

/// When a scheme looks for contact, which is also the time of the force it reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactSearch {
    /// On the displacement at the start of the step.
    StartOfStep,
    /// On the predicted displacement at the end of the step.
    Predictor,
}

/// What is known of a scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// The name in records and on the command line.
    pub name: &'static str,
    /// The name in a chart.
    pub title: &'static str,
    /// Products M^-1 (f - K u) in a step.
    pub solves: usize,
    /// Order of accuracy in dt of a smooth contact-free motion as its records give it.
    pub order: usize,
    /// When contact is searched.
    pub search: ContactSearch,
    /// lambda, the reaction that enters the momentum balance.
    pub reaction: &'static str,
    /// The largest stable step while the contact is closed and nothing else limits it.
    pub closed_limit: &'static str,
    /// Where the scheme is defined.
    pub source: &'static str,
}

impl Scheme {
    /// Every scheme.
    pub const ALL: [Self; 3] = [Self::CentralDifference, Self::PredictorCorrector, Self::Park];

    /// The facts of this scheme. mu = Z'M^-1 Z, s' = s/(1 + m mu).
    pub const fn facts(self) -> Facts {
        match self {
            Self::CentralDifference => Facts {
                name: "central-difference",
                title: "central difference",
                solves: 1,
                order: 2,
                search: ContactSearch::StartOfStep,
                reaction: "(s g + m Z'M^-1 (f - K u))/(1 + m mu)",
                closed_limit: "2/omega_max of (K + K_p, M + M_p)",
                source: "Kolman et al. 2021, 4.3",
            },
            Self::PredictorCorrector => Facts {
                name: "predictor-corrector",
                title: "predictor-corrector",
                solves: 1,
                order: 1,
                search: ContactSearch::Predictor,
                reaction: "s g_pred/(1 + m mu)",
                closed_limit: "dt^2 s' mu = 1",
                source: "Kolman et al. 2021, 4.4",
            },
            Self::Park => Facts {
                name: "park",
                title: "Park",
                solves: 2,
                order: 2,
                search: ContactSearch::Predictor,
                reaction: "s g_pred/(1 + m mu)",
                closed_limit: "a zero of the scheme's characteristic function",
                source: "Park, Lim, Huh 2012; Cho, Park, Huh 2013; Kolman et al. 2021, 4.5",
            },
        }
    }

    /// The name in records and on the command line.
    pub const fn name(self) -> &'static str {
        self.facts().name
    }
}

impl FromStr for Scheme {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        Self::ALL
            .into_iter()
            .find(|scheme| scheme.name() == text)
            .ok_or_else(|| Refusal::new("scheme", format!("{text:?}"), Self::ALL.map(Self::name).join(", ")))
    }
}
