//! Force and gap at the largest penalties, against the textbook formulas in double-double arithmetic and against algebra.

use bipenalty::fem::MassMatrix;
use bipenalty::impact::Recording;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Penalty;
use bipenalty::scene::{End, Scene};
use bipenalty::schemes::{ContactRule, SchemeName, System};
use bipenalty::stability::Model;

use super::{run, unit_bar};

/// Double-double numbers, 106 bits: sums and products after Dekker and Knuth.
#[derive(Clone, Copy)]
struct Twice(f64, f64);

impl Twice {
    fn of(x: f64) -> Self {
        Self(x, 0.0)
    }

    fn sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let t = s - a;
        Self(s, (a - (s - t)) + (b - t))
    }

    fn value(self) -> f64 {
        self.0 + self.1
    }
}

impl std::ops::Add for Twice {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let (high, low) = (Self::sum(self.0, b.0), Self::sum(self.1, b.1));
        let first = Self::sum(high.0, high.1 + low.0);
        Self::sum(first.0, first.1 + low.1)
    }
}

impl std::ops::Neg for Twice {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl std::ops::Sub for Twice {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl std::ops::Mul for Twice {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let high = self.0 * b.0;
        let low = self.0.mul_add(b.0, -high) + (self.0 * b.1 + self.1 * b.0);
        Self::sum(high, low)
    }
}

impl std::ops::Div for Twice {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let first = Self::of(self.0 / b.0);
        let rest = self - first * b;
        let second = Self::of(rest.0 / b.0);
        let rest = rest - second * b;
        first + second + Self::of(rest.0 / b.0)
    }
}

/// A lumped bar on a wall, stepped in double-double by the textbook formulas: the force and the
/// gap of every step.
struct Textbook {
    k: Twice,
    inverse_mass: Vec<Twice>,
    s: Twice,
    m: Twice,
    dt: Twice,
    u: Vec<Twice>,
    v: Vec<Twice>,
}

impl Textbook {
    /// M^-1 f without contact.
    fn free(&self, u: &[Twice]) -> Vec<Twice> {
        let n = u.len();
        let force = |i: usize| {
            let left = if i > 0 { u[i - 1] - u[i] } else { Twice::of(0.0) };
            let right = if i + 1 < n { u[i + 1] - u[i] } else { Twice::of(0.0) };
            self.k * (left + right) * self.inverse_mass[i]
        };
        (0..n).map(force).collect()
    }

    /// Force and gap of one step with the contact closed.
    fn step(&mut self, scheme: SchemeName) -> (f64, f64) {
        let last = self.u.len() - 1;
        let mut a = self.free(&self.u);
        let mu = self.inverse_mass[last];
        let one = Twice::of(1.0);
        let gap = self.u[last];
        let lambda = if scheme == SchemeName::CentralDifference {
            a[last] = (a[last] - mu * self.s * gap) / (one + self.m * mu);
            self.s * gap + self.m * a[last]
        } else {
            let predicted = gap + self.dt * (self.v[last] + self.dt * a[last]);
            let lambda = self.s * predicted / (one + self.m * mu);
            a[last] = a[last] - mu * lambda;
            lambda
        };
        for ((u, v), a) in self.u.iter_mut().zip(&mut self.v).zip(&a) {
            *v = *v + self.dt * *a;
            *u = *u + self.dt * *v;
        }
        (lambda.value(), self.u[last].value())
    }
}

#[test]
fn force_and_gap_keep_ten_digits_at_the_largest_penalties() {
    let elements = 12;
    for scheme in [SchemeName::CentralDifference, SchemeName::PredictorCorrector] {
        for beta_s in [1e12, 1e16] {
            for c in [0.3, 0.45, 0.499_999_999_9, 0.7] {
                if scheme == SchemeName::PredictorCorrector && c > 0.5 {
                    continue;
                }
                let (k, m_end) = (1.0, 0.5);
                let (s, m) = (beta_s, beta_s / 4.0);
                let n = elements + 1;
                let scene =
                    Scene::new("bar", End::Free, vec![unit_bar(elements, 0.1)], End::Wall, None).unwrap();
                let pencil = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent).pencil();
                let system = System {
                    pencil: &pencil,
                    penalty: Penalty { stiffness: s, rate: s / m, ..Penalty::NONE },
                    load: Vec::new(),
                    time_step: c,
                    critical_step: 1.0,
                    rule: ContactRule::HeldClosed,
                    account: false,
                };
                let mut motion = scheme.scheme().start(system, vec![0.0; n], vec![0.1; n]).unwrap();
                let mass = |i: usize| if i == 0 || i == n - 1 { m_end } else { 1.0 };
                let mut textbook = Textbook {
                    k: Twice::of(k),
                    inverse_mass: (0..n).map(|i| Twice::of(1.0) / Twice::of(mass(i))).collect(),
                    s: Twice::of(s),
                    m: Twice::of(m),
                    dt: Twice::of(c),
                    u: vec![Twice::of(0.0); n],
                    v: vec![Twice::of(0.1); n],
                };
                let (mut worst_force, mut worst_gap, mut peak, mut top) =
                    (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
                for _ in 0..400 {
                    let (force, gap) = textbook.step(scheme);
                    motion.step();
                    peak = peak.max(force.abs());
                    top = top.max(gap.abs());
                    worst_force = worst_force.max((motion.state().force[0] - force).abs());
                    worst_gap = worst_gap.max((motion.state().gap[0] - gap).abs());
                }
                println!(
                    "{} {beta_s:e} C = {c}: {:.1e} {:.1e}; gap {top:.1e}",
                    scheme.name(),
                    worst_force / peak,
                    worst_gap / top
                );
                assert!(
                    worst_force <= 1e-10 * peak,
                    "{} {beta_s:e} {c}: {worst_force:e} of {peak}",
                    scheme.name()
                );
                assert!(
                    worst_gap <= 1e-10 * top,
                    "{} {beta_s:e} {c}: {worst_gap:e} of {top:e}",
                    scheme.name()
                );
            }
        }
    }
}

#[test]
fn nearly_plastic_contact_keeps_the_gap_that_algebra_gives() {
    // C = 1/2, r = 1: m = dt^2 s, so that g = lambda/s at the end of every step.
    for beta_s in [1e12, 1e16] {
        let run = run("signorini", MassMatrix::LUMPED, SchemeName::PredictorCorrector, beta_s, 1.0);
        let s = run.penalty().of(run.model().scales()[0].stiffness).0;
        let history = run.execute(&Recording::default(), None).unwrap();
        let h = 0.1;
        let closed = history.forces(0).zip(history.relative_gaps(0)).filter(|(force, _)| *force > 0.0);
        let mut rows = 0;
        for (force, gap) in closed {
            rows += 1;
            assert!((gap * h * s / force - 1.0).abs() <= 1e-10, "{beta_s:e}: {gap:e} {force}");
        }
        assert!(rows > 380);
    }
}
