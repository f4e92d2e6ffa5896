//! The flags that mean the same in every tool.

use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum, ValueHint};

use crate::error::{Error, Refusal, Result};
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Pencil;
use bipenalty::scene::{MAX_ELEMENTS, Scene, load};
use bipenalty::schemes::SchemeName;
use bipenalty::spectrum::{Spectrum, StepLimit};
use bipenalty::stability::{Axis, EngineName, Model};
use figure::Width;

/// Which scenes, how finely meshed, with which mass.
#[derive(Debug, Clone, Args)]
pub struct SceneOptions {
    /// Scenes: signorini, symmetric, hunek, bouncing-bar, or the path of a TOML file
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    pub scenes: Vec<String>,
    /// Elements of the first bar; the other bars keep their proportion
    #[arg(long, value_name = "N", value_parser = elements, allow_negative_numbers = true)]
    pub elements: Option<usize>,
    /// Mass matrices: lumped, averaged, consistent, or gamma in [0, 1]
    #[arg(long, value_name = "LIST", default_value = "lumped,averaged,consistent", value_parser = masses,
        allow_negative_numbers = true)]
    pub mass: MassList,
    /// Form of the mass penalty M_p
    #[arg(long, value_name = "FORM", default_value = "consistent")]
    pub penalty_mass: PenaltyMassOption,
}

/// A list of mass matrices.
#[derive(Debug, Clone, PartialEq)]
pub struct MassList(pub Vec<MassMatrix>);

/// The form of M_p as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PenaltyMassOption {
    /// M_p = m z z'
    Consistent,
    /// Row sums of |M_p| on the diagonal
    Diagonalised,
}

impl From<PenaltyMassOption> for PenaltyMass {
    fn from(option: PenaltyMassOption) -> Self {
        match option {
            PenaltyMassOption::Consistent => Self::Consistent,
            PenaltyMassOption::Diagonalised => Self::Diagonalised,
        }
    }
}

fn whole<N: FromStr + PartialOrd + Display>(text: &str, low: N, high: N) -> Result<N, Refusal> {
    let number = text.trim().parse().ok().filter(|number| (&low..=&high).contains(&number));
    number.ok_or_else(|| {
        Refusal::new("whole number", format!("{text:?}"), format!("an integer from {low} to {high}"))
    })
}

fn elements(text: &str) -> Result<usize, Refusal> {
    whole(text, 1, MAX_ELEMENTS)
}

fn threads(text: &str) -> Result<u16, Refusal> {
    whole(text, 1, 1024)
}

fn masses(text: &str) -> Result<MassList, Refusal> {
    let mass = |word: &str| match word.trim() {
        "lumped" => Ok(MassMatrix::LUMPED),
        "averaged" => Ok(MassMatrix::AVERAGED),
        "consistent" => Ok(MassMatrix::CONSISTENT),
        other => match other.parse() {
            Ok(gamma) => MassMatrix::new(gamma),
            Err(_) => Err(Refusal::new(
                "mass",
                format!("{other:?}"),
                "lumped, averaged, consistent or a number gamma in [0, 1]",
            )),
        },
    };
    text.split(',').map(mass).collect::<Result<_, _>>().map(MassList)
}

impl SceneOptions {
    /// The scenes as asked for, remeshed.
    ///
    /// # Errors
    /// What the scene files and `--elements` are refused for.
    pub fn scenes(&self) -> Result<Vec<Scene>> {
        let remeshed = |name: &String| -> Result<Scene> {
            let scene = load(name)?;
            Ok(match self.elements {
                Some(elements) => scene.with_elements(elements)?,
                None => scene,
            })
        };
        self.scenes.iter().map(remeshed).collect()
    }

    /// The models of `scene`, one a mass matrix.
    pub fn models(&self, scene: &Scene) -> Vec<Model> {
        let model = |mass: &MassMatrix| Model::new(scene.clone(), *mass, self.penalty_mass.into());
        self.mass.0.iter().map(model).collect()
    }
}

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
}

impl Limit {
    /// The name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Spectrum => "spectrum",
            Self::CentralDifference => SchemeName::CentralDifference.name(),
            Self::PredictorCorrector => SchemeName::PredictorCorrector.name(),
            Self::Park => SchemeName::Park.name(),
        }
    }

    /// The scheme whose limit is not the spectrum's.
    pub fn scheme(self) -> Option<SchemeName> {
        match self {
            Self::Spectrum | Self::CentralDifference => None,
            Self::PredictorCorrector => Some(SchemeName::PredictorCorrector),
            Self::Park => Some(SchemeName::Park),
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
    /// auto, closed-form, secular, sturm, dense, or lapack where it is built in
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub engine: EngineName,
}

impl LimitOptions {
    /// Refuses what `model` has no such limit or no such engine for.
    ///
    /// # Errors
    /// An engine or a theta that the limit does not use, and what [`Model::limit`] refuses.
    pub fn check(&self, model: &Model) -> Result<(), Refusal> {
        let place = format!("--limit {}", self.limit.name());
        if let Some(theta) = self.theta.filter(|_| self.limit != Limit::Park) {
            return Err(Refusal::new("--theta", theta, format!("no theta with {place}, or --limit park")));
        }
        let Some(scheme) = self.limit.scheme() else {
            return model.check_engine(self.engine);
        };
        if self.engine != EngineName::Auto {
            return Err(Refusal::new("--engine", self.engine.text(), format!("auto with {place}")));
        }
        model.check_pencil()?;
        model.limit(&*scheme.with_theta(self.theta())?, &model.pencil()).map(|_| ())
    }

    /// theta of the Park scheme.
    pub fn theta(&self) -> f64 {
        self.theta.unwrap_or(0.5)
    }

    /// Whether the limit works on the assembled pencil.
    pub fn needs_pencil(&self) -> bool {
        self.limit.scheme().is_some() || self.engine.needs_pencil()
    }

    /// What finds the limit of `model` as l = 4/dt^2; `pencil` where it is needed.
    ///
    /// # Errors
    /// What [`Model::limit`] refuses.
    pub fn find<'a>(
        &self,
        model: &Model,
        pencil: Option<&'a Pencil>,
    ) -> Result<Box<dyn StepLimit + 'a>, Refusal> {
        match (self.limit.scheme(), pencil) {
            (Some(scheme), Some(pencil)) => model.limit(&*scheme.with_theta(self.theta())?, pencil),
            (None, Some(pencil)) => Ok(Box::new(Spectrum(model.engine(self.engine, pencil)?))),
            (None, None) if self.engine == EngineName::ClosedForm => {
                Ok(Box::new(Spectrum(Box::new(model.closed_form()))))
            }
            (_, None) => Ok(Box::new(Spectrum(Box::new(model.auto())))),
        }
    }
}

/// Penalty ratios as typed.
#[derive(Debug, Clone, PartialEq)]
pub enum RatioSpec {
    /// The same ratios for every beta_s.
    Axis(Axis),
    /// For every beta_s the ratio of zero penetration, dt^2 s' mu = 1.
    Plastic,
}

impl FromStr for RatioSpec {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        if text == "plastic" { Ok(Self::Plastic) } else { text.parse().map(Self::Axis) }
    }
}

/// Where the results go.
#[derive(Debug, Clone, Args)]
pub struct OutputOptions {
    /// Directory for the files [default: figures/TOOL]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// What to write: svg, png, pdf, csv, json, tex, record
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "svg,png,csv,record")]
    pub format: Vec<Format>,
    /// Printed width of the figures: single (a column, 90 mm) or double (a page, 190 mm) [default: by panels]
    #[arg(long, value_name = "WIDTH")]
    pub width: Option<WidthOption>,
    /// Print the records on standard output and write no file
    #[arg(long, value_name = "FORMAT")]
    pub stdout: Option<StandardOutput>,
    /// Number of threads [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<u16>,
    /// Say what would be computed, by what, and what the scene lets the run leave out; compute nothing
    #[arg(long)]
    pub explain: bool,
    /// No progress, no summary
    #[arg(long, short)]
    pub quiet: bool,
}

/// The printed width as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum WidthOption {
    /// One column, 90 mm
    Single,
    /// The page, 190 mm
    Double,
}

impl From<WidthOption> for Width {
    fn from(option: WidthOption) -> Self {
        match option {
            WidthOption::Single => Self::Single,
            WidthOption::Double => Self::Double,
        }
    }
}

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Vector figure
    Svg,
    /// Figure at 300 dpi
    Png,
    /// Vector figure with embedded fonts
    Pdf,
    /// Records
    Csv,
    /// Records with their provenance
    Json,
    /// Source for pgfplots, with the records as csv that it reads
    Tex,
    /// Command, revision, scene, engine, time and checks of each figure, as FIGURE.record.json
    Record,
}

impl Format {
    /// The ending of a file name.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
            Self::Tex => "tex",
            Self::Csv => "csv",
            Self::Json => "json",
            Self::Record => "record.json",
        }
    }

    /// Whether this is a picture.
    pub fn is_figure(self) -> bool {
        matches!(self, Self::Svg | Self::Png | Self::Pdf | Self::Tex)
    }
}

/// The form of records on standard output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StandardOutput {
    /// One header, one line a row
    Csv,
    /// One document with provenance
    Json,
}

/// An error by the options that the user typed: the library refuses parameters, and knows no options.
pub(super) fn by_option(error: Error) -> Error {
    let Error::Library(bipenalty::error::Error::Refused(refusal)) = error else { return error };
    let place = match refusal.place.as_str() {
        "beta_s" => "--beta-s",
        "r" | "ratio" => "--ratio",
        "beta_s, ratio" | "grid" => "--beta-s, --ratio",
        "theta" => "--theta",
        "limit" => "--limit",
        "engine" => "--engine",
        "tolerance" => "--tolerance",
        "relative Courant number" => "--relative-courant",
        other if other.starts_with("elements ") => &format!("--{other}"),
        other => other,
    };
    let allowed = refusal
        .allowed
        .replace("the consistent mass penalty", "the consistent mass penalty, --penalty-mass consistent");
    Refusal { place: place.to_owned(), allowed, ..refusal }.into()
}
