//! The curve turned inside out: it asks, whoever has the pencil answers.
//!
//! ```text
//! while let Some(question) = session.question() { session.tell(answer to it)? }      session.finish()
//! ```
//! The driver is the one of [`Curve`], on a thread of its own that waits for each answer. So the pencil may lie on many
//! machines, and who asks needs no more of it than the forms of its sampled vectors.

use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use super::curve::{Curve, Options};
use super::factor::Verdict;
use super::lanczos::Search;
use super::point::{Asked, Enclosed};
use super::source::{Found, Source};
use super::span::{Row, Sizes, Span};
use super::start;
use crate::error::Refusal;

/// What is asked next.
#[derive(Debug, Clone, PartialEq)]
pub enum Question {
    /// The top vector of (a K + t P, M), as [`Source::seek`]: answered by [`Answer::Found`].
    Seek {
        /// a and t.
        combination: (f64, f64),
        /// y of the vector V y to start from; noise where there is none.
        start: Option<Vec<f64>>,
        /// |A x - theta M x| in the norm of M^-1, as a part of theta, at which to stop.
        tolerance: f64,
        /// Whether to search among the vectors with closed gaps only.
        closed: bool,
    },
    /// How well V y satisfies the eigenproblem at t, as [`Source::residual`]: answered by [`Answer::Residual`].
    Residual {
        /// t.
        t: f64,
        /// y.
        y: Vec<f64>,
    },
    /// Whether u M - a K - t P is semidefinite, as [`Source::prove`]: answered by [`Answer::Verdict`].
    Prove {
        /// u.
        u: f64,
        /// a and t.
        combination: (f64, f64),
        /// The part of u that rounding may use.
        margin: f64,
    },
}

/// The answer to a question.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// The Ritz value, its residual, and the forms of the vector if it was new to the span.
    Found {
        /// Value and residual.
        found: Found,
        /// Forms; the gaps of all parts, in the order of the scales.
        row: Option<Row>,
    },
    /// The residual, relative.
    Residual(f64),
    /// The verdict of all parts together.
    Verdict(Verdict),
}

/// What is known of the pencil from the beginning.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// Unknowns of all parts, each counted once.
    pub unknowns: usize,
    /// w_j of the contacts of all parts, in the order in which rows name their gaps.
    pub scales: Vec<f64>,
    /// What bounds the rounding of forms.
    pub sizes: Sizes,
    /// Whether proofs are sharp, as [`Source::is_sharp`].
    pub sharp: bool,
}

/// A map as it was enclosed.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// f(0) from below, rad^2/s^2.
    pub mesh: f64,
    /// mu = l_max(P, M), proven from above.
    pub slope: f64,
    /// An enclosure for each point, in their order; it holds even where it is wider than the tolerance.
    pub points: Vec<Enclosed>,
    /// Eigenproblems solved, and proofs tried.
    pub effort: (usize, usize),
}

/// A pencil that answers through channels.
struct Remote {
    facts: Facts,
    span: Span,
    questions: Sender<Question>,
    answers: Receiver<Answer>,
}

/// What unwinds the driver when nobody answers any more.
struct Abandoned;

impl Remote {
    fn ask(&self, question: Question) -> Answer {
        let sent = self.questions.send(question).ok();
        // Nothing is printed: the session was dropped, and its thread ends here.
        sent.and_then(|()| self.answers.recv().ok()).unwrap_or_else(|| resume_unwind(Box::new(Abandoned)))
    }
}

impl Source for Remote {
    fn unknowns(&self) -> usize {
        self.facts.unknowns
    }

    fn has_contacts(&self) -> bool {
        !self.facts.scales.is_empty()
    }

    fn span(&self) -> &Span {
        &self.span
    }

    fn seek(&mut self, combination: (f64, f64), start: Option<&[f64]>, search: &Search) -> Found {
        let start = start.map(<[f64]>::to_vec);
        let Search { tolerance, closed, .. } = *search;
        // `Session::tell` lets no other kind of answer through.
        match self.ask(Question::Seek { combination, start, tolerance, closed }) {
            Answer::Found { found, row } => {
                if let Some(row) = row {
                    self.span.push(row);
                }
                found
            }
            Answer::Residual(_) | Answer::Verdict(_) => Found { value: f64::NAN, residual: f64::NAN },
        }
    }

    fn residual(&mut self, t: f64, y: &[f64]) -> f64 {
        match self.ask(Question::Residual { t, y: y.to_vec() }) {
            Answer::Residual(residual) => residual,
            Answer::Found { .. } | Answer::Verdict(_) => f64::INFINITY,
        }
    }

    fn prove(&mut self, u: f64, combination: (f64, f64), margin: f64) -> Verdict {
        match self.ask(Question::Prove { u, combination, margin }) {
            Answer::Verdict(verdict) => verdict,
            Answer::Found { .. } | Answer::Residual(_) => Verdict::Refuted,
        }
    }

    fn is_sharp(&self) -> bool {
        self.facts.sharp
    }

    fn is_patched(&self) -> bool {
        !self.facts.sharp
    }

    fn products(&self) -> usize {
        0
    }
}

/// A map being enclosed by question and answer.
#[derive(Debug)]
pub struct Session {
    questions: Receiver<Question>,
    answers: Sender<Answer>,
    driver: JoinHandle<Result<Finished, Refusal>>,
    open: Option<Question>,
    contacts: usize,
    dimension: usize,
}

impl Session {
    /// Begins to enclose the points (beta_s, r), to `options.tolerance`. `reference` is omega_ref^2, by default f(0).
    ///
    /// # Errors
    /// The operating system gives no thread.
    pub fn new(
        facts: Facts,
        points: Vec<(f64, f64)>,
        reference: Option<f64>,
        options: Options,
    ) -> std::io::Result<Self> {
        let (questions, asked) = channel();
        let (answers, told) = channel();
        let contacts = facts.scales.len();
        let span = Span::new(facts.sizes, facts.scales.clone());
        let remote = Remote { facts, span, questions, answers: told };
        let driver = std::thread::Builder::new()
            .name("bipenalty-session".to_owned())
            .spawn(move || drive(remote, &points, reference, options))?;
        Ok(Self { questions: asked, answers, driver, open: None, contacts, dimension: 0 })
    }

    /// The next question; none when the map is enclosed. A question that was not answered yet is asked again.
    pub fn question(&mut self) -> Option<&Question> {
        if self.open.is_none() {
            self.open = self.questions.recv().ok();
        }
        self.open.as_ref()
    }

    /// Answers the question.
    ///
    /// # Errors
    /// An answer of another kind, or forms of another size than the span and the contacts have.
    pub fn tell(&mut self, answer: Answer) -> Result<(), Refusal> {
        let allowed = match (&self.open, &answer) {
            (Some(Question::Seek { .. }), Answer::Found { row: None, .. })
            | (Some(Question::Residual { .. }), Answer::Residual(_))
            | (Some(Question::Prove { .. }), Answer::Verdict(_)) => None,
            (Some(Question::Seek { .. }), Answer::Found { row: Some(row), .. }) => {
                let lengths = [row.stiffness.len(), row.mass.len(), row.gaps.len(), row.gap_sizes.len()];
                let (k, j) = (self.dimension + 1, self.contacts);
                let fits = lengths == [k, k, j, j];
                self.dimension += usize::from(fits);
                (!fits).then(|| format!("forms with {k} vectors and {j} gaps"))
            }
            (Some(question), _) => Some(format!("an answer to {question:?}")),
            (None, _) => Some("none: nothing was asked".to_owned()),
        };
        if let Some(allowed) = allowed {
            return Err(Refusal::new("answer", format!("{answer:?}"), allowed));
        }
        self.open = None;
        // The driver waits for this answer, or has ended: then there is no further question.
        let _ = self.answers.send(answer);
        Ok(())
    }

    /// The map, after the last question.
    ///
    /// # Errors
    /// mu could not be proven; a session that is not at its end.
    pub fn finish(self) -> Result<Finished, Refusal> {
        drop(self.answers);
        match self.driver.join() {
            Ok(result) => result,
            Err(ended) if ended.is::<Abandoned>() => {
                Err(Refusal::new("session", "a question without an answer", "an answer to every question"))
            }
            Err(panic) => resume_unwind(panic),
        }
    }
}

fn drive(
    mut remote: Remote,
    points: &[(f64, f64)],
    reference: Option<f64>,
    options: Options,
) -> Result<Finished, Refusal> {
    remote.seek((1.0, 0.0), None, &start::search(&options));
    let mut curve = Curve::of(remote, options)?;
    let mesh = curve.mesh();
    let reference = reference.unwrap_or(mesh);
    if !(reference > 0.0 && reference.is_finite()) {
        let value = format!("l_max(K, M) = {reference:e} rad^2/s^2");
        return Err(Refusal::new("reference", value, "a stiffness that resists, or a number"));
    }
    let asked: Vec<Asked> =
        points.iter().map(|(beta_s, ratio)| Asked::of(*beta_s, *ratio, reference)).collect();
    let enclosed = curve.enclose(&asked);
    let points = enclosed.into_iter().map(|found| found.unwrap_or_else(|wide| wide.enclosed)).collect();
    let effort = curve.effort();
    Ok(Finished { mesh, slope: curve.upper().slope(), points, effort: (effort.eigenproblems, effort.proofs) })
}
