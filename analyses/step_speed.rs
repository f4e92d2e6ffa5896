//! How fast is a step? Central differences of a uniform bar of 1000 nodes, in cache, against the plain C loop of
//! `analyses/peers/step_speed.c` (compiled here with `cc -O3 -march=native`) and a numpy loop, in one run.
//!
//! Measured: node-steps a second, the median of repeats that take turns. A peer whose compiler or interpreter is missing is
//! named, not skipped in silence.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use analyses::cli::{Verdict, arguments, finish};
use analyses::error::Result;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Penalty;
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::{CentralDifference, ContactRule, Motion, Scheme, System};
use bipenalty::stability::Model;
use clap::Parser;
use precision::{median, seconds};

const NODES: usize = 1000;
const STEPS: u64 = 50_000;

/// Node-steps a second of central differences beside plain C and numpy.
#[derive(Debug, Parser)]
#[command(version, after_help = EXAMPLES)]
struct Options {
    /// Timed runs, which take turns with those of the C peer; the median counts
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
}

const EXAMPLES: &str = "Examples:
  step-speed
  step-speed --repeats 3  quicker and less sure";

fn main() -> ExitCode {
    finish(compare(&arguments::<Options>()))
}

fn compare(options: &Options) -> Result<Verdict> {
    let peer = compile_peer();
    if let Err(reason) = &peer {
        println!("no C peer: {reason}");
    }
    println!("{:<12} {:>14} {:>14} {:>7}", "mass", "here, 1/s", "C, 1/s", "ratio");
    let cases = [("lumped", MassMatrix::LUMPED, STEPS), ("consistent", MassMatrix::CONSISTENT, STEPS / 10)];
    for (name, mass, steps) in cases {
        let mut motion = prepare(mass, if mass.is_lumped() { 0.5 } else { 0.25 })?;
        let (mut here, mut there) = (Vec::new(), Vec::new());
        for _ in 0..options.repeats {
            here.push(rate(&mut *motion, steps));
            there.extend(peer.as_ref().ok().and_then(|program| {
                output(Command::new(program).args([name, &NODES.to_string(), &steps.to_string(), "1"]))
            }));
        }
        let here = median(&mut here);
        match there.is_empty() {
            true => println!("{name:<12} {here:>14.3e} {:>14} {:>7}", "-", "-"),
            false => {
                let there = median(&mut there);
                println!("{name:<12} {here:>14.3e} {there:>14.3e} {:>7.2}", here / there);
            }
        }
    }
    if let Ok(program) = peer {
        // A file left in the temporary directory is no failure of the measurement.
        let _ = std::fs::remove_file(program);
    }
    let script = peers().join("step_speed.py");
    let numpy = output(Command::new("python3").arg(script).args([&NODES.to_string(), "5000", "3"]));
    match numpy {
        Some(rate) => println!("numpy, lumped: {rate:.3e} 1/s"),
        None => println!("no numpy peer: python3 with numpy was not found"),
    }
    Ok(Verdict::Holds)
}

fn peers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("peers")
}

/// The compiled C peer, or why there is none.
fn compile_peer() -> Result<PathBuf, String> {
    let program = std::env::temp_dir().join(format!("bipenalty-step-speed-{}", std::process::id()));
    let mut compiler = Command::new("cc");
    compiler.args(["-O3", "-march=native", "-o"]).arg(&program).arg(peers().join("step_speed.c"));
    match compiler.output() {
        Ok(done) if done.status.success() => Ok(program),
        Ok(done) => Err(String::from_utf8_lossy(&done.stderr).into_owned()),
        Err(error) => Err(format!("cc: {error}")),
    }
}

/// The first number that a command prints.
fn output(command: &mut Command) -> Option<f64> {
    let done = command.output().ok().filter(|done| done.status.success())?;
    String::from_utf8_lossy(&done.stdout).split_whitespace().next()?.parse().ok()
}

/// A free bar of unit elements in unsteady motion.
fn prepare(mass: MassMatrix, time_step: f64) -> Result<Box<dyn Motion>> {
    let scene = Scene::new("bar", End::Free, vec![Bar::unit(NODES - 1)], End::Free, None)?;
    let pencil = Model::new(scene, mass, PenaltyMass::Consistent).pencil();
    let system = System {
        pencil: &pencil,
        penalty: Penalty::NONE,
        load: Vec::new(),
        time_step,
        critical_step: 1.0,
        rule: ContactRule::Unilateral,
        account: false,
    };
    let velocity = (0..NODES).map(|i| 0.1 * ((i * 37 % 11) as f64 - 5.0)).collect();
    let mut motion = CentralDifference.start(system, vec![0.0; NODES], velocity)?;
    motion.step();
    Ok(motion)
}

fn rate(motion: &mut dyn Motion, steps: u64) -> f64 {
    (NODES as u64 * steps) as f64 / seconds(|| (0..steps).for_each(|_| motion.step()))
}
