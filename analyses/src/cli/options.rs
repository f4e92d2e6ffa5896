//! The flags that mean the same in every tool.

use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use clap::{Args, ValueEnum, ValueHint};

use super::StyleOptions;
use crate::error::{Error, Refusal, Result};
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::scene::{MAX_ELEMENTS, Scene};
use bipenalty::stability::{AnyModel, AnyScene, Model, Sweep};
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
    /// Mass matrices: lumped, averaged, consistent, or gamma in [0, 1] [default: lumped,averaged,consistent for bars, lumped
    /// for meshes; matrices bring their own]
    #[arg(long, value_name = "LIST", value_parser = masses, allow_negative_numbers = true)]
    pub mass: Option<MassList>,
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
    pub fn scenes(&self) -> Result<Vec<AnyScene>> {
        let remeshed = |name: &String| -> Result<AnyScene> {
            let scene = AnyScene::load(name)?;
            Ok(match self.elements {
                Some(elements) => scene.with_elements(elements)?,
                None => scene,
            })
        };
        self.scenes.iter().map(remeshed).collect()
    }

    /// The mass matrices of bars.
    pub fn masses(&self) -> Vec<MassMatrix> {
        let all = || vec![MassMatrix::LUMPED, MassMatrix::AVERAGED, MassMatrix::CONSISTENT];
        self.mass.as_ref().map_or_else(all, |list| list.0.clone())
    }

    /// The models of `scene`, one a mass matrix.
    ///
    /// # Errors
    /// As [`AnyModel::new`].
    pub fn models(&self, scene: &AnyScene) -> Result<Vec<Arc<AnyModel>>> {
        let model = |mass| Ok(Arc::new(AnyModel::new(scene, mass, self.penalty_mass.into())?));
        match (scene, &self.mass) {
            (AnyScene::Bars(_), _) => self.masses().into_iter().map(|mass| model(Some(mass))).collect(),
            (_, Some(list)) => list.0.iter().map(|mass| model(Some(*mass))).collect(),
            (_, None) => Ok(vec![model(None)?]),
        }
    }

    /// The scenes, all of which are to be rows of bars.
    ///
    /// # Errors
    /// As [`SceneOptions::scenes`]; a scene of matrices or meshes.
    pub fn bars(&self) -> Result<Vec<Scene>> {
        let bars = |scene| match scene {
            AnyScene::Bars(scene) => Ok(scene),
            other => Err(Refusal::new("SCENE", other.name(), "a scene of [[bar]] for this tool").into()),
        };
        self.scenes()?.into_iter().map(bars).collect()
    }

    /// The models of bars, one a mass matrix.
    pub fn bar_models(&self, scene: &Scene) -> Vec<Model> {
        let model = |mass| Model::new(scene.clone(), mass, self.penalty_mass.into());
        self.masses().into_iter().map(model).collect()
    }
}

/// The units of the axes of a chart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Units {
    /// C_r over beta_s
    #[default]
    Dimensionless,
    /// s over N/m
    Si,
}

/// Penalty ratios as typed.
#[derive(Debug, Clone, PartialEq)]
pub enum RatioSpec {
    /// The same ratios for every beta_s.
    Sweep(Sweep),
    /// For every beta_s the ratio of zero penetration, dt^2 s' mu = 1.
    Plastic,
}

impl FromStr for RatioSpec {
    type Err = Refusal;

    fn from_str(text: &str) -> Result<Self, Refusal> {
        if text == "plastic" { Ok(Self::Plastic) } else { text.parse().map(Self::Sweep) }
    }
}

/// Where the results go.
#[derive(Debug, Clone, Args)]
pub struct OutputOptions {
    /// Directory for the files [default: figures/TOOL]
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub out: Option<PathBuf>,
    /// What to write: svg, png, pdf, csv, json, tex, record; vtu, the critical modes of up to 8 points of a mesh (stability-map)
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "svg,png,csv,record")]
    pub format: Vec<Format>,
    /// Printed width of the figures: single (a column, 90 mm) or double (a page, 190 mm) [default: by panels]
    #[arg(long, value_name = "WIDTH")]
    pub width: Option<WidthOption>,
    /// How the figures look.
    #[command(flatten)]
    pub style: StyleOptions,
    /// Print the records on standard output and write no file
    #[arg(long, value_name = "FORMAT", conflicts_with = "format")]
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
    /// The mesh with a mode or a state, for ParaView
    Vtu,
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
            Self::Vtu => "vtu",
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
        "time step" => "--time-step",
        "damping, mass" => "--damping-mass",
        "damping, stiffness" => "--damping-stiffness",
        "damping, contact" => "--damping-contact",
        "damping" => "--limit with --damping-...",
        "noh-bathe, p" | "chung-lee, beta" | "tchamwa-wielgosz, phi" | "generalised-alpha, rho_b" => {
            &format!("--parameter ({})", refusal.place)
        }
        "limit" => "--limit",
        "engine" => "--engine",
        "tolerance" => "--tolerance",
        "patch" => "--patch",
        "mass" => "--mass",
        "penalty mass" => "--penalty-mass",
        "elements" => "--elements",
        "relative Courant number" => "--relative-courant",
        other if other.starts_with("elements ") => &format!("--{other}"),
        other => other,
    };
    let allowed = refusal
        .allowed
        .replace("the consistent mass penalty", "the consistent mass penalty, --penalty-mass consistent");
    Refusal { place: place.to_owned(), allowed, ..refusal }.into()
}
