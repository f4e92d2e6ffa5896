//! Limits of meshes found by stepping: against the map for central differences and the predictor-corrector, against the
//! determinant of the multiplier -1 for Park's scheme.

use std::sync::Arc;

use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::schemes::{Park, Scheme, SchemeName};
use bipenalty::spectrum::Evidence;
use bipenalty::stability::{AnyModel, AnyScene, Asking, Grid, Sweep};
use bipenalty::verify::{PenaltyPoint, Search, confirm_any, limit_of_any, points_of, predict_any};

/// An aluminium body on a steel one, held below; no node meets a node.
fn model(dimension: usize) -> AnyModel {
    let (boxes, elements, held) = match dimension {
        2 => (["[0.3, 0.2]\ncells = [2, 1]", "[0.2, 0.2]\ncells = [3, 2]"], ["quad4", "tri3"], "\"y\""),
        _ => (
            ["[0.2, 0.1, 0.2]\ncells = [1, 1, 2]", "[0.1, 0.1, 0.1]\ncells = [1, 1, 1]"],
            ["hex8", "tet4"],
            "\"y\", \"z\"",
        ),
    };
    let origin = if dimension == 2 { "[0.05, 0.2]" } else { "[0.05, 0.1, 0.05]" };
    let plane = if dimension == 2 { "plane = \"strain\"" } else { "" };
    let body = |name: &str, at: usize, e: f64, rho: f64| {
        let (shape, element) = (boxes[at], elements[at]);
        format!(
            "[[body]]\nname = \"{name}\"\nbox = {shape}\nelement = \"{element}\"\nyoungs_modulus = {e:e}\n\
             poissons_ratio = 0.3\ndensity = {rho}\n"
        )
    };
    let (lower, upper) = (body("lower", 0, 210e9, 7850.0), body("upper", 1, 70e9, 2700.0));
    let text = format!(
        "name = \"two\"\ndimension = {dimension}\n{plane}\n{lower}{upper}origin = {origin}\n\
         [[contact]]\nsurfaces = [\"upper.bottom\", \"lower.top\"]\n\
         [[hold]]\nsurface = \"lower.bottom\"\ndirections = [\"x\", {held}]\n"
    );
    AnyModel::new(&AnyScene::parse(&text, "two.toml").unwrap(), None, PenaltyMass::Consistent).unwrap()
}

#[test]
fn stepping_confirms_the_limits_of_a_mesh_in_the_plane_and_one_in_space() {
    let grid = Grid::new(&Sweep::list([0.5, 100.0]), &Sweep::list([0.25, 4.0, f64::INFINITY])).unwrap();
    for dimension in [2, 3] {
        let model = model(dimension);
        for (name, tolerance) in
            [(SchemeName::CentralDifference, 1e-3), (SchemeName::PredictorCorrector, 1e-2)]
        {
            let scheme: Arc<dyn Scheme> = name.into();
            let predicted = predict_any(&model, &scheme, &grid, tolerance);
            for (point, predicted) in points_of(&grid).zip(predicted) {
                let predicted = predicted.unwrap();
                let found = confirm_any(&model, &*scheme, point, tolerance, Some(predicted.clone())).unwrap();
                assert_eq!(found.agrees, Some(true), "{dimension}-D, {point:?}: {found:?}");
                let sharp = predicted.evidence == Evidence::Proven;
                assert_eq!(sharp, name == SchemeName::CentralDifference);
                // A prediction that is off by three tolerances is refuted.
                let courant = predicted.courant * (1.0 + 3.0 * tolerance);
                if name == SchemeName::CentralDifference {
                    assert!(!found.found.agrees(courant, tolerance), "{found:?}");
                }
            }
        }
    }
}

#[test]
fn park_on_a_mesh_ends_where_its_determinant_says() {
    const TOLERANCE: f64 = 1e-2;
    let search = Search::to(TOLERANCE, &Park::USUAL).unwrap();
    for dimension in [2, 3] {
        let model = model(dimension);
        let free = model.contact_free(&Asking::default()).unwrap().step.unwrap();
        let dt_c = model.time_step(free.lower).unwrap();
        for (beta_s, ratio) in [(0.5, 1.0), (10.0, f64::INFINITY), (100.0, 4.0)] {
            let point = PenaltyPoint {
                stiffness_penalty: StiffnessPenalty::new(beta_s).unwrap(),
                ratio: Ratio::new(ratio).unwrap(),
            };
            let found = limit_of_any(&model, &Park::USUAL, point, &search).unwrap();
            let below = found.stable_at * (1.0 - TOLERANCE) / dt_c;
            let above = found.unstable_at * (1.0 + TOLERANCE) / dt_c;
            assert!(stands(&model, point, below, dt_c), "{dimension}-D, {point:?}: {found:?}");
            assert!(
                above >= 1.0 || !stands(&model, point, above, dt_c),
                "{dimension}-D, {point:?}: {found:?}"
            );
        }
    }
}

/// Whether C^-1 - W(alpha) is positive definite: with w = theta dt_c^2 alpha (1 - alpha^2)/6, a = dt^2/2 + w, b = w dt_c^2/2,
/// W = Z'(2 M - dt^2/2 K - b K M^-1 K)^-1 (a + b K M^-1) Z and C^-1 = diag(1/(beta_s w_j)) + Z'M^-1 Z/(r omega^2).
fn stands(model: &AnyModel, point: PenaltyPoint, alpha: f64, dt_c: f64) -> bool {
    let AnyModel::Mesh(mesh) = model else { panic!("no mesh") };
    let (k, m, gaps) = mesh.matrices();
    let n = k.size();
    let (weight, dt) =
        (Park::USUAL.theta() * dt_c * dt_c * alpha * (1.0 - alpha * alpha) / 6.0, alpha * dt_c);
    let (a, b) = (0.5 * dt * dt + weight, 0.5 * weight * dt_c * dt_c);
    let mass: Vec<f64> = (0..n).map(|i| m.row(i).map(|(_, entry)| entry).sum()).collect();
    let mut dense = vec![vec![0.0; n]; n];
    for (i, row) in dense.iter_mut().enumerate() {
        k.row(i).for_each(|(j, entry)| row[j] = entry);
    }
    let system = |i: usize, j: usize| {
        let square: f64 = (0..n).map(|l| dense[i][l] / mass[l] * dense[l][j]).sum();
        (if i == j { 2.0 * mass[i] } else { 0.0 }) - 0.5 * dt * dt * dense[i][j] - b * square
    };
    let z: Vec<Vec<f64>> = gaps
        .iter()
        .map(|gap| {
            let mut z = vec![0.0; n];
            gap.column.add_to(1.0, &mut z);
            z
        })
        .collect();
    let pushed = |z: &Vec<f64>| -> Vec<f64> {
        let force = |i: usize| a * z[i] + b * (0..n).map(|l| dense[i][l] / mass[l] * z[l]).sum::<f64>();
        (0..n).map(force).collect()
    };
    let matrix = (0..n).map(|i| (0..n).map(|j| system(i, j)).collect()).collect();
    let moved = solve(matrix, z.iter().map(pushed).collect());
    let own = |i: usize| 1.0 / (point.stiffness_penalty.get() * gaps[i].scale);
    let rate = point.ratio.get() * model.reference().unwrap();
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let over_mass = |z: &[f64]| -> Vec<f64> { z.iter().zip(&mass).map(|(z, m)| z / m).collect() };
    let entry = |i: usize, j: usize| {
        let mu = dot(&z[i], &over_mass(&z[j]));
        (if i == j { own(i) } else { 0.0 }) + mu / rate - dot(&z[i], &moved[j])
    };
    is_definite((0..z.len()).map(|i| (0..z.len()).map(|j| entry(i, j)).collect()).collect())
}

/// Gauss with pivots: the solutions of A x = each of `right`.
fn solve(mut a: Vec<Vec<f64>>, mut right: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    for p in 0..n {
        let best = (p..n).max_by(|i, j| a[*i][p].abs().total_cmp(&a[*j][p].abs())).unwrap();
        a.swap(p, best);
        right.iter_mut().for_each(|x| x.swap(p, best));
        let pivot = a[p].clone();
        for i in p + 1..n {
            let factor = a[i][p] / pivot[p];
            (p..n).for_each(|j| a[i][j] -= factor * pivot[j]);
            right.iter_mut().for_each(|x| x[i] -= factor * x[p]);
        }
    }
    for x in &mut right {
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| a[i][j] * x[j]).sum();
            x[i] = (x[i] - known) / a[i][i];
        }
    }
    right
}

/// Cholesky's test.
fn is_definite(mut a: Vec<Vec<f64>>) -> bool {
    let n = a.len();
    for p in 0..n {
        if a[p][p] <= 0.0 {
            return false;
        }
        let pivot = a[p].clone();
        for row in &mut a[p + 1..] {
            let factor = row[p] / pivot[p];
            for (entry, above) in row.iter_mut().zip(&pivot).skip(p + 1) {
                *entry -= factor * above;
            }
        }
    }
    true
}
