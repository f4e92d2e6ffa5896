//! The limits beside the roots of dense amplification matrices, which know nothing of definiteness.
//!
//! A multiplier is outside the unit circle beyond 1 + 1e-10: a root that leaves at -1 moves at least twice as fast as the step.
//! Rigid motion, within 1e-4 of 1, is left out.

use bipenalty::convex::{Asked, Curve, Enclosed, MeshPencil, Options, TooWide};
use bipenalty::damping::{DampedCurve, DampedLimit, DampedMesh, Damping};
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::{Bounds, Gap, Matrix, Penalty, Pencil};
use bipenalty::spectrum::{Enclosure, Evidence, Step, StepLimit, engine};
use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side, c64};

use crate::numbers::Numbers;
use crate::scenes;

pub fn full(matrix: &Matrix) -> Mat<f64> {
    let mut entries = Mat::zeros(matrix.size(), matrix.size());
    (0..matrix.size()).for_each(|i| matrix.row(i).for_each(|(j, a)| entries[(i, j)] = a));
    entries
}

/// sum_j factor_j z_j z_j'.
pub fn contacts(gaps: &[Gap], n: usize, factor: impl Fn(&Gap) -> f64) -> Mat<f64> {
    let mut sum = Mat::zeros(n, n);
    for gap in gaps {
        for (i, a) in &gap.column.0 {
            gap.column.0.iter().for_each(|(j, b)| sum[(*i as usize, *j as usize)] += factor(gap) * a * b);
        }
    }
    sum
}

/// L^-1 A L^-T.
fn reduced(a: &Mat<f64>, factor: &Llt<f64>) -> Mat<f64> {
    let mut half = a.clone();
    solve_lower_triangular_in_place(factor.L(), half.as_mut(), Par::Seq);
    let mut whole = half.transpose().to_owned();
    solve_lower_triangular_in_place(factor.L(), whole.as_mut(), Par::Seq);
    whole
}

/// K + K_p and A M + B K + c K_p in coordinates in which M + M_p is the identity.
pub struct Roots {
    stiffness: Mat<f64>,
    damping: Mat<f64>,
}

impl Roots {
    pub fn new(pencil: &Pencil, penalty: &Penalty, damping: Damping) -> Self {
        Self::of((pencil.stiffness(), pencil.mass(), pencil.gaps()), penalty, damping)
    }

    pub fn of((k, m, gaps): (&Matrix, &Matrix, &[Gap]), penalty: &Penalty, damping: Damping) -> Self {
        let (n, k, m) = (k.size(), full(k), full(m));
        let kp = contacts(gaps, n, |gap| penalty.of(gap.scale).0);
        let mut mp = contacts(gaps, n, |gap| penalty.of(gap.scale).1);
        if penalty.form == PenaltyMass::Diagonalised {
            let rows = |i: usize| (0..n).map(|j| mp[(i, j)].abs()).sum::<f64>();
            mp = Mat::from_fn(n, n, |i, j| if i == j { rows(i) } else { 0.0 });
        }
        let factor = Llt::new((&m + &mp).as_ref(), Side::Lower).unwrap();
        let c = &m * damping.mass() + &k * damping.stiffness() + &kp * damping.contact();
        Self { stiffness: reduced(&(&k + &kp), &factor), damping: reduced(&c, &factor) }
    }

    /// u, h v -> u, h v.
    fn matrix(&self, h: f64) -> Mat<f64> {
        let n = self.stiffness.nrows();
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        Mat::from_fn(2 * n, 2 * n, |row, column| {
            let (i, j) = (row % n, column % n);
            let carried = match column < n {
                true => -h * h * self.stiffness[(i, j)],
                false => unit(i, j) - h * self.damping[(i, j)],
            };
            carried + if row < n && column < n { unit(i, j) } else { 0.0 }
        })
    }

    pub fn is_stable(&self, h: f64) -> bool {
        // In complex numbers: from 75 rows on faer 0.24.4 may sort the pairs of a real matrix that lie on the circle for ever.
        let real = self.matrix(h);
        let matrix = Mat::from_fn(real.nrows(), real.ncols(), |i, j| c64::new(real[(i, j)], 0.0));
        let roots = matrix.eigenvalues().unwrap();
        roots.iter().filter(|z| (z.re - 1.0).hypot(z.im) > 1e-4).all(|z| z.re.hypot(z.im) <= 1.0 + 1e-10)
    }

    /// Whether the roots leave where `step` says, to 1e-9, and nowhere below.
    pub fn confirm(&self, step: &Step, place: &str) {
        assert_eq!(step.evidence, Evidence::Proven, "{place}");
        let limit = step.seconds();
        for share in [0.03, 0.2, 0.7, 0.9, 0.99, 0.9999, 1.0 - 1e-9] {
            assert!(self.is_stable(share * limit), "grows at {share} of {limit}: {place}");
        }
        for share in [1.0 + 1e-9, 1.0001, 1.1, 2.0] {
            assert!(!self.is_stable(share * limit), "does not grow at {share} of {limit}: {place}");
        }
    }
}

#[test]
fn limits_of_random_bars_are_where_a_root_leaves_the_circle() {
    let mut numbers = Numbers(1);
    for case in 0..160 {
        let (pencil, mut penalty) = scenes::bars(&mut numbers);
        // No damped limit depends on the form of the mass penalty.
        if case % 8 == 7 {
            penalty.form = PenaltyMass::Diagonalised;
        }
        let damping = scenes::damping(&mut numbers, &pencil);
        let limit = DampedLimit::new(&pencil, engine(&pencil).unwrap(), damping);
        let step = limit.enclose(&penalty, None).unwrap();
        let place = format!("case {case}, {penalty:?}, {damping:?}, n = {}", pencil.size());
        Roots::new(&pencil, &penalty, damping).confirm(&step, &place);
    }
}

#[test]
fn limits_of_random_matrices_are_too() {
    let (mut numbers, mut wide, mut certified) = (Numbers(2), 0, 0);
    for case in 0..70 {
        let (k, m, gaps, penalty) = scenes::mesh(&mut numbers);
        let parts = [2.2, 0.45, 0.45].map(|unit| unit * 10_f64.powf(numbers.between(-3.0, 1.0)));
        let damping = Damping::new(parts[0], parts[1], parts[2]).unwrap();
        let roots = Roots::of((&k, &m, &gaps), &penalty, damping);
        let place = format!("case {case}, {penalty:?}, {damping:?}, n = {}", k.size());

        let pencil = MeshPencil::new(k.clone(), m.clone(), gaps.clone()).unwrap();
        // Half of the width: the step is enclosed to at most the double of it.
        let options = Options { tolerance: 2e-10, ..Options::default() };
        let mut curve = DampedCurve::new(&pencil, Curve::new(&pencil, options).unwrap(), damping);
        let asked = Asked { stiffness: penalty.stiffness, mass: penalty.stiffness / penalty.rate };
        let found = curve.enclose(&[asked])[0];
        // Where the rounding of t P keeps the curve from its width the enclosure still holds.
        let step = found.unwrap_or_else(|TooWide { enclosed: Enclosed { lower, upper }, .. }| {
            wide += 1;
            Step::proven(Enclosure { value: 0.5 * (lower + upper), lower, upper })
        });
        roots.confirm(&step, &place);
        assert!(found.is_err() || step.upper() / step.lower() < 1.0 + 4.1e-10, "{place}: {step:?}");

        let bounds = Bounds { stiffness: 1e4, mass: 1e3 };
        let Ok(pencil) = Pencil::new(k, m, gaps, bounds, 5.0) else { panic!("{place}: bounds") };
        let other = DampedLimit::new(&pencil, engine(&pencil).unwrap(), damping).enclose(&penalty, None);
        // A dense engine certifies to 1e-9, which stiff contacts that share their unknowns may keep it from.
        certified += usize::from(other.is_ok());
        let agree = |other: Step| other.l.lower <= step.l.upper && step.l.lower <= other.l.upper;
        assert!(other.is_ok_and(agree) || other.is_err(), "{place}: {other:?} {step:?}");
    }
    assert!(certified >= 60, "{certified} of 70");
    println!("wider than asked: {wide} of 70");
    assert!(wide <= 7, "{wide}");
}

/// Many points of one mesh, searched together or one by one.
#[test]
fn a_map_of_one_mesh_is_that_of_its_points() {
    let mut numbers = Numbers(8);
    let (k, m, gaps, _) = scenes::mesh(&mut numbers);
    let damping = Damping::new(0.3, 0.1, 0.2).unwrap();
    let pencil = MeshPencil::new(k.clone(), m.clone(), gaps.clone()).unwrap();
    let map = |tolerance: f64| {
        let options = Options { tolerance, ..Options::default() };
        DampedCurve::new(&pencil, Curve::new(&pencil, options).unwrap(), damping)
    };
    let point = |i: i32, rate: f64| Penalty { stiffness: 10_f64.powi(i), rate, ..Penalty::NONE };
    let penalties: Vec<Penalty> =
        (-2..5).flat_map(|i| [0.5, 5.0, f64::INFINITY].map(|r| point(i, r))).collect();
    let asked = |p: &Penalty| Asked { stiffness: p.stiffness, mass: p.stiffness / p.rate };
    let found = map(1e-3).enclose(&penalties.iter().map(asked).collect::<Vec<_>>());
    let single = DampedMesh::new(map(1e-9));
    for (penalty, step) in penalties.iter().zip(found) {
        let (step, near) = (step.unwrap(), single.enclose(penalty, None).unwrap());
        assert!(step.l.lower <= near.l.value && near.l.value <= step.l.upper, "{penalty:?}");
        // A step is enclosed to at most twice the tolerance of the curve.
        assert!(step.upper() / step.lower() <= 1.0 + 2.1e-3, "{penalty:?}: {step:?}");
        Roots::of((&k, &m, &gaps), penalty, damping).confirm(&near, &format!("{penalty:?}"));
    }
}
