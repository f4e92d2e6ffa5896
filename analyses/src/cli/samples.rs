//! Rows that are drawn again, held against what can be computed anew: a few of each model that is built in.

use std::collections::BTreeSet;
use std::fmt::Display;

use clap::ValueEnum;

use super::{Limit, LimitOptions};
use crate::error::Result;
use crate::record::{Check, CostRow, Number, OptimalRatioRow, Origin, StabilityRow};
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::scene::built_in;
use bipenalty::stability::{AnyModel, Asking, Model};

/// Rows of each model that are computed again, the first and the last among them.
const SAMPLES: usize = 5;
/// Elements of the largest model that is: a redraw takes no time worth waiting for.
const MOST_ELEMENTS: usize = 10_000;

/// How many rows were computed again and agree, what the first that does not says, and why others were not.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples {
    /// Rows computed again.
    pub rows: usize,
    /// Rows whose enclosure meets that of the new computation.
    pub agree: usize,
    /// The first that does not.
    pub differs: Option<String>,
    /// Why rows could not be computed again.
    pub unknown: BTreeSet<String>,
}

/// What a row says, and what it needs to be computed again.
pub(super) struct Claim<'a> {
    scene: &'a str,
    mass: &'a str,
    gamma: Option<Number>,
    elements: Option<usize>,
    limit: &'static str,
    /// Of a scheme, where the row has it.
    parameter: Option<Number>,
    beta_s: f64,
    /// r of a limit; an optimal ratio has none.
    ratio: Option<f64>,
    /// The enclosure.
    bounds: Option<(Number, Number)>,
}

impl Claim<'_> {
    fn is_of_the_model_of(&self, other: &Self) -> bool {
        let key = |claim: &Self| (claim.elements, claim.limit, claim.parameter);
        (self.scene, self.mass) == (other.scene, other.mass) && key(self) == key(other)
    }
}

/// What rows of one kind claim: all kinds name these columns alike but for the two that are given.
macro_rules! claims {
    ($rows:ty, parameter: $parameter:expr, ratio: $ratio:expr) => {
        impl<'a> From<&'a $rows> for Claim<'a> {
            fn from(row: &'a $rows) -> Self {
                let (parameter, ratio): (fn(&$rows) -> Option<Number>, fn(&$rows) -> Option<f64>) =
                    ($parameter, $ratio);
                Self {
                    scene: &row.scene,
                    mass: &row.mass,
                    gamma: row.gamma,
                    elements: row.elements,
                    limit: row.limit,
                    parameter: parameter(row),
                    beta_s: row.stiffness_penalty.0,
                    ratio: ratio(row),
                    bounds: row.lower.zip(row.upper),
                }
            }
        }
    };
}

claims!(StabilityRow, parameter: |_| None, ratio: |row| Some(row.ratio.0));
claims!(CostRow, parameter: |row| row.parameter, ratio: |row| Some(row.ratio.0));
claims!(OptimalRatioRow, parameter: |_| None, ratio: |_| None);

impl Samples {
    /// The rows of a file from the run `origin`.
    pub(super) fn of<'a, R: 'a>(rows: &'a [R], origin: &Origin) -> Self
    where
        Claim<'a>: From<&'a R>,
    {
        let claims: Vec<Claim> = rows.iter().map(Claim::from).collect();
        let mut samples = Self::default();
        for claims in claims.chunk_by(Claim::is_of_the_model_of) {
            if let Err(why) = samples.add(claims, origin) {
                samples.unknown.insert(why);
            }
        }
        samples
    }

    /// What the record of a figure says of them.
    pub(super) fn check(&self) -> Check {
        Check { check: "agrees with samples computed again".to_owned(), rows: self.rows, holds: self.agree }
    }

    /// The rows of several files.
    pub(super) fn joined(mut self, other: Self) -> Self {
        self.rows += other.rows;
        self.agree += other.agree;
        self.differs = self.differs.or(other.differs);
        self.unknown.extend(other.unknown);
        self
    }

    /// The rows of one model; why not, if they cannot be computed again.
    fn add(&mut self, claims: &[Claim], origin: &Origin) -> std::result::Result<(), String> {
        let Some(first) = claims.first() else { return Ok(()) };
        let settings = Settings::of(first, origin)?;
        let model = settings.model(first)?;
        let asking = settings.limit.asking().map_err(|refusal| refusal.to_string())?;
        let last = claims.len() - 1;
        let chosen: BTreeSet<usize> = (0..SAMPLES).map(|i| i * last / (SAMPLES - 1)).collect();
        for claim in chosen.into_iter().map(|index| &claims[index]) {
            let Some((lower, upper)) = claim.bounds else { continue };
            let found = anew(&model, claim, &asking).map_err(|refusal| refusal.to_string())?;
            let Some((low, high)) = found else { continue };
            let meets = lower.0 <= high && low <= upper.0;
            if !meets && !settings.is_known {
                return Err(format!(
                    "the run of scene {} is not known, and with the usual settings it would have left other rows",
                    claim.scene
                ));
            }
            self.rows += 1;
            self.agree += usize::from(meets);
            if !meets && self.differs.is_none() {
                let ratio = claim.ratio.map_or(String::new(), |r| format!(", r = {r}"));
                self.differs = Some(format!(
                    "{} {}, {}, beta_s = {}{ratio}: the row has {} to {}, computed again {low} to {high}",
                    claim.scene, claim.mass, claim.limit, claim.beta_s, lower.0, upper.0
                ));
            }
        }
        Ok(())
    }
}

/// How the rows of a model were computed, as far as the record tells, and as usual for the rest.
struct Settings {
    limit: LimitOptions,
    penalty_mass: PenaltyMass,
    /// Whether the run is known and its scene is the built-in one.
    is_known: bool,
}

impl Settings {
    fn of(claim: &Claim, origin: &Origin) -> std::result::Result<Self, String> {
        let limit = Limit::value_variants().iter().find(|limit| limit.name() == claim.limit);
        let limit = *limit.ok_or_else(|| format!("the damping of {} is not in the rows", claim.limit))?;
        let command = origin.command();
        let words: Vec<&str> = command.unwrap_or_default().split([' ', '=']).collect();
        let after = |option: &str| {
            let place = words.iter().position(|word| *word == option);
            place.and_then(|place| words.get(place + 1).copied())
        };
        let number = |option: &str| after(option).and_then(|text| text.parse::<f64>().ok());
        let parameter = claim.parameter.map(|parameter| parameter.0);
        let theta = (limit == Limit::Park).then(|| parameter.or(number("--theta")).unwrap_or(0.5));
        let parameter = limit.explicit().and_then(|_| parameter.or(number("--parameter")));
        let diagonalised = after("--penalty-mass").is_some_and(|form| form == "diagonalised");
        let of_file = words.iter().any(|word| word.ends_with(".toml"));
        Ok(Self {
            limit: LimitOptions { theta, parameter, ..LimitOptions::of(limit) },
            penalty_mass: if diagonalised { PenaltyMass::Diagonalised } else { PenaltyMass::Consistent },
            is_known: command.is_some() && !of_file,
        })
    }

    /// The built-in scene of the rows with as many elements.
    fn model(&self, claim: &Claim) -> std::result::Result<AnyModel, String> {
        let unknown = |why: &dyn Display| format!("scene {}: {why}", claim.scene);
        let scene = built_in(claim.scene).ok_or_else(|| unknown(&"not built in"))?;
        let scene = scene.map_err(|error| unknown(&error))?;
        let (Some(elements), Some(gamma)) = (claim.elements, claim.gamma) else {
            return Err(unknown(&"no bars, though it has the name of a built-in one"));
        };
        if elements > MOST_ELEMENTS {
            return Err(unknown(&format!("more than {MOST_ELEMENTS} elements")));
        }
        let first = scene.bars().first().map_or(1, |bar| bar.elements);
        let scene = scene.with_elements((elements * first / scene.elements()).max(1));
        let scene = scene.map_err(|error| unknown(&error))?;
        if scene.elements() != elements {
            return Err(unknown(&format!("{elements} elements, which the built-in one cannot have")));
        }
        let mass = MassMatrix::new(gamma.0).map_err(|error| unknown(&error))?;
        Ok(AnyModel::Bars(Model::new(scene, mass, self.penalty_mass)))
    }
}

/// The enclosure of what a row claims, computed again; `None` where it is not enclosed.
fn anew(model: &AnyModel, claim: &Claim, asking: &Asking) -> Result<Option<(f64, f64)>> {
    match claim.ratio {
        Some(ratio) => {
            let step = model.critical_step(claim.beta_s, ratio, asking)?.step;
            Ok(step.ok().map(|step| (step.lower, step.upper)))
        }
        None => {
            let found = model.optimal_ratio(claim.beta_s, asking)?;
            Ok(found.map(|found| (found.lower, found.upper)))
        }
    }
}
