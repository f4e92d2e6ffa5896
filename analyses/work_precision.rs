//! What does a digit cost? Error against run time, for the largest eigenvalue and for impacts stepped in time.
//!
//! Largest eigenvalue: every engine, LAPACK (with the feature `lapack`), scipy, and what codes use instead (bounds from
//! elements and rows, power and Lanczos iterations) on four pencils of 10 to 1e5 elements, against values of 34 digits.
//! Impacts: three schemes, three mass matrices, meshes and steps on the problems of the paper, and a numpy loop, against
//! d'Alembert's solutions. An error comes from one run, a time is the smallest of others, one at a time with nothing
//! recorded. What fails or takes too long stays in the table.

use std::process::ExitCode;
use std::time::Duration;

use analyses::charts;
use analyses::cli::{
    Analysis, Frame, Intent, Output, OutputOptions, Peers, Progress, Verdict, machine, narrate, print_table,
    restarted_with_one_blas_thread,
};
use analyses::error::Result;
use bipenalty::fem::MassMatrix;
use bipenalty::schemes::SchemeName;
use clap::Parser;
use figure::{Figure, Scale};
use precision::{
    Clock, EIGENPROBLEMS, ExactEigenvalues, Impactproblem, Measurement, Method, SCENES, SIZES, Status,
    distinct, mark_front, markdown, measure_eigenvalues, measure_impacts,
};

/// Error against run time of every engine and scheme, beside peers; exit status 1 if an engine errs more than it claims.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    /// Fewer sizes and repeats: 20 s instead of 5 min
    #[arg(long)]
    quick: bool,
    /// A Python with scipy whose times join the table, or none [default: python3 if it has scipy]
    #[arg(long, value_name = "PYTHON")]
    peers: Option<String>,
    #[command(flatten)]
    output: OutputOptions,
}

const EXAMPLES: &str = "Examples:
  work-precision                                 everything, best on an idle machine
  work-precision --quick --peers none            a part of it, without scipy";

/// How much is measured.
struct Amount {
    clock: Clock,
    sizes: &'static [usize],
    elements: &'static [usize],
    courants: &'static [f64],
    peers_limit: Duration,
}

const FULL: Amount = Amount {
    clock: Clock::FULL,
    sizes: &SIZES,
    elements: &[25, 50, 100, 200, 400, 800],
    courants: &[0.25, 0.5, 0.9],
    peers_limit: Duration::from_secs(90),
};

const QUICK: Amount = Amount {
    clock: Clock::QUICK,
    // Evaluated by the compiler: fewer than three sizes would not build.
    sizes: SIZES.first_chunk::<3>().unwrap(),
    elements: &[25, 50, 100],
    courants: &[0.5],
    peers_limit: Duration::from_secs(8),
};

/// The impacts to step, and who else measures.
struct Plan {
    amount: &'static Amount,
    impacts: Vec<Impactproblem>,
    peers: Option<Peers>,
}

fn main() -> ExitCode {
    restarted_with_one_blas_thread().unwrap_or_else(narrate::<Options>)
}

impl Analysis for Options {
    const NAME: &'static str = "work-precision";
    type Plan = Plan;
    type Found = Vec<Measurement>;

    fn output(&self) -> &OutputOptions {
        &self.output
    }

    fn plan(&self) -> Result<Plan> {
        let amount = if self.quick { &QUICK } else { &FULL };
        Ok(Plan { amount, impacts: impacts(amount)?, peers: Peers::find(self.peers.as_deref())? })
    }

    fn explain(&self, plan: &Plan) -> Result<Vec<Intent>> {
        Ok(explain(plan.amount, plan.impacts.len(), plan.peers.is_some()))
    }

    fn folder(&self) -> String {
        if self.quick { "quick".to_owned() } else { String::new() }
    }

    fn frames(&self, _plan: &Plan) -> Vec<Frame> {
        let stepping = SCENES.iter().map(|scene| format!("stepping-{scene}"));
        let stems = ["eigenvalue-error", "eigenvalue-time"].map(str::to_owned).into_iter().chain(stepping);
        stems.map(|stem| Frame::new(stem, Scale::Log, Scale::Log)).collect()
    }

    fn compute(&self, plan: Plan, output: &Output) -> Result<(Self::Found, usize)> {
        let quiet = self.output.quiet;
        let mut measurements = measure(plan.amount, &plan.impacts, quiet)?;
        if let Some(peers) = plan.peers {
            measurements.extend(measure_peers(&peers, plan.amount, self)?);
        } else if !quiet {
            analyses::tell!("peers left out: python3 cannot import scipy (--peers names another Python)");
        }
        mark_front(&mut measurements);
        let files = write(output, plan.amount, &measurements)?;
        Ok((measurements, files))
    }

    fn print(&self, measurements: &Vec<Measurement>, output: &Output) -> Result<()> {
        output.print(measurements)
    }

    fn summarise(&self, measurements: &Vec<Measurement>) {
        summarise(measurements);
    }

    fn verdict(&self, measurements: &Vec<Measurement>) -> Verdict {
        let wrong = measurements.iter().any(|m| matches!(m.status, Status::Wrong(_)));
        if wrong { Verdict::Fails } else { Verdict::Holds }
    }
}

/// Scenes x masses x schemes x meshes x steps.
fn impacts(amount: &Amount) -> Result<Vec<Impactproblem>> {
    let mut impacts = Vec::new();
    for scene in SCENES {
        for mass in [MassMatrix::LUMPED, MassMatrix::AVERAGED, MassMatrix::CONSISTENT] {
            for scheme in SchemeName::PAPER {
                for courant in amount.courants {
                    for elements in amount.elements {
                        impacts.push(Impactproblem::new(scene, mass, scheme, *elements, *courant)?);
                    }
                }
            }
        }
    }
    Ok(impacts)
}

/// Everything that this crate can do itself.
fn measure(amount: &Amount, impacts: &[Impactproblem], quiet: bool) -> Result<Vec<Measurement>> {
    let eigenvalues = EIGENPROBLEMS.len() * amount.sizes.len() * Method::ALL.len();
    let progress = Progress::new(eigenvalues + 2 * impacts.len(), "runs", quiet);
    let done = || progress.add(1);
    let exact = ExactEigenvalues::built_in();
    let mut measurements = Vec::new();
    for name in EIGENPROBLEMS {
        progress.doing(name);
        measurements.extend(measure_eigenvalues(
            name,
            amount.sizes,
            Method::ALL,
            &exact,
            &amount.clock,
            &done,
        )?);
    }
    progress.doing("impacts");
    measurements.extend(measure_impacts(impacts, &amount.clock, &done)?);
    Ok(measurements)
}

/// scipy and numpy, by a script of their own.
fn measure_peers(peers: &Peers, amount: &Amount, options: &Options) -> Result<Vec<Measurement>> {
    let progress = Progress::new(0, "scripts", options.output.quiet);
    progress.doing("scipy and numpy");
    let arguments: &[&str] = if options.quick { &["--quick"] } else { &[] };
    let script = include_str!("peers/work_precision.py");
    let rows = peers.run(script, arguments, ExactEigenvalues::built_in().text(), amount.peers_limit)?;
    drop(progress);
    if let Some(why) = rows.broken_off {
        analyses::tell!("the peers were broken off: {why}; the table has the rows before that");
    }
    Ok(rows.measurements)
}

fn write(output: &Output, amount: &Amount, measurements: &[Measurement]) -> Result<usize> {
    const RECORDS: &str = "work-precision";
    let mut files = output.write_rows(RECORDS, measurements)?.len();
    files += output.write_markdown(RECORDS, &markdown(measurements, &machine()))?.len();
    if output.wants_figures() {
        let draw = |stem: &str, figure: &Figure| output.write_figure_from(RECORDS, stem, figure);
        let size = amount.sizes.iter().copied().filter(|size| *size <= 1000).max().unwrap_or(amount.sizes[0]);
        let figure = charts::precision::eigenvalue_errors(measurements, size);
        files += draw("eigenvalue-error", &figure)?.len();
        files += draw("eigenvalue-time", &charts::precision::eigenvalue_times(measurements))?.len();
        for scene in SCENES {
            let figure = charts::precision::impact_errors(measurements, scene);
            files += draw(&format!("stepping-{scene}"), &figure)?.len();
        }
    }
    Ok(files)
}

fn explain(amount: &Amount, impacts: usize, peers: bool) -> Vec<Intent> {
    let methods: Vec<String> = Method::ALL.iter().map(|method| method.name()).collect();
    let eigenvalues = format!(
        "{} on {} with {:?} elements, against tests/data/work_precision.csv",
        methods.join(", "),
        EIGENPROBLEMS.join(", "),
        amount.sizes,
    );
    let impacts = format!(
        "{impacts} ({}; three mass matrices, three schemes, {:?} elements, C = {:?}), beta_s = 1e4, r = 1, against d'Alembert",
        SCENES.join(", "),
        amount.elements,
        amount.courants,
    );
    let times = format!(
        "the smallest of at least 3 runs, one at a time; left out: runs of more than {} s, recording while timed",
        amount.clock.limit,
    );
    let peers = if peers { "scipy and numpy, by analyses/peers/work_precision.py" } else { "none" };
    [("eigenvalues", eigenvalues), ("impacts", impacts), ("peers", peers.to_owned()), ("times", times)]
        .map(|(subject, method)| Intent::of(subject, method))
        .into()
}

/// One line a method: how many measurements are done, on the front, not done.
fn summarise(measurements: &[Measurement]) {
    let methods = distinct(measurements.iter().map(|m| m.method.as_str()));
    let header = ["method", "measured", "on a front", "largest |error|", "failed", "timed out", "WRONG"];
    let line = |method: &&str| {
        let of: Vec<&Measurement> = measurements.iter().filter(|m| m.method == *method).collect();
        let count = |test: &dyn Fn(&Measurement) -> bool| of.iter().filter(|m| test(m)).count().to_string();
        let errors = of.iter().filter_map(|m| m.error).map(f64::abs);
        vec![
            method.to_string(),
            count(&|m| m.status == Status::Done),
            count(&|m| m.on_front),
            errors.reduce(f64::max).map_or_else(|| "-".to_owned(), |error| format!("{error:.1e}")),
            count(&|m| matches!(m.status, Status::Failed(_))),
            count(&|m| matches!(m.status, Status::TimedOut(_))),
            count(&|m| matches!(m.status, Status::Wrong(_))),
        ]
    };
    print_table(&header, methods.iter().map(line));
    for m in measurements.iter().filter(|m| matches!(m.status, Status::Wrong(_))) {
        analyses::tell!(
            "{}, {}, {} elements: {} (error {:?})",
            m.problem,
            m.method,
            m.size,
            m.status,
            m.error
        );
    }
}
