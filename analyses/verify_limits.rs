//! Are the predicted limits the limits? Stepping at them, from a state that excites every mode, says so.
//!
//! For each point of a grid the contacts are held closed, and the largest stable Courant number is searched by the growth
//! of the motion alone. The prediction, 2/omega_max for central differences, the limit of the scheme itself for the
//! others, only says where to look first. Where growth above it is too slow for a trial, the row says so.
//!
//! Linear stability is necessary only. So bars are also thrown on their contacts and pressed against them at steps below
//! the predicted limit, and the energy is measured that they gain while contacts open and close.

use std::process::ExitCode;
use std::sync::Arc;

use analyses::charts::verification;
use analyses::cli::{
    Analysis, Contact, Frame, Intent, OpeningOptions, OpeningPlan, OpeningResult, Output, OutputOptions,
    Progress, SceneOptions, Verdict, axis_word, check_stems, checked_grid, narrate, penalties_of,
    print_reasons, print_verification, question, require_memory,
};
use analyses::error::{Refusal, Result};
use analyses::record::{GIVEN, StabilityRow, Subject, VerifyRow};
use bipenalty::scene::{Scene, load};
use bipenalty::schemes::{Scheme, SchemeName};
use bipenalty::stability::{AnyModel, AnyScene, Asking, Grid, LimitOf, Sweep};
use bipenalty::verify::{PenaltyPoint, Prediction, Search, check_any, confirm_any, points_of, predict_any};
use clap::Parser;
use figure::Scale;
use rayon::prelude::*;

/// Limits found by time stepping with closed contact beside the predicted ones, and what contact that opens and closes gains below them; exit
/// status 1 if a limit of closed contact, or what is proven of opening contact, does not hold.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    /// Contacts: closed (held closed), opening (free to open and close)
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "closed")]
    contact: Vec<Contact>,
    /// Stiffness penalties: a list 0,0.5,10 or lin:0:10:11 or log:1e-3:1e12:20 (start:stop:count) [default: lin:0:10:11,
    /// opening contact: 1,10,100,1e4]
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    beta_s: Option<Sweep>,
    /// Stiffness penalties s in N/m, in the same forms, instead of beta_s, with contact held closed: s of the contact of
    /// smallest scale
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true, conflicts_with = "beta_s")]
    stiffness: Option<Sweep>,
    /// Penalty ratios r, in the same forms; inf is the pure penalty method [default: 0.5,1,2,3,inf, opening contact:
    /// 0.125,0.25,0.5,1,2,4,inf]
    #[arg(long, value_name = "SPEC", allow_negative_numbers = true)]
    ratio: Option<Sweep>,
    /// Schemes: central-difference, predictor-corrector, park
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "central-difference,predictor-corrector,park"
    )]
    scheme: Vec<SchemeName>,
    /// Averaging of the Park scheme, in [0, 1] [default: 0.5]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    theta: Option<f64>,
    /// Relative width to which stepping brackets a limit [default: 1e-6 for central differences, 1e-4 for the others]; with
    /// it goes the length of a trial, 13/sqrt(EPS) steps for central differences, 100/EPS for the others, and with that the
    /// growth a step that a trial can see (--explain says it): a limit beyond which growth is slower is not seen, and
    /// "agrees" is empty
    #[arg(long, value_name = "EPS", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    opening: OpeningOptions,
    #[command(flatten)]
    output: OutputOptions,
}

/// Bytes of a point of the grid: up to 60 planned runs of 500, each with its row.
const BYTES_PER_CASE: u64 = 60_000;

const EXAMPLES: &str = "Examples:
  verify-limits                                   the points of Fig. 3, into figures/verify-limits/
  verify-limits signorini --scheme central-difference --mass 1 --beta-s 1,1e4 --ratio .5,1,inf
  verify-limits signorini --elements 10 --scheme park --theta 1 --beta-s 1,1e3,1e6 --ratio 1,4
  verify-limits my-bars.toml --beta-s 10 --stdout csv
  verify-limits two-blocks.toml --beta-s 1,1e3 --ratio 1,inf --tolerance 1e-2 --stdout csv
  verify-limits --contact opening                 energy gained, and the steps to recommend
  verify-limits signorini --contact opening --mass 1 --beta-s 1e4 --fraction lin:.05:.95:19";

/// One figure: models side by side, with one scheme.
#[derive(Clone)]
struct Job {
    stem: String,
    models: Vec<Arc<AnyModel>>,
    scheme: Arc<dyn Scheme>,
    tolerance: f64,
}

/// What stepping has found.
struct Found {
    closed: Vec<Vec<VerifyRow>>,
    opening: Option<(OpeningPlan, OpeningResult)>,
}

fn main() -> ExitCode {
    narrate::<Options>()
}

impl Analysis for Options {
    const NAME: &'static str = "verify-limits";
    type Plan = (Option<Study>, Option<OpeningPlan>);
    type Found = Found;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Self::Plan> {
        check_used(self)?;
        let closed = wants(self, Contact::Closed).then(|| Study::new(self)).transpose()?;
        let opening = wants(self, Contact::Opening).then(|| plan_opening(self)).transpose()?;
        Ok((closed, opening))
    }

    fn explain(&self, (closed, opening): &Self::Plan) -> Result<Vec<Intent>> {
        let closed = closed.iter().flat_map(Study::explain);
        Ok(closed.chain(opening.iter().map(OpeningPlan::explain)).collect())
    }

    fn frames(&self, (closed, opening): &Self::Plan) -> Vec<Frame> {
        let closed = closed.iter().flat_map(Study::frames);
        let gains = opening.iter().map(|_| Frame::new("opening", Scale::Linear, Scale::Log).of_colours());
        closed.chain(gains).collect()
    }

    fn compute(&self, (study, opening): Self::Plan, output: &Output) -> Result<(Found, usize)> {
        let (closed, mut files) =
            study.map_or_else(|| Ok(Default::default()), |study| study.confirm(self, output))?;
        let opening = match opening {
            None => None,
            Some(plan) => {
                let progress = Progress::new(plan.len(), "runs", self.output.quiet);
                let result = plan.measure(&progress)?;
                drop(progress);
                files += result.write(output, &opening_words(self))?;
                Some((plan, result))
            }
        };
        Ok((Found { closed, opening }, files))
    }

    fn print(&self, found: &Found, output: &Output) -> Result<()> {
        let opening = found.opening.iter().flat_map(|(_, result)| &result.limits);
        output.print(found.closed.iter().flatten().chain(opening))
    }

    fn summarise(&self, found: &Found) {
        if wants(self, Contact::Closed) {
            print_verification(&found.closed);
        }
        if let Some((plan, result)) = &found.opening {
            result.summarise(plan);
        }
    }

    fn verdict(&self, found: &Found) -> Verdict {
        let agree = found.closed.iter().flatten().all(|row| row.agrees != Some(false));
        let holds = agree && found.opening.as_ref().is_none_or(|(_, result)| result.holds);
        if holds { Verdict::Holds } else { Verdict::Fails }
    }
}

fn wants(options: &Options, contact: Contact) -> bool {
    options.contact.contains(&contact)
}

/// Refuses options that nothing of what was asked for uses.
fn check_used(options: &Options) -> Result<(), Refusal> {
    if let Some(theta) = options.theta.filter(|_| !options.scheme.contains(&SchemeName::Park)) {
        return Err(Refusal::new("--theta", theta, "no theta without --scheme park"));
    }
    if let Some(tolerance) = options.tolerance.filter(|_| !wants(options, Contact::Closed)) {
        return Err(Refusal::new("--tolerance", tolerance, "no tolerance without --contact closed"));
    }
    if options.stiffness.is_some() && wants(options, Contact::Opening) {
        return Err(Refusal::new("--stiffness", "given with --contact opening", "--beta-s"));
    }
    if options.opening.fraction.is_some() && !wants(options, Contact::Opening) {
        return Err(Refusal::new("--fraction", "given", "no fraction without --contact opening"));
    }
    Ok(())
}

/// The penalties asked for, or those of the kind of contact.
fn axes(options: &Options, contact: Contact) -> Result<(Sweep, Sweep)> {
    let (beta_s, ratio) = match contact {
        Contact::Closed => ("lin:0:10:11", "0.5,1,2,3,inf"),
        Contact::Opening => ("1,10,100,1e4", "0.125,0.25,0.5,1,2,4,inf"),
    };
    let given = options.stiffness.as_ref().or(options.beta_s.as_ref());
    let beta_s = given.cloned().map_or_else(|| beta_s.parse(), Ok)?;
    Ok((beta_s, options.ratio.clone().map_or_else(|| ratio.parse(), Ok)?))
}

/// The penalties of one model with contact held closed, as beta_s.
fn axes_of(options: &Options, model: &AnyModel) -> Result<(Sweep, Sweep)> {
    let (beta_s, ratio) = axes(options, Contact::Closed)?;
    Ok(match &options.stiffness {
        Some(stiffness) => (penalties_of(stiffness, model)?, ratio),
        None => (beta_s, ratio),
    })
}

/// What file names say of the options that were given.
fn words(options: &Options) -> String {
    let axis = |name: &str, axis: &Option<Sweep>| axis.as_ref().map(|axis| axis_word(name, axis));
    let number = |name: &str, value: Option<f64>| value.map(|value| format!("{name}{value}"));
    let given = [
        axis("beta", &options.beta_s),
        axis("s", &options.stiffness),
        axis("r", &options.ratio),
        number("theta", options.theta),
        number("to", options.tolerance),
    ];
    question(options.scene.words().into_iter().chain(given))
}

/// The built-in bars called `names` with `elements`, or as many as were asked for.
fn usual(options: &Options, names: [&str; 2], elements: Option<usize>) -> Result<Vec<Scene>> {
    let elements = options.scene.elements.or(elements);
    let built_in = |name: &str| {
        let scene = load(name)?;
        Ok(elements.map_or(Ok(scene.clone()), |elements| scene.with_elements(elements))?)
    };
    names.into_iter().map(built_in).collect()
}

/// The same for contact that opens and closes: for files of all scenes, and for those of one scene and mass matrix.
fn opening_words(options: &Options) -> [String; 2] {
    let fraction = options.opening.fraction.as_ref().map(|fraction| axis_word("fraction", fraction));
    let schemes = (options.scheme.len() < SchemeName::ALL.len())
        .then(|| options.scheme.iter().map(|scheme| scheme.name()).collect::<Vec<_>>().join("-"));
    let each = words(options) + &question([fraction, schemes]);
    let scenes =
        options.scene.scenes.iter().map(|scene| {
            std::path::Path::new(scene).file_stem().map(|stem| stem.to_string_lossy().into_owned())
        });
    [question(scenes.chain([options.scene.mass_word()])) + &each, each]
}

/// Every scheme below its limits in the impacts of the paper, or in the scenes that were asked for.
fn plan_opening(options: &Options) -> Result<OpeningPlan> {
    let (beta_s, ratio) = axes(options, Contact::Opening)?;
    let grid = checked_grid(&beta_s, &ratio)?;
    require_memory(&grid, BYTES_PER_CASE)?;
    let scenes = match options.scene.scenes[..] {
        [] => usual(options, ["signorini", "hunek"], None)?.into_iter().map(AnyScene::Bars).collect(),
        _ => options.scene.scenes()?,
    };
    let mut models: Vec<(AnyScene, Arc<AnyModel>)> = Vec::new();
    for scene in scenes {
        let of_scene = options.scene.models(&scene)?;
        models.extend(of_scene.into_iter().map(|model| (scene.clone(), model)));
    }
    let mass = |model: &AnyModel| model.mass().map_or(GIVEN.to_owned(), |mass| mass.name());
    let stem = |model: &AnyModel| format!("opening-{}-{}", model.name(), mass(model));
    check_stems(&options.output, models.iter().map(|(_, model)| stem(model)))?;
    let theta = options.theta.unwrap_or(0.5);
    OpeningPlan::new(&models, &options.scheme, theta, &grid, &options.opening)
}

/// What is done with contact held closed.
struct Study {
    beta_s: Sweep,
    ratio: Sweep,
    grid: Grid,
    jobs: Vec<Job>,
}

impl Study {
    fn new(options: &Options) -> Result<Self> {
        let (beta_s, ratio) = axes(options, Contact::Closed)?;
        let grid = checked_grid(&beta_s, &ratio)?;
        require_memory(&grid, BYTES_PER_CASE)?;
        let jobs = plan(options)?;
        Ok(Self { beta_s, ratio, grid, jobs })
    }

    fn explain(&self) -> impl Iterator<Item = Intent> {
        self.jobs.iter().map(|job| explain(job, &self.grid))
    }

    fn frames(&self) -> impl Iterator<Item = Frame> {
        let x = if self.beta_s.log { Scale::Log } else { Scale::Linear };
        let frame = move |job: &Job| Frame::new(&job.stem, x, Scale::Linear).of_panels(job.models.len());
        self.jobs.iter().filter(|_| is_drawn(&self.grid)).map(frame)
    }

    /// The rows of every model and scheme, written and drawn; the number of files.
    fn confirm(&self, options: &Options, output: &Output) -> Result<(Vec<Vec<VerifyRow>>, usize)> {
        let points = self.jobs.iter().map(|job| job.models.len() * self.grid.len()).sum();
        let progress = Progress::new(points, "limits", options.output.quiet);
        let (mut all, mut files, mut reasons) = (Vec::new(), 0, Vec::new());
        for job in &self.jobs {
            progress.doing(&job.stem);
            let mut rows = Vec::new();
            for model in &job.models {
                let (beta_s, ratio) = axes_of(options, model)?;
                let (measured, missing) = measure(model, job, &Grid::new(&beta_s, &ratio)?, &progress)?;
                rows.push(measured);
                reasons.extend(missing.into_iter().map(|why| format!("{}: {why}", job.stem)));
            }
            files += output.write_rows(&job.stem, &rows.concat())?.len();
            if output.wants_figures() && is_drawn(&self.grid) {
                let predicted: Result<Option<Vec<_>>> =
                    job.models.iter().map(|model| self.prediction(model, job, options)).collect();
                // Without curves there is nothing to mark the points on: the records hold them.
                if let Some(predicted) = predicted? {
                    let figure = verification::limits(&predicted, &rows, self.beta_s.log);
                    files += output.write_figure(&job.stem, &figure)?.len();
                }
            }
            all.extend(rows);
        }
        drop(progress);
        if !options.output.quiet {
            print_reasons(&reasons);
        }
        Ok((all, files))
    }

    /// The predicted curves, finer than the measured points; `None` where there is no prediction.
    fn prediction(
        &self,
        model: &AnyModel,
        job: &Job,
        options: &Options,
    ) -> Result<Option<Vec<StabilityRow>>> {
        let (beta_s, _) = axes_of(options, model)?;
        let ends = || beta_s.values.iter().copied();
        let (low, high) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
        let fine = if self.beta_s.log { Sweep::log(low, high, 201)? } else { Sweep::linear(low, high, 201)? };
        let grid = Grid::new(&fine, &self.ratio)?;
        let asking = Asking { limit: LimitOf::Scheme(job.scheme.clone()), ..Asking::default() };
        let Ok(curves) = model.map(&grid, &asking, &|_| ()) else { return Ok(None) };
        Ok(Some(StabilityRow::of(&Subject::of(model)?, job.scheme.facts().name, &curves)))
    }
}

/// Fig. 3 of the paper for every mass matrix, or the scenes that were asked for.
fn plan(options: &Options) -> Result<Vec<Job>> {
    let scenes = match options.scene.scenes[..] {
        [] => usual(options, ["signorini", "symmetric"], Some(1))?.into_iter().map(AnyScene::Bars).collect(),
        _ => options.scene.scenes()?,
    };
    let models: Vec<_> = scenes.iter().map(|scene| options.scene.models(scene)).collect::<Result<_>>()?;
    let jobs = options.scheme.iter().map(|scheme| jobs_of(options, *scheme, &models));
    let jobs = jobs.collect::<Result<Vec<_>>>()?.concat();
    check_stems(&options.output, scenes.iter().map(|scene| scene.name().to_owned()))?;
    check_stems(&options.output, jobs.iter().map(|job| job.stem.clone()))?;
    Ok(jobs)
}

/// One figure for each mass matrix with one scheme: the models that have it side by side.
fn jobs_of(options: &Options, scheme: SchemeName, models: &[Vec<Arc<AnyModel>>]) -> Result<Vec<Job>> {
    let usual = if scheme == SchemeName::CentralDifference { 1e-6 } else { 1e-4 };
    let (theta, tolerance) = (options.theta.unwrap_or(0.5), options.tolerance.unwrap_or(usual));
    let name = scheme.name();
    let scheme: Arc<dyn Scheme> = scheme.with_theta(theta)?;
    let search = Search::to(tolerance, &*scheme)?;
    let job = |i: usize| {
        let models: Vec<_> = models.iter().filter_map(|models| models.get(i)).cloned().collect();
        for model in &models {
            let (beta_s, ratio) = axes_of(options, model)?;
            model.check_grid(&checked_grid(&beta_s, &ratio)?)?;
            check_any(model, &*scheme, &search)?;
        }
        let names: Vec<&str> = models.iter().map(|model| model.name()).collect();
        let mass = models.iter().find_map(|model| model.mass()).map_or(GIVEN.to_owned(), |mass| mass.name());
        // The pair of Fig. 3 by its own name, whatever it is meshed with, must not pass for the one of single elements.
        let meshed = !options.scene.scenes.is_empty() && models.len() > 1 && options.scene.elements.is_none();
        let elements: usize = models.iter().filter_map(|model| model.elements()).sum();
        let meshed = if meshed { format!("-of{elements}") } else { String::new() };
        let stem = format!("{}-{mass}-{name}{meshed}{}", names.join("-"), words(options));
        Ok(Job { stem, models, scheme: scheme.clone(), tolerance })
    };
    (0..models.iter().map(Vec::len).max().unwrap_or(0)).map(job).collect()
}

/// Steps at every point of the grid, in parallel, and compares with the prediction.
/// What cannot be predicted is stepped all the same; why it cannot comes with the rows.
fn measure(
    model: &AnyModel,
    job: &Job,
    grid: &Grid,
    progress: &Progress,
) -> Result<(Vec<VerifyRow>, Vec<Refusal>)> {
    let predicted = predict_any(model, &job.scheme, grid, job.tolerance);
    let points: Vec<(PenaltyPoint, Result<Prediction, Refusal>)> = points_of(grid).zip(predicted).collect();
    let row = |(point, predicted): (PenaltyPoint, Result<Prediction, Refusal>)| -> Result<_> {
        let (predicted, reason) = match predicted {
            Ok(predicted) => (Some(predicted), None),
            Err(reason) => (None, Some(reason)),
        };
        let confirmation = confirm_any(model, &*job.scheme, point, job.tolerance, predicted)?;
        progress.add(1);
        Ok((VerifyRow::new(model, &*job.scheme, point, &confirmation)?, reason))
    };
    let found: Vec<_> = points.into_par_iter().map(row).collect::<Result<_>>()?;
    let (rows, reasons): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    Ok((rows, reasons.into_iter().flatten().collect()))
}

/// Whether the curves of a grid can be told apart.
fn is_drawn(grid: &Grid) -> bool {
    grid.stiffness_penalties.len() > 1 && grid.ratios.len() <= verification::MOST_RATIOS
}

fn explain(job: &Job, grid: &Grid) -> Intent {
    let search = Search::to(job.tolerance, &*job.scheme);
    let (steps, short, long) = search
        .as_ref()
        .map_or((0, f64::NAN, f64::NAN), |s| (s.steps, s.visible_growth(false), s.visible_growth(true)));
    let long = if search.as_ref().is_ok_and(|search| search.is_long(0.0)) {
        format!(" ({long:.1e} where 3/8 of a trial hold ten periods of the slowest swing)")
    } else {
        String::new()
    };
    let method = format!(
        "{} points to {:e}, by trials of {steps} steps, in which a growth of {short:.1e} a step shows{long} and a \
         slower one may not (stable_at = 0: growth beyond the pair is no faster than that of a motion growing at every \
         step, or the trials are too short to tell); the prediction only says where to look first{}; left out: \
         eigenvectors",
        grid.len() * job.models.len(),
        job.tolerance,
        if is_drawn(grid) { "" } else { ", not drawn" }
    );
    Intent::of(&job.stem, method)
}
