//! `scheme-limits --per-force`: what each scheme costs over the penalty.

use std::str::FromStr;
use std::sync::Arc;

use clap::{Args, ValueHint};
use std::path::PathBuf;

use super::{
    Chart, Frame, Intent, Job, Limit, LimitOptions, Output, Progress, Units, axis_word, penalties_of,
    question,
};
use crate::charts;
use crate::error::{Refusal, Result};
use crate::record::{CostRow, Price, StabilityRow, Subject};
use bipenalty::schemes::SchemeName;
use bipenalty::stability::{AnyModel, Asking, Sweep};
use figure::Scale;

/// Which schemes are compared, and where.
#[derive(Debug, Clone, Args)]
pub struct ForceOptions {
    /// Compare what schemes cost instead: the limit over the forces that a step evaluates, over beta_s
    #[arg(long)]
    pub per_force: bool,
    /// Schemes to compare, a parameter after a colon, such as noh-bathe:0.6 [default: all that the scene has]
    #[arg(long, value_name = "LIST", value_delimiter = ',', requires = "per_force")]
    pub limit: Vec<Priced>,
    /// Stiffness penalties: a list, lin:START:STOP:COUNT or log:START:STOP:COUNT [default: log:1e-2:1e2:121]
    #[arg(long, value_name = "SPEC", requires = "per_force", allow_negative_numbers = true)]
    pub beta_s: Option<Sweep>,
    /// Stiffness penalties s in N/m, in the same forms, instead of beta_s: of the contact of smallest scale
    #[arg(
        long,
        value_name = "SPEC",
        requires = "per_force",
        allow_negative_numbers = true,
        conflicts_with = "beta_s"
    )]
    pub stiffness: Option<Sweep>,
    /// Penalty ratios in the same forms, or inf [default: 0.25,1,inf]
    #[arg(long, value_name = "SPEC", requires = "per_force", allow_negative_numbers = true)]
    pub ratio: Option<Sweep>,
    /// Draw the records of a CSV file of an earlier --per-force again without computing
    #[arg(long, value_name = "FILE.csv", value_hint = ValueHint::FilePath, conflicts_with_all = ["scenes",
        "elements", "mass", "penalty_mass", "per_force", "theta"])]
    pub from: Option<PathBuf>,
}

/// A scheme with a parameter of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Priced {
    scheme: Limit,
    parameter: Option<f64>,
}

impl FromStr for Priced {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        let (name, parameter) = match text.split_once(':') {
            Some((name, parameter)) => (name, Some(parameter)),
            None => (text, None),
        };
        let known = || Limit::SCHEMES.into_iter().map(Limit::name);
        let refused = || {
            let allowed = format!("{}, a number after a colon", known().collect::<Vec<_>>().join(", "));
            Refusal::new("limit", format!("{text:?}"), allowed)
        };
        let scheme = Limit::SCHEMES.into_iter().find(|scheme| scheme.name() == name).ok_or_else(refused)?;
        let parameter = parameter.map(|p| p.parse().map_err(|_| refused())).transpose()?;
        Ok(Self { scheme, parameter })
    }
}

impl Priced {
    /// The limit with its parameter; `theta` is that of the Park scheme.
    fn settings(self, theta: f64) -> LimitOptions {
        let theta = (self.scheme == Limit::Park).then_some(theta);
        LimitOptions { theta, parameter: self.parameter, ..LimitOptions::of(self.scheme) }
    }

    /// The price of a step.
    ///
    /// # Errors
    /// As [`LimitOptions::asking`].
    fn price(self, theta: f64, contact_free: f64) -> Result<Price, Refusal> {
        let (parameter, evaluations) = match self.scheme.explicit() {
            Some(explicit) => {
                let scheme = explicit.with(self.parameter)?;
                (Some(scheme.parameter()), scheme.facts().evaluations)
            }
            None => {
                let name = self.scheme.scheme().unwrap_or(SchemeName::CentralDifference);
                ((name == SchemeName::Park).then_some(theta), name.facts().solves)
            }
        };
        Ok(Price { parameter, evaluations, contact_free })
    }
}

/// The schemes that are compared on each model.
#[derive(Debug)]
pub struct ForcePlan {
    jobs: Vec<(Job, Vec<Priced>)>,
    theta: f64,
}

impl ForceOptions {
    /// What the name of a folder says of other penalties and schemes than the usual ones.
    pub fn words(&self, theta: Option<f64>) -> String {
        let axis = |name: &str, axis: &Option<Sweep>| axis.as_ref().map(|axis| axis_word(name, axis));
        let named = |priced: &Priced| {
            let parameter = priced.parameter.map_or_else(String::new, |parameter| parameter.to_string());
            format!("{}{parameter}", priced.scheme.name())
        };
        let schemes = self.limit.iter().map(named).collect::<Vec<_>>().join("-");
        let schemes = Some(schemes).filter(|schemes| !schemes.is_empty());
        let theta = theta.map(|theta| format!("theta{theta}"));
        let words = [axis("beta", &self.beta_s), axis("s", &self.stiffness), axis("r", &self.ratio), schemes];
        question(words.into_iter().chain([theta])).trim_start_matches('-').to_owned()
    }

    /// What is compared on `models`.
    ///
    /// # Errors
    /// A scheme that a model has no limit of, where it is asked for by name; a grid that is none.
    pub fn plan(&self, models: &[Arc<AnyModel>], theta: f64) -> Result<ForcePlan, Refusal> {
        /// Each ratio has a panel.
        const MOST_RATIOS: usize = 6;
        let usual = self.beta_s.clone().map_or_else(|| Sweep::log(1e-2, 1e2, 121), Ok)?;
        let ratio = self.ratio.clone();
        let ratio = ratio.unwrap_or_else(|| Sweep::list([0.25, 1.0, f64::INFINITY]));
        if ratio.values.len() > MOST_RATIOS {
            let allowed = format!("at most {MOST_RATIOS} ratios with --per-force, a panel each");
            return Err(Refusal::new("--ratio", format!("{} ratios", ratio.values.len()), allowed));
        }
        let job = |model: &Arc<AnyModel>| {
            let mass = model.mass().map_or(String::new(), |mass| format!("-{}", mass.name()));
            let stem = format!("forces-{}{mass}", model.name());
            let schemes = self.schemes(model, theta)?;
            let in_newtons = self.stiffness.as_ref().map(|stiffness| penalties_of(stiffness, model));
            let beta_s = in_newtons.transpose()?.unwrap_or_else(|| usual.clone());
            Ok((Job::new(stem, vec![model.clone()], beta_s, ratio.clone())?, schemes))
        };
        Ok(ForcePlan { jobs: models.iter().map(job).collect::<Result<_, Refusal>>()?, theta })
    }

    /// The schemes asked for, else all whose limit is derived for the model.
    fn schemes(&self, model: &AnyModel, theta: f64) -> Result<Vec<Priced>, Refusal> {
        if !self.limit.is_empty() {
            self.limit.iter().try_for_each(|scheme| scheme.settings(theta).check(model))?;
            return Ok(self.limit.clone());
        }
        let all = Limit::SCHEMES.into_iter().map(|scheme| Priced { scheme, parameter: None });
        let known: Vec<Priced> = all.filter(|scheme| scheme.settings(theta).check(model).is_ok()).collect();
        Ok(known)
    }
}

impl ForcePlan {
    /// The names of the files.
    pub fn stems(&self) -> impl Iterator<Item = String> + use<'_> {
        self.jobs.iter().map(|(job, _)| job.stem.clone())
    }

    /// The figures to come: one panel a ratio, whose upright axis is for the rows to choose.
    pub fn frames(&self) -> Vec<Frame> {
        let drawn = self.jobs.iter().filter(|(job, _)| job.chart != Chart::None);
        let frame = |(job, _): &(Job, Vec<Priced>)| {
            let x = if charts::is_logarithmic(&job.beta_s.values) { Scale::Log } else { Scale::Linear };
            Frame::new(&job.stem, x, Scale::Linear).of_panels(job.grid.ratios.len())
        };
        drawn.map(frame).collect()
    }

    /// What `--explain` says.
    pub fn explain(&self) -> Vec<Intent> {
        let line = |(job, schemes): &(Job, Vec<Priced>)| {
            let names: Vec<&str> = schemes.iter().map(|scheme| scheme.scheme.name()).collect();
            Intent::of(&job.stem, format!("{} points each of {}", job.points(), names.join(", ")))
        };
        self.jobs.iter().map(line).collect()
    }

    /// Computes, writes and draws; the rows and the number of files.
    ///
    /// # Errors
    /// As [`Job::solve`] and [`Output::write_rows`].
    pub fn compute(&self, units: Units, output: &Output, quiet: bool) -> Result<(Vec<CostRow>, usize)> {
        self.jobs.iter().try_for_each(|(job, _)| job.check())?;
        let points = self.jobs.iter().map(|(job, schemes)| job.points() * schemes.len()).sum();
        let progress = Progress::new(points, "points", quiet);
        let (mut all, mut files) = (Vec::new(), 0);
        for (job, schemes) in &self.jobs {
            let rows = self.rows(job, schemes, &progress)?;
            let log = charts::is_logarithmic(&job.beta_s.values);
            let drawn = output.wants_figures() && job.chart != Chart::None;
            let figure = drawn.then(|| charts::per_force(&rows, log, units == Units::Si));
            figure.iter().try_for_each(|figure| output.check_figure(&job.stem, figure.clone()))?;
            files += output.write_rows(&job.stem, &rows)?.len();
            if let Some(figure) = figure {
                files += output.write_figure(&job.stem, &figure)?.len();
            }
            all.extend(rows);
        }
        Ok((all, files))
    }

    fn rows(&self, job: &Job, schemes: &[Priced], progress: &Progress) -> Result<Vec<CostRow>, Refusal> {
        let mut rows = Vec::new();
        for model in &job.models {
            let subject = Subject::of(model)?;
            let free = model.contact_free(&Asking::default())?.step;
            let contact_free = free.map_or(f64::NAN, |step| step.critical_courant);
            for scheme in schemes {
                let price = scheme.price(self.theta, contact_free)?;
                for solved in job.solve(&scheme.settings(self.theta), progress)? {
                    let limits = StabilityRow::of(&subject, scheme.scheme.name(), &solved.curves);
                    rows.extend(limits.into_iter().map(|row| CostRow::new(row, price)));
                }
            }
        }
        Ok(rows)
    }
}
