//! The driver: f enclosed wherever it is asked, by as few eigenproblems and proofs as it takes.

use super::chance::Chance;
use super::factor::{TooLarge, Verdict};
use super::lanczos::Search;
use super::patches::Patches;
use super::pencil::MeshPencil;
use super::source::{Local, Source};
use super::span::Line;
use super::start::{self, Start};
use super::upper::{ProvenPoint, Upper};
use super::whole::Whole;
use crate::error::Refusal;
use crate::interrupt;

/// What proves that u M - a K - t P is semidefinite.
#[derive(Debug)]
pub enum Prover {
    /// A sparse Cholesky of the whole matrix.
    Whole(Box<Whole>),
    /// One small Cholesky for each patch of elements: a bound that is too high by what the patch is too small.
    Patches(Box<Patches>),
    /// Nothing: each bound holds except with a small probability.
    Chance(Box<Chance>),
}

impl Prover {
    /// A factorisation of the whole matrix, which may take `allowed` bytes.
    ///
    /// # Errors
    /// It would take more.
    pub fn whole(pencil: &MeshPencil, allowed: usize) -> Result<Self, Refusal> {
        match Whole::new(pencil, allowed) {
            Ok(whole) => Ok(Self::Whole(Box::new(whole))),
            Err(TooLarge { needed, allowed }) => Err(Refusal::new(
                "memory of the factorisation",
                format!("{needed} bytes"),
                format!("at most {allowed} bytes"),
            )),
        }
    }

    /// Bytes of the factors that are held at a time at most.
    pub fn memory(&self) -> usize {
        match self {
            Self::Whole(whole) => whole.memory(),
            Self::Patches(patches) => patches.memory(),
            Self::Chance(_) => 0,
        }
    }

    pub(super) fn prove(&self, u: f64, (a, t): (f64, f64), margin: f64) -> Verdict {
        interrupt::look();
        match self {
            Self::Whole(whole) => whole.prove(u, (a, t), margin),
            Self::Patches(patches) => patches.prove(u, a, t, margin),
            Self::Chance(chance) => chance.prove(u, (a, t)),
        }
    }
}

impl Prover {
    /// Whether K + e M is proven to be positive semidefinite; evidence by chance, which takes that on trust, proves it of nothing.
    pub fn resists(&self, e: f64) -> bool {
        if matches!(self, Self::Chance(_)) {
            return false;
        }
        let mut margin = LEAST_MARGIN;
        while margin < 1.0 {
            match self.prove(e, (-1.0, 0.0), margin) {
                Verdict::Proven => return true,
                Verdict::Refuted => return false,
                Verdict::TooClose(needed) => margin = f64::max(2.0 * needed, 2.0 * margin),
            }
        }
        false
    }

    /// A q with M >= diag(M)/q; `None` where M is no better conditioned in its diagonal than 2^13, or not definite.
    pub fn condition(&self, diagonal: bool) -> Option<f64> {
        if diagonal {
            return Some(1.0);
        }
        // D M D >= e I with D^2 diag(M) >= 1/2.
        (2..13).map(|power| f64::from(-power).exp2()).find(|e| self.proves_mass(*e)).map(|e| 2.0 / e)
    }

    fn proves_mass(&self, share: f64) -> bool {
        match self {
            Self::Whole(whole) => whole.proves_mass(share, (1.0 + LEAST_MARGIN) * share),
            Self::Patches(patches) => patches.proves_mass(share),
            Self::Chance(_) => false,
        }
    }
}

/// The part that rounding is tried to get along with first.
const LEAST_MARGIN: f64 = 1e-3;

/// How to enclose f.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// The widest enclosure of a time step, relative: half of that of its eigenvalue.
    pub tolerance: f64,
    /// Bytes that one factor may take.
    pub memory: usize,
    /// Vectors in a Lanczos basis.
    pub basis: usize,
    /// Products with K that one eigenproblem may take.
    pub most_products: usize,
}

impl Default for Options {
    /// A map: steps to a thousandth.
    fn default() -> Self {
        Self { tolerance: 1e-3, memory: 4 << 30, basis: 40, most_products: 4000 }
    }
}

/// What it took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Effort {
    /// Eigenproblems solved.
    pub eigenproblems: usize,
    /// Products with K.
    pub products: usize,
    /// Proofs tried.
    pub proofs: usize,
    /// Of them, those that failed.
    pub failed: usize,
    /// Bytes of one factor.
    pub memory: usize,
}

/// How closely the excess of a bound by patches is looked for, relative to itself.
const CLOSELY: f64 = 0.05;

/// Points of patches that are nearer than this, in units of t, are one: f moves by no more, patches are too high by more.
const SAME: f64 = 1e-8;

/// f of one pencil, with all that is known about it so far. The pencil may lie anywhere: see [`Source`].
#[derive(Debug)]
pub struct Curve<S = Local> {
    pub(super) source: S,
    pub(super) options: Options,
    pub(super) lines: Vec<Line>,
    pub(super) upper: Upper,
    pub(super) effort: Effort,
    /// f(0) from below, and the t at which contact and mesh weigh alike, f(0)/mu.
    mesh: f64,
    pub(super) unit: f64,
    /// How much higher than its lower bound the last bound by patches was, relative.
    excess: f64,
    /// Points that patches or chance have proven, with the width asked for then: they prove no more a second time.
    sought: Vec<(ProvenPoint, f64)>,
}

impl Curve {
    /// The curve of a pencil, proven by factorising the whole matrix.
    ///
    /// # Errors
    /// M is not positive definite, the factor needs more than the allowed memory, or mu could not be proven.
    pub fn new(pencil: &MeshPencil, options: Options) -> Result<Self, Refusal> {
        Self::with(pencil, Prover::whole(pencil, options.memory)?, options)
    }

    /// The curve of a pencil, proven by a prover of one's choice.
    ///
    /// # Errors
    /// As [`Curve::new`].
    pub fn with(pencil: &MeshPencil, prover: Prover, options: Options) -> Result<Self, Refusal> {
        Self::begin(Start::new(pencil, &options)?, prover, options)
    }

    /// The curve that begins with a start.
    ///
    /// # Errors
    /// mu could not be proven.
    pub fn begin(start: Start, prover: Prover, options: Options) -> Result<Self, Refusal> {
        let memory = prover.memory();
        let mut curve = Self::of(Local::new(start, prover), options)?;
        curve.effort.memory = memory;
        Ok(curve)
    }

    /// What is left between f(0) and its proof, relative; of patches and chance, which reach no such digits, nothing.
    pub fn mesh_error(&self) -> f64 {
        match self.prover() {
            Prover::Whole(_) => (self.upper.at(0.0, self.mesh) / self.mesh - 1.0).max(0.0),
            Prover::Patches(_) | Prover::Chance(_) => 0.0,
        }
    }

    /// What proves.
    pub fn prover(&self) -> &Prover {
        &self.source.prover
    }

    /// The vector of the largest Ritz value at t, x'Mx = 1 up to rounding: who governs the step there.
    pub fn mode(&self, t: f64) -> Vec<f64> {
        self.source.subspace.vector(&self.source.span().ritz(t))
    }
}

impl<S: Source> Curve<S> {
    /// The curve of a pencil that lies anywhere. The span of the source holds its top vector at t = 0, and no other.
    ///
    /// # Errors
    /// mu could not be proven.
    pub fn of(source: S, options: Options) -> Result<Self, Refusal> {
        let (upper, effort) = (Upper::new(f64::INFINITY), Effort::default());
        let mut curve = Self {
            source,
            options,
            lines: Vec::new(),
            upper,
            effort,
            mesh: f64::NAN,
            unit: 1.0,
            excess: 0.0,
            sought: Vec::new(),
        };
        if curve.dimension() > 0 {
            curve.mesh = curve.lower_at(0.0);
        }
        curve.ends()?;
        Ok(curve)
    }

    /// mu = l_max(P, M) and f(0), both proven.
    fn ends(&mut self) -> Result<(), Refusal> {
        let mut slope = 0.0;
        if self.source.has_contacts() {
            let found = self.source.seek((0.0, 1.0), None, &start::search(&self.options));
            // Not closer than 1e-9 at first: mu bounds slopes, and what it has too much no map asks for.
            slope = self.climb(found.value, (0.0, 1.0), found.residual.max(1e-9 * found.value)).ok_or_else(
                || {
                    Refusal::new(
                        "mass matrix",
                        "a matrix that is not positive definite, or too close to it",
                        "a positive definite mass matrix",
                    )
                },
            )?;
        }
        self.upper = Upper::new(slope);
        self.lower_at(0.0);
        self.unit = if slope > 0.0 { self.mesh.abs().max(f64::MIN_POSITIVE) / slope } else { 1.0 };
        if self.mesh.is_nan() || self.mesh <= 0.0 {
            self.unit = 1.0;
        }
        let asked = self.options.tolerance;
        if self.source.is_sharp() {
            self.options.tolerance = asked.min(start::CLOSEST);
        }
        self.prove(0.0);
        self.options.tolerance = asked;
        Ok(())
    }

    /// The smallest of the values start + 1, 4, 16 .. times `step` that can be proven to bound l_max(a K + t P, M); of
    /// patches and chance, which are too high by their nature, how far is then looked for to a part of [`CLOSELY`].
    fn climb(&mut self, start: f64, combination: (f64, f64), step: f64) -> Option<f64> {
        let (least, mut step, mut margin, mut failed) = (step, step, 0.05 * step / start, 0.0);
        let mut proven = None;
        // Patches are too high by a part that varies slowly: the last one is nearly right.
        let mut growth: f64 = 4.0;
        if !self.source.is_sharp() && combination.0 != 0.0 && self.excess * start > step {
            (step, growth) = (self.excess * start, 1.0 + CLOSELY);
        }
        let mut shrink = growth;
        // 4^24 > 1e14: from the last digits to the size of the value.
        for _ in 0..24 {
            match self.try_to_prove(start + step, combination, margin) {
                Verdict::Proven => {
                    proven = Some(start + step);
                    break;
                }
                Verdict::Refuted => {
                    (failed, step) = (step, growth * step);
                    growth = (growth * growth).min(4.0);
                }
                Verdict::TooClose(needed) => {
                    // The rounding at a u that is larger by its own amount is the same to that part.
                    margin = 1.1 * needed;
                    (failed, step) = (step, step.max(1.5 * margin * start));
                }
            }
        }
        if !self.source.is_sharp() {
            while proven.is_some() && step > least && step > failed * (1.0 + CLOSELY) {
                let middle = if failed > 0.0 { (failed * step).sqrt() } else { least.max(step / shrink) };
                shrink = (shrink * shrink).min(4.0);
                if self.try_to_prove(start + middle, combination, margin) == Verdict::Proven {
                    (proven, step) = (Some(start + middle), middle);
                } else {
                    failed = middle;
                }
            }
            if proven.is_some() && combination.0 != 0.0 {
                self.excess = step / start;
            }
        }
        proven
    }

    pub(super) fn try_to_prove(&mut self, u: f64, combination: (f64, f64), margin: f64) -> Verdict {
        let verdict = self.source.prove(u, combination, margin);
        self.effort.proofs += 1;
        self.effort.failed += usize::from(verdict != Verdict::Proven);
        verdict
    }

    /// Relative width that an eigenvalue may have.
    pub(super) fn goal(&self) -> f64 {
        2.0 * self.options.tolerance
    }

    /// Adds the top vector at t to the subspace; the change of the lower bound there, relative.
    pub(super) fn sample(&mut self, t: f64, closed: bool) -> f64 {
        let tolerance = self.vector_tolerance();
        let before = (self.dimension() > 0).then(|| self.source.span().ritz(t));
        if let (Some(y), false) = (&before, closed) {
            // The Ritz vector may be good enough as it is.
            if self.source.residual(t, y) <= tolerance {
                return 0.0;
            }
        }
        let search = self.search(closed);
        let combination = (1.0, if closed { 0.0 } else { t });
        let old = before.as_ref().map_or(0.0, |y| self.source.span().line(y).at(t));
        self.source.seek(combination, before.as_deref(), &search);
        self.effort.eigenproblems += 1;
        let new = self.lower_at(t);
        self.effort.products = self.source.products();
        (new - old).abs() / new.abs().max(f64::MIN_POSITIVE)
    }

    /// The best lower bound of f(t) that the subspace gives; its line is kept.
    pub fn lower_at(&mut self, t: f64) -> f64 {
        let span = self.source.span();
        let line = span.line(&span.ritz(t));
        self.lines.push(line);
        self.lines.iter().map(|line| line.at(t)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Proves a point at t, close above the lower bound; whether it could.
    ///
    /// A proof far above says that a better vector was missed: it is looked for once more, from noise.
    pub(super) fn prove(&mut self, t: f64) -> bool {
        if self.has_sought(t) {
            return true;
        }
        let mut proven = self.climb_at(t);
        let lower = self.lower_at(t);
        let far = proven.is_none_or(|u| u - lower > self.goal() * lower.abs());
        // Patches are too high by their nature; that says nothing about the vectors.
        if far && self.source.is_sharp() {
            let search = self.search(false);
            self.source.seek((1.0, t), None, &search);
            self.effort.eigenproblems += 1;
            if self.lower_at(t) - lower > 0.1 * self.goal() * lower.abs() {
                proven = self.climb_at(t).or(proven);
            }
        }
        if let Some(u) = proven {
            self.upper.add(ProvenPoint { t, u });
            if !self.source.is_sharp() {
                self.sought.push((ProvenPoint { t, u }, self.goal()));
            }
        }
        proven.is_some()
    }

    /// Whether a point at t, or so little above that f is the same, was proven as closely as patches or chance can.
    fn has_sought(&mut self, t: f64) -> bool {
        let (unit, goal, lower) = (self.unit, self.goal(), self.lower_at(t));
        let same = |p: &ProvenPoint| p.t >= t && p.t - t <= SAME * unit.max(t.abs());
        let closely = |u: f64, was: f64| goal >= was || u - lower > was * lower.abs();
        self.sought.iter().any(|(p, was)| same(p) && closely(p.u, *was))
    }

    fn climb_at(&mut self, t: f64) -> Option<f64> {
        let lower = self.lower_at(t);
        self.climb(lower, (1.0, t), 0.25 * self.goal() * lower.abs().max(f64::MIN_POSITIVE))
    }

    pub(super) fn search(&self, closed: bool) -> Search {
        let tolerance = self.vector_tolerance();
        Search { basis: self.options.basis, tolerance, most_products: self.options.most_products, closed }
    }

    /// A small part of what is asked, so that the proof decides; Lanczos in f64 reaches little beyond 1e-12. Where patches
    /// decide, the vector of f(0) is as good as any: its value is right to the square over the distance to the next.
    fn vector_tolerance(&self) -> f64 {
        let least = if self.source.is_sharp() { 1e-12 } else { start::TOLERANCE };
        (0.05 * self.goal()).max(least)
    }

    /// f(0) from below.
    pub fn mesh(&self) -> f64 {
        self.mesh
    }

    /// The upper bound so far.
    pub fn upper(&self) -> &Upper {
        &self.upper
    }

    /// Vectors of the subspace.
    pub fn dimension(&self) -> usize {
        self.source.span().dimension()
    }

    /// What it took so far.
    pub fn effort(&self) -> Effort {
        self.effort
    }
}
