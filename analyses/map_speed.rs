//! What does one point of a stability map cost, and what would it cost with an eigenvalue solver?
//!
//! A map asks for l_max at a million penalties of one scene. Here the engines, LAPACK (with the feature `lapack`) and
//! numpy/scipy (where python3 can import scipy) are timed in one run on one machine, each on one core unless a line
//! says otherwise: medians of repeated runs, from the same matrices, with nothing else counted. The last lines hold the
//! results against what is expected of the closed form; the exit status is 1 where one is missed.

use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use analyses::cli::{Verdict, arguments, finish, print_line, restarted_with_one_blas_thread};
use analyses::error::Result;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Penalty;
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::spectrum::{Engine, Spectrum};
use bipenalty::stability::{EngineName, Grid, Model, Sweep, map};
use clap::Parser;
use precision::{median, seconds};

/// Cost of a point of a stability map: the engines, LAPACK and scipy beside each other.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    /// Points along each axis of the timed maps
    #[arg(long, value_name = "N", default_value_t = 1000)]
    points: usize,
}

const EXAMPLES: &str = "Examples:
  map-speed               maps of 1000 x 1000 points
  map-speed --points 100  quicker and less sure";

const MASSES: [MassMatrix; 3] = [MassMatrix::LUMPED, MassMatrix::AVERAGED, MassMatrix::CONSISTENT];

/// A method and its time a point.
struct Timing {
    method: String,
    problem: String,
    seconds: f64,
}

/// The table, printed as it grows.
#[derive(Default)]
struct Table(Vec<Timing>);

impl Table {
    fn add(&mut self, method: &str, problem: &str, seconds: f64) -> Result<f64> {
        print_line(&format!("{method:<40} {problem:<44} {:>13.1}", seconds * 1e9))?;
        self.0.push(Timing { method: method.to_owned(), problem: problem.to_owned(), seconds });
        Ok(seconds)
    }

    /// The quickest of the methods whose name begins so, on problems whose name begins so.
    fn best(&self, method: &str, problem: &str) -> Option<f64> {
        let fits = |t: &&Timing| t.method.starts_with(method) && t.problem.starts_with(problem);
        self.0.iter().filter(fits).map(|t| t.seconds).reduce(f64::min)
    }
}

fn main() -> ExitCode {
    if let Some(code) = restarted_with_one_blas_thread() {
        return code;
    }
    finish(run(&arguments::<Options>()))
}

const BLAS_THREADS: &str = "OPENBLAS_NUM_THREADS";

fn run(options: &Options) -> Result<Verdict> {
    let beta_s = Sweep::log(1e-3, 1e12, options.points)?;
    let grid = Grid::new(&beta_s, &Sweep::log(0.1, 1e3, options.points)?)?;
    print_line(&format!("{:<40} {:<44} {:>13}", "method", "problem", "ns a point"))?;
    let mut table = Table::default();
    let bare = closed_form_points(&grid, &mut table)?;
    sizes(&mut table)?;
    let certified = certified_maps(&grid, &mut table)?;
    let unequal = unequal_bars(&grid, &mut table)?;
    engines(&mut table)?;
    #[cfg(feature = "lapack")]
    lapack::routines(&mut table, &bar_on_wall(100, MassMatrix::CONSISTENT)?)?;
    if !cfg!(feature = "lapack") {
        print_line("LAPACK: not built in (--features lapack)")?;
    }
    scipy(&mut table)?;
    conclude(&table, bare, certified, unequal)
}

/// The middle of the times of repeated runs: at least 3, at most 25, for about half a second.
fn typical(mut run: impl FnMut()) -> f64 {
    run();
    let begun = Instant::now();
    let mut times = Vec::new();
    while times.len() < 3 || (times.len() < 25 && begun.elapsed() < Duration::from_millis(500)) {
        times.push(seconds(&mut run));
    }
    median(&mut times)
}

/// One bar of unit elements, free on the left, on a wall on the right.
fn bar_on_wall(elements: usize, mass: MassMatrix) -> Result<Model> {
    let scene = Scene::new("signorini", End::Free, vec![Bar::unit(elements)], End::Wall, None)?;
    Ok(Model::new(scene, mass, PenaltyMass::Consistent))
}

/// Calls `point` for all penalties of the grid, curve by curve, and returns a sum that keeps the work alive.
fn over(grid: &Grid, mut point: impl FnMut(StiffnessPenalty, Ratio) -> f64) -> f64 {
    let mut sum = 0.0;
    for ratio in &grid.ratios {
        for beta_s in &grid.stiffness_penalties {
            sum += point(*beta_s, *ratio);
        }
    }
    sum
}

/// Seconds a point on one core for the values that `value` finds.
fn per_point(model: &Model, grid: &Grid, value: impl Fn(&Penalty) -> f64) -> f64 {
    let mut pass = || {
        let sum = over(grid, |beta_s, ratio| value(&model.penalty(beta_s, ratio)));
        std::hint::black_box(sum);
    };
    typical(&mut pass) / grid.len() as f64
}

/// l_max with its certificate.
fn certified(engine: &dyn Engine, penalty: &Penalty) -> f64 {
    engine.enclose(penalty, None).map_or(f64::NAN, |l| l.value)
}

/// The closed form on the map, one core; returns the slowest time without certificates.
fn closed_form_points(grid: &Grid, table: &mut Table) -> Result<f64> {
    let mut slowest: f64 = 0.0;
    for mass in MASSES {
        let model = bar_on_wall(100, mass)?;
        let engine = model.closed_form();
        let problem = format!("map, 100 elements, {}", mass.name());
        let bare = per_point(&model, grid, |penalty| engine.unproven(penalty));
        slowest = slowest.max(table.add("closed-form", &problem, bare)?);
        let enclosed = per_point(&model, grid, |penalty| certified(&engine, penalty));
        table.add("closed-form certified", &problem, enclosed)?;
    }
    Ok(slowest)
}

/// The cost of a point does not grow with the number of elements.
fn sizes(table: &mut Table) -> Result<()> {
    let grid = Grid::new(&Sweep::log(1e-3, 1e12, 200)?, &Sweep::log(0.1, 1e3, 200)?)?;
    for elements in [10, 1000, 1_000_000] {
        let model = bar_on_wall(elements, MassMatrix::CONSISTENT)?;
        let engine = model.closed_form();
        let problem = format!("map, {elements} elements, consistent");
        table.add("closed-form", &problem, per_point(&model, &grid, |penalty| engine.unproven(penalty)))?;
        let enclosed = per_point(&model, &grid, |penalty| certified(&engine, penalty));
        table.add("closed-form certified", &problem, enclosed)?;
    }
    Ok(())
}

/// Seconds for the whole certified maps of all mass types, on all cores.
fn certified_maps(grid: &Grid, table: &mut Table) -> Result<f64> {
    let mut total = 0.0;
    for mass in MASSES {
        let model = bar_on_wall(100, mass)?;
        let limit = Spectrum(Box::new(model.closed_form()));
        let seconds = typical(|| drop(std::hint::black_box(map(&model, grid, &limit, &|_| ()))));
        let problem = format!("map, 100 elements, {}, all cores", mass.name());
        table.add("closed-form certified", &problem, seconds / grid.len() as f64)?;
        total += seconds;
    }
    Ok(total)
}

/// Two unequal bars of 1e4 elements, certified, on all cores; returns the slower of the two engines in seconds.
fn unequal_bars(grid: &Grid, table: &mut Table) -> Result<f64> {
    let bars = vec![Bar::unit(10_000), Bar { youngs_modulus: 2.0, area: 3.0, ..Bar::unit(10_000) }];
    let scene = Scene::new("unequal", End::Free, bars, End::Free, None)?;
    let model = Model::new(scene, MassMatrix::CONSISTENT, PenaltyMass::Consistent);
    let pencil = model.pencil();
    let mut slower: f64 = 0.0;
    for name in [EngineName::ClosedForm, EngineName::Secular] {
        // The secular function is compressed anew in every run: the time is that of a map from scratch.
        model.engine(name, &pencil)?;
        let seconds = typical(|| {
            let limit = model.engine(name, &pencil).map(Spectrum);
            drop(std::hint::black_box(limit.map(|limit| map(&model, grid, &limit, &|_| ()))));
        });
        let method = format!("{} certified", name.text());
        table.add(&method, "unequal bars, 2 x 1e4 elements, all cores", seconds / grid.len() as f64)?;
        slower = slower.max(seconds);
    }
    Ok(slower)
}

/// The engines that work on the assembled pencil, at single penalties.
fn engines(table: &mut Table) -> Result<()> {
    let grid = Grid::new(&Sweep::list([0.1, 10.0, 1e6]), &Sweep::list([0.5, 2.0]))?;
    for elements in [10, 100] {
        let model = bar_on_wall(elements, MassMatrix::CONSISTENT)?;
        let pencil = model.pencil();
        for name in [EngineName::Secular, EngineName::Sturm, EngineName::Dense] {
            let engine = model.engine(name, &pencil)?;
            let seconds = per_point(&model, &grid, |penalty| certified(&*engine, penalty));
            table.add(name.text(), &format!("single points, {elements} elements, consistent"), seconds)?;
        }
    }
    Ok(())
}

#[cfg(feature = "lapack")]
mod lapack {
    use bipenalty::spectrum::lapack::{BandMatrix, dsbgvx_largest, dsygvx_largest, gap_matrices};

    use super::*;

    /// LAPACK's own routines for the largest eigenvalue; a call includes the copy of the matrices that it destroys.
    pub fn routines(table: &mut Table, model: &Model) -> Result<()> {
        let penalty = model.penalty(StiffnessPenalty::new(10.0)?, Ratio::new(2.0)?);
        let (k, m) = gap_matrices(&model.pencil(), &penalty);
        let (band_k, band_m) = (BandMatrix::of(&k), BandMatrix::of(&m));
        let problem = "100 elements, consistent";
        let full = typical(|| repeat(20, || dsygvx_largest(k.clone(), m.clone()))) / 20.0;
        table.add("LAPACK dsygvx, largest only", problem, full)?;
        let banded = typical(|| repeat(200, || dsbgvx_largest(band_k.clone(), band_m.clone()))) / 200.0;
        table.add("LAPACK dsbgvx, largest only", problem, banded)?;
        Ok(())
    }

    fn repeat(times: usize, call: impl Fn() -> Option<f64>) {
        (0..times).for_each(|_| {
            std::hint::black_box(call());
        });
    }
}

/// numpy and scipy, timed by their own script in the same run; only the solver counts, without its start-up.
fn scipy(table: &mut Table) -> Result<()> {
    let script = include_str!("peers/eigh_speed.py");
    let output = Command::new("python3").args(["-c", script, "100"]).env(BLAS_THREADS, "1").output();
    let text = match output {
        Ok(output) if output.status.success() => String::from_utf8_lossy(&output.stdout).into_owned(),
        _ => return print_line("scipy: not timed (python3 cannot import it)"),
    };
    for line in text.lines() {
        let field: Vec<&str> = line.split('|').collect();
        if let [method, seconds, _] = field[..]
            && let Ok(seconds) = seconds.parse()
        {
            table.add(method, "100 elements, consistent", seconds)?;
        }
    }
    Ok(())
}

/// Says whether the closed form is as quick as it should be.
fn conclude(table: &Table, bare: f64, certified: f64, unequal: f64) -> Result<Verdict> {
    let closed_form = table.best("closed-form", "map, 100 elements, consistent").unwrap_or(f64::NAN);
    let mut holds = true;
    let mut state = |what: &str, value: f64, unit: &str, wanted: f64, at_least: bool| {
        let met = if at_least { value >= wanted } else { value <= wanted };
        let (sign, verdict) = (if at_least { ">=" } else { "<=" }, if met { "holds" } else { "MISSED" });
        holds &= met;
        print_line(&format!("{what:<64} {value:>9.3} {unit:<4} {sign} {wanted:<6} {verdict}"))
    };
    print_line("")?;
    state("closed form without certificates, slowest mass, a point and core", bare * 1e9, "ns", 60.0, false)?;
    state("three certified maps, 100 elements, all cores", certified, "s", 1.0, false)?;
    state("one certified map, unequal bars, slower engine", unequal, "s", 3.0, false)?;
    if let Some(eigh) = table.best("scipy eigh", "100 elements") {
        state("scipy eigh against the closed form", eigh / closed_form, "", 5000.0, true)?;
    }
    if let Some(banded) = table.best("LAPACK dsbgvx", "100 elements") {
        state("best banded LAPACK against the closed form", banded / closed_form, "", 500.0, true)?;
    }
    Ok(if holds { Verdict::Holds } else { Verdict::Fails })
}
