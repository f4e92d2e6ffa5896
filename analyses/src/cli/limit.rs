//! Whose limit: schemes, their parameters, damping, and the engine that finds it.

use clap::{Args, ValueEnum};

use crate::error::Refusal;
use bipenalty::damping::Damping;
use bipenalty::schemes::explicit::ExplicitName;
use bipenalty::schemes::{SchemeName, damped};
use bipenalty::stability::{AnyModel, Asking, EngineName, LimitOf};

/// Whose stability limit a map shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Limit {
    /// 2/omega_max of the penalised pencil
    Spectrum,
    /// The central difference scheme with closed contact: equal to the spectrum's
    CentralDifference,
    /// The predictor-corrector scheme with closed contact: dt^2 s' mu = 1
    PredictorCorrector,
    /// The Park scheme with closed contact and dt_c = 2/omega_max of the contact-free scene
    Park,
    /// The scheme of Noh and Bathe, two forces a step
    NohBathe,
    /// The scheme of Chung and Lee
    ChungLee,
    /// The scheme of Tchamwa and Wielgosz
    TchamwaWielgosz,
    /// The explicit generalised-alpha scheme of Hulbert and Chung
    GeneralisedAlpha,
}

impl Limit {
    /// The name in records, undamped.
    pub fn name(self) -> &'static str {
        match (self.explicit(), self.scheme()) {
            (Some(explicit), _) => explicit.name(),
            (_, Some(scheme)) => scheme.name(),
            _ if self == Self::CentralDifference => SchemeName::CentralDifference.name(),
            _ => "spectrum",
        }
    }

    /// Every scheme; the spectrum is none.
    pub const SCHEMES: [Self; 7] = [
        Self::CentralDifference,
        Self::PredictorCorrector,
        Self::Park,
        Self::NohBathe,
        Self::ChungLee,
        Self::TchamwaWielgosz,
        Self::GeneralisedAlpha,
    ];

    /// The scheme of this crate whose limit is not the spectrum's.
    pub fn scheme(self) -> Option<SchemeName> {
        match self {
            Self::PredictorCorrector => Some(SchemeName::PredictorCorrector),
            Self::Park => Some(SchemeName::Park),
            _ => None,
        }
    }

    /// The explicit scheme with the contact in its internal force.
    pub fn explicit(self) -> Option<ExplicitName> {
        match self {
            Self::NohBathe => Some(ExplicitName::NohBathe),
            Self::ChungLee => Some(ExplicitName::ChungLee),
            Self::TchamwaWielgosz => Some(ExplicitName::TchamwaWielgosz),
            Self::GeneralisedAlpha => Some(ExplicitName::GeneralisedAlpha),
            _ => None,
        }
    }
}

/// Whose limit, and what that depends on beside the scene.
#[derive(Debug, Clone, Copy, PartialEq, Args)]
pub struct LimitOptions {
    /// Whose limit to show
    #[arg(long, value_name = "NAME", default_value = "spectrum")]
    pub limit: Limit,
    /// Averaging of the Park scheme, in [0, 1] [default: 0.5]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub theta: Option<f64>,
    /// Parameter of --limit noh-bathe (p), chung-lee (beta), tchamwa-wielgosz (phi), generalised-alpha (rho) [default: as published]
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    pub parameter: Option<f64>,
    /// A of the damping C = A M + B K + C_c K_p, 1/s; velocities half a step behind [default: 0]
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    pub damping_mass: Option<f64>,
    /// B of the same, s [default: 0]
    #[arg(long, value_name = "B", allow_negative_numbers = true)]
    pub damping_stiffness: Option<f64>,
    /// C_c of the same, N s/m of a closed contact per N/m of its penalty [default: 0]
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    pub damping_contact: Option<f64>,
    /// auto, closed-form, secular, sturm, dense, or lapack where it is built in
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub engine: EngineName,
    /// Widest enclosure of a step, relative, for matrices and meshes [default: 1e-3 for a map, 1e-9 up to 64 points]
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub tolerance: Option<f64>,
    /// Elements along an edge of a patch, for the proof by patches of a mesh [default: chosen, see --explain]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub patch: Option<usize>,
}

impl LimitOptions {
    /// The limit with all that goes with it as usual.
    pub fn of(limit: Limit) -> Self {
        Self {
            limit,
            theta: None,
            parameter: None,
            damping_mass: None,
            damping_stiffness: None,
            damping_contact: None,
            engine: EngineName::Auto,
            tolerance: None,
            patch: None,
        }
    }

    /// What is asked of a model.
    ///
    /// # Errors
    /// A theta or a parameter out of range, or with a limit that has none; damping that is none, or of a scheme that has no
    /// derived limit with it.
    pub fn asking(&self) -> Result<Asking, Refusal> {
        let name = self.limit.name();
        if let Some(theta) = self.theta.filter(|_| self.limit != Limit::Park) {
            let allowed = format!("no theta with --limit {name}, or --limit park");
            return Err(Refusal::new("--theta", theta, allowed));
        }
        if let Some(parameter) = self.parameter.filter(|_| self.limit.explicit().is_none()) {
            let allowed = format!(
                "no parameter with --limit {name}, or --limit noh-bathe, chung-lee, tchamwa-wielgosz, generalised-alpha"
            );
            return Err(Refusal::new("--parameter", parameter, allowed));
        }
        let damping = self.damping()?;
        let limit = match (self.limit.explicit(), self.limit.scheme()) {
            (Some(explicit), _) if damping.is_none() => LimitOf::Explicit(explicit.with(self.parameter)?),
            (Some(_), _) => {
                let value = format!("{name} with damping, whose limit is not derived");
                let allowed =
                    "none with this scheme, or spectrum, central-difference and predictor-corrector with it";
                return Err(Refusal::new("damping", value, allowed));
            }
            (_, Some(scheme)) if damping.is_none() => {
                LimitOf::Scheme(scheme.with_theta(self.theta.unwrap_or(0.5))?)
            }
            (_, Some(scheme)) => LimitOf::Scheme(damped(scheme, damping)?),
            (_, None) if damping.is_none() => LimitOf::Spectrum,
            (_, None) => LimitOf::Damped(damping),
        };
        let Self { engine, tolerance, patch, .. } = *self;
        Ok(Asking { limit, engine, tolerance, patch, memory: None })
    }

    /// C as typed.
    fn damping(&self) -> Result<Damping, Refusal> {
        let part = |typed: Option<f64>| typed.unwrap_or(0.0);
        Damping::new(part(self.damping_mass), part(self.damping_stiffness), part(self.damping_contact))
    }

    /// Whose limit, as records name it.
    ///
    /// # Errors
    /// As [`LimitOptions::asking`].
    pub fn name(&self) -> Result<&'static str, Refusal> {
        // Central differences have the spectrum's limit, and say so by their name.
        Ok(match self.asking()?.limit {
            LimitOf::Spectrum => self.limit.name(),
            other => other.name(),
        })
    }

    /// Refuses what `model` has no such limit or no such engine for.
    ///
    /// # Errors
    /// As [`LimitOptions::asking`] and [`AnyModel::check`]; for bars also as [`Model::limit`](bipenalty::stability::Model::limit).
    pub fn check(&self, model: &AnyModel) -> Result<(), Refusal> {
        let asking = self.asking()?;
        model.check(&asking)?;
        match (model, asking.limit.scheme()) {
            (AnyModel::Bars(model), Some(scheme)) => model.limit(scheme, &model.pencil()).map(|_| ()),
            _ => Ok(()),
        }
    }
}
