//! Limits of meshes confirmed by stepping, and by dense amplification matrices.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Matrix;
use bipenalty::schemes::{Scheme, SchemeName};
use bipenalty::spectrum::Evidence;
use bipenalty::stability::{AnyModel, AnyScene, Asking, LimitOf, MeshModel};
use bipenalty::verify::{PenaltyPoint, Search, limit_of_any};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Par, Side};

use crate::bars::{as_matrices, bars};
use crate::reference::{dense, eigen};
use crate::scenes::{TWO_BLOCKS, random_mesh};

fn model(text: &str, mass: MassMatrix) -> AnyModel {
    AnyModel::new(&AnyScene::parse(text, "s.toml").unwrap(), Some(mass), PenaltyMass::Consistent).unwrap()
}

/// Two blocks of hexahedra, unlike and not matching.
const IN_SPACE: &str = r#"name = "in-space"
dimension = 3
[[body]]
name = "lower"
box = [2.0, 1.0, 2.0]
cells = [2, 1, 2]
element = "hex8"
youngs_modulus = 2.0
poissons_ratio = 0.3
density = 1.0
[[body]]
name = "upper"
box = [1.5, 1.0, 1.5]
cells = [2, 1, 1]
origin = [0.2, 1.0, 0.1]
element = "hex8"
youngs_modulus = 1.0
poissons_ratio = 0.2
density = 1.0
[[contact]]
surfaces = ["upper.bottom", "lower.top"]
[[hold]]
surface = "lower.bottom"
directions = ["x", "y", "z"]
"#;

/// l_max(C W(dt)) of the Park scheme, C = (S^-1 + a G)^-1, from all eigenpairs; the limit is where it is 1.
fn park(mesh: &MeshModel, beta_s: f64, ratio: f64, theta: f64, dt: f64) -> f64 {
    let (stiffness, mass, gaps) = mesh.matrices();
    let (values, vectors) = eigen(stiffness, mass);
    let (n, k, top) = (values.len(), gaps.len(), values[values.len() - 1]);
    let dt_c = 2.0 / top.sqrt();
    let alpha = dt / dt_c;
    let w = theta * dt_c * dt_c * alpha * (1.0 - alpha * alpha) / 6.0;
    let b = w * dt_c * dt_c / 2.0;
    let seen = Mat::from_fn(k, n, |j, i| {
        gaps[j].column.0.iter().map(|(at, z)| z * vectors[(*at as usize, i)]).sum::<f64>()
    });
    let of = |i: usize| {
        let l = values[i];
        (dt * dt / 2.0 + w + b * l) / (2.0 - dt * dt * l / 2.0 - b * l * l)
    };
    let reference = mesh.reference().unwrap();
    let sum = |f: &dyn Fn(usize) -> f64| {
        Mat::from_fn(k, k, |p, q| (0..n).map(|i| seen[(p, i)] * f(i) * seen[(q, i)]).sum::<f64>())
    };
    let (flexibility, compliance) = (sum(&of), sum(&|_| 1.0));
    let inverse = Mat::from_fn(k, k, |p, q| {
        let own = if p == q { 1.0 / (beta_s * gaps[p].scale) } else { 0.0 };
        own + compliance[(p, q)] / (ratio * reference)
    });
    let (largest, _) = eigen(&sparse(&flexibility), &sparse(&inverse));
    largest[k - 1]
}

fn sparse(a: &Mat<f64>) -> Matrix {
    let n = a.nrows();
    let mean = |i: usize, j: usize| 0.5 * (a[(i, j)] + a[(j, i)]);
    let entries: Vec<_> =
        (0..n).flat_map(|i| (0..n).map(move |j| (i as u32, j as u32, mean(i, j)))).collect();
    Matrix::Sparse(bipenalty::sparse::Csr::from_triplets(n, n, &entries))
}

/// Central differences at the limit of the spectrum, the predictor-corrector not below its bound, Park where l_max(C W) = 1.
#[test]
fn stepping_confirms_the_limits_of_all_schemes_in_the_plane_and_in_space() {
    for (text, mass) in
        [(TWO_BLOCKS, MassMatrix::LUMPED), (IN_SPACE, MassMatrix::LUMPED), (TWO_BLOCKS, MassMatrix::AVERAGED)]
    {
        let model = model(text, mass);
        let AnyModel::Mesh(mesh) = &model else { panic!() };
        let (beta_s, ratio) = (20.0, 3.0);
        let point = PenaltyPoint {
            stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(),
            ratio: Ratio::new(ratio).unwrap(),
        };
        for name in SchemeName::ALL
            .into_iter()
            .filter(|name| ["central-difference", "predictor-corrector", "park"].contains(&name.name()))
        {
            let scheme: &dyn Scheme = name.scheme();
            let tolerance = if name == SchemeName::CentralDifference { 1e-3 } else { 1e-2 };
            let found = limit_of_any(&model, scheme, point, &Search::to(tolerance, scheme).unwrap()).unwrap();
            let place = format!("{}, {}, {}: {found:?}", model.name(), mass.name(), name.name());
            assert!(found.stable_at < found.unstable_at && found.stable_at > 0.0, "{place}");
            if name == SchemeName::Park {
                let at = |dt: f64| park(mesh, beta_s, ratio, 0.5, dt);
                assert!(at(found.stable_at * 0.98) < 1.0 && at(found.unstable_at * 1.02) > 1.0, "{place}");
            }
            let asking = Asking { limit: name.into(), ..Asking::default() };
            let step = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
            let (low, high) = (model.time_step(step.lower).unwrap(), model.time_step(step.upper).unwrap());
            assert!(found.unstable_at >= low * (1.0 - tolerance), "{place} {low}");
            assert!(found.stable_at <= high * (1.0 + tolerance), "{place} {high}");
            // Not far above a bound either: unlike contacts gain a quarter at most.
            let more = if name == SchemeName::PredictorCorrector { 1.3 } else { 1.0 + tolerance };
            assert!(found.stable_at <= low * more, "{place} {low}");
        }
    }
}

/// 120 random meshes: at the lower end of the enclosure l_max(C W) <= 1, at the upper end it is beyond, by all eigenpairs.
#[test]
fn park_limits_of_random_meshes_are_enclosed() {
    faer::set_global_parallelism(Par::Seq);
    let (mut meshes, mut contact) = (0, 0);
    for seed in 500.. {
        let mass = [MassMatrix::LUMPED, MassMatrix::CONSISTENT, MassMatrix::AVERAGED][seed as usize % 3];
        let model = model(&random_mesh(seed), mass);
        let AnyModel::Mesh(mesh) = &model else { panic!() };
        if mesh.pencil().size() > 120 {
            continue;
        }
        meshes += 1;
        let mut random = crate::numbers::Numbers(seed);
        let ratio = if seed % 4 == 0 { f64::INFINITY } else { random.log(1e-2, 1e3) };
        let (beta_s, theta) = (random.log(1e-4, 1e8), [0.0, 0.5, 1.0][seed as usize % 3]);
        let tolerance = [1e-9, 1e-6, 1e-3][(seed as usize / 3) % 3];
        let limit = LimitOf::Scheme(SchemeName::Park.with_theta(theta).unwrap());
        let asking = Asking { limit, tolerance: Some(tolerance), ..Asking::default() };
        let step = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
        let place = format!("seed {seed}, {}, {beta_s:e}, r = {ratio}, theta {theta}: {step:?}", mass.name());
        assert_eq!(step.evidence, Evidence::Proven, "{place}");
        assert!(step.lower > 0.0 && step.upper / step.lower - 1.0 <= tolerance * 1.0001, "{place}");
        let at = |courant: f64| park(mesh, beta_s, ratio, theta, model.time_step(courant).unwrap());
        // The reference and dt_c are known to 1e-10, which l_max(C W) multiplies where W has its pole.
        assert!(at(step.lower * (1.0 - 1e-8)) <= 1.0, "{place}");
        if step.upper < 1.0 - 1e-7 {
            contact += 1;
            assert!(at(step.upper * (1.0 + 1e-8)) >= 1.0, "{place}");
        }
        if meshes == 120 {
            break;
        }
    }
    assert!(contact > 80, "{contact}");
}

/// Bars as matrices have the Park limits of bars, which are proven in another way.
#[test]
fn park_limits_of_bars_as_matrices_are_those_of_bars() {
    for (name, elements, mass) in [
        ("signorini", 8, MassMatrix::LUMPED),
        ("hunek", 4, MassMatrix::CONSISTENT),
        ("symmetric", 3, MassMatrix::AVERAGED),
    ] {
        let model = bars(name, elements, mass);
        let (mesh, model) = (AnyModel::Mesh(Box::new(as_matrices(&model))), AnyModel::Bars(model));
        let asking = Asking { limit: SchemeName::Park.into(), ..Asking::default() };
        for (beta_s, ratio) in
            [(0.1, 1.0), (10.0, 0.2), (1e4, 5.0), (1e4, f64::INFINITY), (1e12, f64::INFINITY)]
        {
            let step = |model: &AnyModel| {
                let found = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
                (model.time_step(found.lower).unwrap(), model.time_step(found.upper).unwrap())
            };
            let (known, found) = (step(&model), step(&mesh));
            assert!(
                found.0 <= known.1 * (1.0 + 1e-10) && known.0 <= found.1 * (1.0 + 1e-10),
                "{name}, {beta_s}, {ratio}: {found:?}, bars {known:?}"
            );
        }
    }
}

/// The largest beta_s and the largest ratio of a step are those with which it is the limit of the Park scheme.
#[test]
fn the_largest_penalty_and_ratio_of_park_are_at_its_limit() {
    let model = model(TWO_BLOCKS, MassMatrix::LUMPED);
    let asking = Asking { limit: SchemeName::Park.into(), ..Asking::default() };
    for (beta_s, ratio) in [(3.0, 0.3), (20.0, 3.0), (5.0, f64::INFINITY)] {
        let step = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
        let dt = model.time_step(0.5 * (step.lower + step.upper)).unwrap();
        let most = model.largest_penalty(dt, ratio, &asking).unwrap().unwrap();
        assert!(
            most.lower <= most.upper && (most.lower / beta_s - 1.0).abs() < 1e-6,
            "{beta_s}, {ratio}: {most:?}"
        );
        if ratio.is_finite() {
            let most = model.largest_ratio(dt, beta_s, &asking).unwrap().unwrap();
            assert!(
                most.lower <= most.upper && (most.lower / ratio - 1.0).abs() < 1e-6,
                "{beta_s}, {ratio}: {most:?}"
            );
        }
        let best = model.optimal_ratio(beta_s, &asking).unwrap().unwrap();
        assert!(best.lower == 0.0 && best.upper <= 1.0, "{best:?}");
    }
    let free = model.time_step(1.01).unwrap();
    assert_eq!(model.largest_penalty(free, 1.0, &asking).unwrap(), None);
}

/// A stiffness that is not semidefinite has no limit of this kind.
#[test]
fn park_refuses_a_stiffness_that_pushes() {
    let two = |a: f64, b: f64| {
        Matrix::Sparse(bipenalty::sparse::Csr::from_triplets(
            2,
            2,
            &[(0, 0, a), (1, 1, a), (0, 1, b), (1, 0, b)],
        ))
    };
    let gap = bipenalty::sparse::SparseVector(vec![(0, 1.0)]);
    let model = MeshModel::from_matrices(two(1.0, -1.001), two(1.0, 0.0), vec![gap], &[1.0], None).unwrap();
    let asking = Asking { limit: SchemeName::Park.into(), ..Asking::default() };
    let refused = AnyModel::Mesh(Box::new(model)).critical_step(1.0, 1.0, &asking).unwrap_err();
    assert!(refused.to_string().contains("semidefinite"), "{refused}");
}

/// |multipliers| of a step of the predictor-corrector as it is defined, but those at 1 that belong to rigid motion.
fn radius(mesh: &MeshModel, beta_s: f64, ratio: f64, dt: f64) -> f64 {
    let (stiffness, mass, gaps) = mesh.matrices();
    let (k, m) = (dense(stiffness), dense(mass));
    let n = k.nrows();
    let reference = mesh.reference().unwrap();
    let (mut kp, mut both) = (Mat::<f64>::zeros(n, n), m.clone());
    for gap in gaps {
        for ((i, a), (j, b)) in gap.column.0.iter().flat_map(|a| gap.column.0.iter().map(move |b| (a, b))) {
            let (i, j, s) = (*i as usize, *j as usize, beta_s * gap.scale * a * b);
            kp[(i, j)] += s;
            both[(i, j)] += s / (ratio * reference);
        }
    }
    let predicted = Llt::new(m.as_ref(), Side::Lower).unwrap().solve(&k);
    let corrected = Llt::new(both.as_ref(), Side::Lower).unwrap().solve(&kp);
    // v* = v - dt A u, u* = u + dt v*, v+ = v* - dt B u*, u+ = u + dt v+, as columns of the state (u, v).
    let unit = |top: f64, bottom: f64| {
        Mat::from_fn(n, 2 * n, |i, j| {
            if j == i {
                top
            } else if j == n + i {
                bottom
            } else {
                0.0
            }
        })
    };
    let (u, v) = (unit(1.0, 0.0), unit(0.0, 1.0));
    let v = &v - &(&predicted * &u) * faer::Scale(dt);
    let ahead = &u + &v * faer::Scale(dt);
    let v = &v - &(&corrected * &ahead) * faer::Scale(dt);
    let next = &u + &v * faer::Scale(dt);
    let step = Mat::from_fn(2 * n, 2 * n, |i, j| if i < n { next[(i, j)] } else { v[(i - n, j)] });
    let multipliers = step.eigenvalues().unwrap();
    let moving = multipliers.iter().filter(|z| (z.re - 1.0).hypot(z.im) > 1e-5);
    moving.map(|z| z.re.hypot(z.im)).fold(0.0, f64::max)
}

/// A hundred random meshes: nothing grows below dt^2 = 1/(r omega^2) + 1/(beta_s l_max(P, M)), and little above it something does.
#[test]
fn a_hundred_meshes_do_not_grow_below_the_bound_of_the_predictor_corrector() {
    let asking = Asking { limit: SchemeName::PredictorCorrector.into(), ..Asking::default() };
    // Small eigenproblems: threads would wait for each other.
    faer::set_global_parallelism(Par::Seq);
    let (mut meshes, mut above, mut grew) = (0, 0, 0);
    for seed in 100.. {
        let mass = [MassMatrix::LUMPED, MassMatrix::CONSISTENT][seed as usize % 2];
        let model = model(&random_mesh(seed), mass);
        let AnyModel::Mesh(mesh) = &model else { panic!() };
        if mesh.pencil().size() > 50 {
            continue;
        }
        meshes += 1;
        let mut random = crate::numbers::Numbers(seed);
        let (beta_s, ratio) =
            (random.log(1e-2, 1e5), if seed % 5 == 0 { f64::INFINITY } else { random.log(0.05, 100.0) });
        let step = model.critical_step(beta_s, ratio, &asking).unwrap().step.unwrap();
        let dt = model.time_step(step.lower).unwrap();
        let below = radius(mesh, beta_s, ratio, dt * (1.0 - 1e-6));
        assert!(below <= 1.0 + 1e-7, "seed {seed}, {beta_s}, {ratio}: {below} at {step:?}");
        if step.lower < 0.7 {
            above += 1;
            grew += usize::from(radius(mesh, beta_s, ratio, 1.3 * dt) > 1.0 + 1e-6);
        }
        if meshes == 100 {
            break;
        }
    }
    println!("{grew} of {above} grow at 1.3 times the bound");
    assert!(above > 30 && grew == above, "{grew} of {above}");
}
