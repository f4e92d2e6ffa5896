//! How fast is a step? Central differences of uniform bars of 100 and 1000 nodes, in cache, against the plain C loop of
//! `analyses/peers/step_speed.c` (compiled here with `cc -O3 -march=native`) and a numpy loop; and of a square of 1e6 unknowns on
//! a wall against reading its stiffness once, and against scipy.sparse. All in one run.
//!
//! Measured: node-steps a second, or seconds a step, the median of repeats that take turns; for the square the most memory
//! that the process held meanwhile, too. A peer whose compiler or interpreter is missing is named, not skipped in silence.

use std::fmt::{Display, Formatter};
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, ExitCode, Stdio};

use analyses::cli::{Verdict, arguments, finish, print_line};
use analyses::error::{Refusal, Result};
use bipenalty::fem::MassMatrix;
use bipenalty::mesh::MeshScene;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::{Bounds, Matrix, Penalty, Pencil};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::schemes::{CentralDifference, ContactRule, Motion, Scheme, System};
use bipenalty::sparse::Csr;
use bipenalty::stability::Model;
use clap::Parser;
use precision::{median, seconds};
use rayon::prelude::*;

/// Nodes of the bars, and node-steps that are timed at once.
const NODES: [usize; 2] = [100, 1000];
const NODE_STEPS: u64 = 50_000_000;

/// Cells along an edge of the square: 999,698 unknowns.
const CELLS: usize = 706;

/// What a step costs: bars beside plain C and numpy, a mesh beside its memory and scipy.sparse.
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
        print_line(&format!("no C peer: {reason}"))?;
    }
    print_line(&format!(
        "{:<12} {:>6} {:>14} {:>14} {:>7}",
        "mass", "nodes", "here, 1/s", "C, 1/s", "ratio"
    ))?;
    let masses = [("lumped", MassMatrix::LUMPED, 1), ("consistent", MassMatrix::CONSISTENT, 10)];
    for ((name, mass, slower), nodes) in masses.into_iter().flat_map(|mass| NODES.map(|nodes| (mass, nodes)))
    {
        let steps = NODE_STEPS / nodes as u64 / slower;
        let mut motion = prepare(nodes, mass, if mass.is_lumped() { 0.5 } else { 0.25 })?;
        let (mut here, mut there) = (Vec::new(), Vec::new());
        for _ in 0..options.repeats {
            here.push((nodes as u64 * steps) as f64 / seconds(|| (0..steps).for_each(|_| motion.step())));
            there.extend(peer.as_ref().ok().and_then(|program| {
                output(Command::new(program).args([name, &nodes.to_string(), &steps.to_string(), "1"]))
            }));
        }
        let here = median(&mut here);
        let beside = match there.is_empty() {
            true => format!("{:>14} {:>7}", "-", "-"),
            false => {
                let there = median(&mut there);
                format!("{there:>14.3e} {:>7.2}", here / there)
            }
        };
        print_line(&format!("{name:<12} {nodes:>6} {here:>14.3e} {beside}"))?;
    }
    if let Ok(program) = peer {
        // A file left in the temporary directory is no failure of the measurement.
        let _ = std::fs::remove_file(program);
    }
    let script = peers().join("step_speed.py");
    let bar = ["bar", &NODES[1].to_string(), "5000", "3"];
    match output(Command::new("python3").arg(script).args(bar)) {
        Some(rate) => print_line(&format!("numpy, lumped, {} nodes: {rate:.3e} 1/s", NODES[1]))?,
        None => print_line("no numpy peer: python3 with numpy was not found")?,
    }
    print_line(&Square::measure(options.repeats)?.to_string())?;
    Ok(Verdict::Holds)
}

/// A square that hits a wall, lumped mass.
struct Square {
    unknowns: usize,
    /// Bytes of K in compressed rows, and of K and M.
    stiffness: usize,
    matrices: usize,
    /// Seconds to read K once, and of a step.
    read: f64,
    step: f64,
    /// Seconds of a step of scipy.sparse; `None` without it.
    peer: Option<f64>,
    /// The most bytes of the process while it stepped; `None` where the system does not tell.
    peak: Option<usize>,
}

impl Square {
    fn measure(repeats: u16) -> Result<Self> {
        let pencil = square()?;
        let Matrix::Sparse(k) = pencil.stiffness() else {
            return Err(Refusal::new("square", "a stiffness without rows", "a sparse one").into());
        };
        let n = pencil.size();
        let time_step = 1.8 / pencil.reference().sqrt();
        let system = System {
            pencil: &pencil,
            penalty: Penalty { stiffness: 1.0, rate: pencil.reference(), ..Penalty::NONE },
            load: Vec::new(),
            time_step,
            critical_step: time_step,
            rule: ContactRule::Unilateral,
            account: false,
        };
        let watched = forget_peak();
        let velocity = (0..n).map(|i| 0.1 * ((i * 37 % 11) as f64 - 5.0)).collect();
        let mut motion = CentralDifference.start(system, vec![0.0; n], velocity)?;
        let mut scipy = Scipy::start();
        let (mut reads, mut steps, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..repeats {
            theirs.extend(scipy.as_mut().and_then(Scipy::step));
            reads.push(seconds(|| _ = black_box(read(k))));
            steps.push(seconds(|| motion.step()));
        }
        let stiffness = 12 * k.len() + 8 * n;
        Ok(Self {
            unknowns: n,
            stiffness,
            matrices: stiffness + 8 * n,
            read: median(&mut reads),
            step: median(&mut steps),
            peer: (!theirs.is_empty()).then(|| median(&mut theirs)),
            peak: watched.then(peak).flatten(),
        })
    }
}

impl Display for Square {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { unknowns, stiffness, matrices, read, step, peer, peak } = self;
        writeln!(f, "square, lumped, {unknowns} unknowns: {:.2} ms a step", 1e3 * step)?;
        let rate = 1e-9 * *stiffness as f64 / read;
        writeln!(
            f,
            "its stiffness read once: {:.2} ms ({rate:.1} GB/s), {:.2} of a step",
            1e3 * read,
            read / step
        )?;
        match peer {
            Some(peer) => {
                writeln!(f, "scipy.sparse: {:.2} ms a step, {:.2} times ours", 1e3 * peer, peer / step)?
            }
            None => writeln!(f, "no scipy peer: python3 with scipy was not found")?,
        }
        match peak {
            Some(peak) => {
                write!(f, "memory while it steps: {:.2} times the matrices", *peak as f64 / *matrices as f64)
            }
            None => write!(f, "memory while it steps: this system does not tell"),
        }
    }
}

/// The same square in Python, which takes a step whenever it is asked.
struct Scipy(Child, BufReader<ChildStdout>);

impl Scipy {
    /// `None` where python3 cannot import scipy.
    fn start() -> Option<Self> {
        let mut python = Command::new("python3");
        python.arg(peers().join("step_speed.py")).args(["square", &(CELLS + 1).to_string()]);
        python.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = python.spawn().ok()?;
        let answers = BufReader::new(child.stdout.take()?);
        let mut scipy = Self(child, answers);
        // The first step waits until the matrix is there.
        scipy.step()?;
        Some(scipy)
    }

    /// Seconds of a step.
    fn step(&mut self) -> Option<f64> {
        let mut answer = String::new();
        writeln!(self.0.stdin.as_mut()?).ok()?;
        self.1.read_line(&mut answer).ok()?;
        answer.trim().parse().ok()
    }
}

impl Drop for Scipy {
    /// It ends with its input.
    fn drop(&mut self) {
        drop(self.0.stdin.take());
        // How it ended says nothing about the steps that it has told.
        let _ = self.0.wait();
    }
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
fn prepare(nodes: usize, mass: MassMatrix, time_step: f64) -> Result<Box<dyn Motion>> {
    let scene = Scene::new("bar", End::Free, vec![Bar::unit(nodes - 1)], End::Free, None)?;
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
    let velocity = (0..nodes).map(|i| 0.1 * ((i * 37 % 11) as f64 - 5.0)).collect();
    let mut motion = CentralDifference.start(system, vec![0.0; nodes], velocity)?;
    motion.step();
    Ok(motion)
}

/// The square; its reference is a bound of the eigenvalues of (K, M).
fn square() -> Result<Pencil> {
    let text = format!(
        "name = \"square\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"square\"\nbox = [1.0, 1.0]\n\
         cells = [{CELLS}, {CELLS}]\nelement = \"quad4\"\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\n\
         [[contact]]\nsurfaces = [\"square.bottom\", \"wall\"]\n"
    );
    let assembled = MeshScene::parse(&text, "square")?.assemble(MassMatrix::LUMPED)?;
    let gaps = assembled.gaps();
    let (stiffness, mass) = (Matrix::Sparse(assembled.stiffness), assembled.mass);
    let diagonal: Vec<f64> = (0..mass.size()).map(|i| mass.diagonal(i)).collect();
    let bounds = Bounds::of_lumped(&stiffness, &diagonal);
    Ok(Pencil::new(stiffness, mass, gaps, bounds, bounds.stiffness)?)
}

/// Reads all of K on all threads, as fast as memory gives it: the bits of its starts, columns and values put together.
fn read(k: &Csr) -> u64 {
    fn of<T: Copy + Sync>(all: &[T], bits: impl Fn(T) -> u64 + Sync) -> u64 {
        let part = |part: &[T]| {
            let (lanes, rest) = part.as_chunks::<16>();
            let mut all = [0; 16];
            for lane in lanes {
                all.iter_mut().zip(lane).for_each(|(all, x)| *all ^= bits(*x));
            }
            all.into_iter().chain(rest.iter().map(|x| bits(*x))).fold(0, |a, b| a ^ b)
        };
        all.par_chunks(1 << 16).map(part).reduce(|| 0, |a, b| a ^ b)
    }
    let (starts, columns, values) = k.parts();
    of(starts, |x| x as u64) ^ of(columns, u64::from) ^ of(values, f64::to_bits)
}

/// Lets the system count the most memory of this process anew; whether it does.
fn forget_peak() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// The most bytes that this process has held since.
fn peak() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<usize>().ok().map(|kilobytes| kilobytes << 10)
}
