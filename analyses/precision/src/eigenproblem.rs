//! The largest eigenvalues that are asked for, and their exact values.

use bipenalty::error::Refusal;
use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::{Bounds, Gap, Matrix, Penalty, Pencil, Tridiagonal};
use bipenalty::scene::{Bar, End, Scene};
use bipenalty::sparse::SparseVector;
use bipenalty::stability::Model;

/// The names of the problems; `tests/data/spectra.py` says what each is.
pub const EIGENPROBLEMS: [&str; 4] =
    ["wall-consistent", "unequal-lumped", "stiff-lumped", "random-consistent"];

/// Elements of all bars.
pub const SIZES: [usize; 5] = [10, 100, 1000, 10_000, 100_000];

/// One pencil whose l_max is asked for.
#[derive(Debug, Clone)]
pub struct Eigenproblem {
    /// One of [`EIGENPROBLEMS`].
    pub name: &'static str,
    /// Elements of all bars.
    pub elements: usize,
    /// The scene; `None` where the elements differ.
    pub model: Option<Model>,
    /// K and M.
    pub pencil: Pencil,
    /// s and m.
    pub penalty: Penalty,
}

impl Eigenproblem {
    /// The problem of this name.
    ///
    /// # Errors
    /// Refuses an unknown name and an odd or vanishing number of elements.
    pub fn new(name: &'static str, elements: usize) -> Result<Self, Refusal> {
        if elements == 0 || !elements.is_multiple_of(2) {
            return Err(Refusal::new("elements", elements, "an even number of at least 2"));
        }
        let on_wall = (vec![Bar::unit(elements)], End::Wall);
        let half = Bar::unit(elements / 2);
        let unequal = (vec![half.clone(), Bar { youngs_modulus: 2.0, area: 3.0, ..half }], End::Fixed);
        let (bars, mass, beta_s, ratio) = match name {
            "wall-consistent" => (on_wall, MassMatrix::CONSISTENT, 10.0, 2.0),
            "unequal-lumped" => (unequal, MassMatrix::LUMPED, 1e4, 1.0),
            "stiff-lumped" => (on_wall, MassMatrix::LUMPED, 1e8, f64::INFINITY),
            "random-consistent" => return Self::random(elements),
            _ => return Err(Refusal::new("problem", name, EIGENPROBLEMS.join(", "))),
        };
        let scene = Scene::new(name, End::Free, bars.0, bars.1, None)?;
        let model = Model::new(scene, mass, PenaltyMass::Consistent);
        let (pencil, penalty) =
            (model.pencil(), model.penalty(StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?));
        Ok(Self { name, elements, model: Some(model), pencil, penalty })
    }

    /// Elements k [1 -1; -1 1], d [2 1; 1 2] with k, d in {64, .., 127}/64 of a linear congruential generator, on a wall
    /// with s = m = 16. Every entry is exact in f64.
    fn random(elements: usize) -> Result<Self, Refusal> {
        let mut state: u64 = 189;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (64 + (state >> 58)) as f64 / 64.0
        };
        let nodes = elements + 1;
        let (mut stiffness, mut mass) = (Tridiagonal::zeros(nodes), Tridiagonal::zeros(nodes));
        let mut bound: f64 = 0.0;
        for i in 0..elements {
            let (k, d) = (draw(), draw());
            for node in [i, i + 1] {
                stiffness.diagonal[node] += k;
                mass.diagonal[node] += 2.0 * d;
            }
            stiffness.off_diagonal[i] = -k;
            mass.off_diagonal[i] = d;
            // The largest eigenvalue of an element.
            bound = bound.max(2.0 * k / d);
        }
        let gap = Gap { column: SparseVector(vec![(elements as u32, 1.0)]), scale: 16.0, initial: 0.0 };
        let bounds = Bounds { stiffness: bound, mass: 3.0 };
        let (stiffness, mass) = (Matrix::Chain(stiffness), Matrix::Chain(mass));
        Ok(Self {
            name: "random-consistent",
            elements,
            model: None,
            pencil: Pencil::new(stiffness, mass, vec![gap], bounds, bound)?,
            penalty: Penalty { stiffness: 1.0, rate: 1.0, ..Penalty::NONE },
        })
    }
}

/// An exact l_max, rad^2/s^2: the nearest f64 and what is left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactEigenvalue {
    /// The nearest f64.
    pub nearest: f64,
    /// The exact value minus it.
    pub rest: f64,
}

impl ExactEigenvalue {
    /// (dt - exact)/exact of the critical step 2/sqrt(l) for the value `l` of l_max: positive where dt is too large.
    pub fn step_error(self, l: f64) -> f64 {
        // l - exact is exact for neighbours; 1/sqrt(1 + e) - 1 without cancellation.
        let e = ((l - self.nearest) - self.rest) / self.nearest;
        let root = (1.0 + e).sqrt();
        -e / (root * (1.0 + root))
    }
}

/// The exact values of `tests/data/work_precision.csv`, which `spectra.py` beside it has made.
#[derive(Debug, Clone, Copy)]
pub struct ExactEigenvalues<'a>(&'a str);

impl ExactEigenvalues<'static> {
    /// The table that this crate was built with.
    pub fn built_in() -> Self {
        Self(include_str!("../../../tests/data/work_precision.csv"))
    }
}

impl<'a> ExactEigenvalues<'a> {
    /// A table with the columns problem, elements, l_max and the rest of it.
    pub fn read(table: &'a str) -> Self {
        Self(table)
    }

    /// The table as text.
    pub fn text(&self) -> &'a str {
        self.0
    }

    /// The exact l_max of a problem.
    ///
    /// # Errors
    /// Refuses a problem that the table does not hold.
    pub fn of(&self, problem: &str, elements: usize) -> Result<ExactEigenvalue, Refusal> {
        let found = self.0.lines().skip(1).find_map(|line| {
            let field: Vec<&str> = line.split(',').collect();
            let [name, n, nearest, rest] = field[..] else { return None };
            (name == problem && n.parse() == Ok(elements))
                .then(|| Some(ExactEigenvalue { nearest: nearest.parse().ok()?, rest: rest.parse().ok()? }))?
        });
        found.ok_or_else(|| {
            let value = format!("{problem} with {elements} elements");
            Refusal::new("problem", value, "what tests/data/work_precision.csv holds")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_step_has_its_sign_and_its_digits() {
        let exact = ExactEigenvalue { nearest: 4.0, rest: 0.0 };
        // l = 1 instead of 4: dt = 2 instead of 1.
        assert_eq!(exact.step_error(1.0), 1.0);
        assert_eq!(exact.step_error(16.0), -0.5);
        // One unit in the last place of l is half of one in dt, and the rest counts.
        let next = 4.0 * (1.0 + f64::EPSILON);
        assert!((exact.step_error(next) + 0.5 * f64::EPSILON).abs() < 1e-30);
        let rest = ExactEigenvalue { nearest: 4.0, rest: 1e-17 };
        assert!((rest.step_error(4.0) - 0.125e-17).abs() < 1e-32);
    }
}
