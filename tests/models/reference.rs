//! The reference of a mesh is l_max(K, M) itself: enclosures hold for the dense value, digit for digit.

use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Matrix;
use bipenalty::stability::{AnyModel, AnyScene, Asking, MeshModel};
use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, Par, Side};

use crate::scenes::{TWO_BLOCKS, random_mesh};

pub fn dense(matrix: &Matrix) -> Mat<f64> {
    let mut full = Mat::zeros(matrix.size(), matrix.size());
    (0..matrix.size()).for_each(|i| matrix.row(i).for_each(|(j, a)| full[(i, j)] = a));
    full
}

/// The eigenvalues of (K, M), ascending, and M-orthonormal vectors.
pub fn eigen(k: &Matrix, m: &Matrix) -> (Vec<f64>, Mat<f64>) {
    let (mut k, m) = (dense(k), dense(m));
    let factor = Llt::new(m.as_ref(), Side::Lower).unwrap();
    solve_lower_triangular_in_place(factor.L(), k.as_mut(), Par::Seq);
    let mut k = k.transpose().to_owned();
    solve_lower_triangular_in_place(factor.L(), k.as_mut(), Par::Seq);
    let n = k.nrows();
    let symmetric = Mat::from_fn(n, n, |i, j| 0.5 * (k[(i, j)] + k[(j, i)]));
    let found = symmetric.self_adjoint_eigen(Side::Lower).unwrap();
    let mut vectors = found.U().to_owned();
    solve_upper_triangular_in_place(factor.L().transpose(), vectors.as_mut(), Par::Seq);
    ((0..n).map(|i| found.S()[i]).collect(), vectors)
}

/// The eigenvalues of K + s P and M + m P, ascending.
pub fn spectrum(model: &MeshModel, s: f64, m: f64) -> Vec<f64> {
    let (stiffness, mass, gaps) = model.matrices();
    let (mut k, mut inertia) = (dense(stiffness), dense(mass));
    for gap in gaps {
        for ((i, a), (j, b)) in gap.column.0.iter().flat_map(|a| gap.column.0.iter().map(move |b| (a, b))) {
            let (i, j, p) = (*i as usize, *j as usize, gap.scale * a * b);
            k[(i, j)] += s * p;
            inertia[(i, j)] += m * p;
        }
    }
    let factor = Llt::new(inertia.as_ref(), Side::Lower).unwrap();
    solve_lower_triangular_in_place(factor.L(), k.as_mut(), Par::Seq);
    let mut k = k.transpose().to_owned();
    solve_lower_triangular_in_place(factor.L(), k.as_mut(), Par::Seq);
    let n = k.nrows();
    Mat::from_fn(n, n, |i, j| 0.5 * (k[(i, j)] + k[(j, i)])).self_adjoint_eigenvalues(Side::Lower).unwrap()
}

/// Points enclosed to 1e-9 hold the dense value with the dense reference, to what dense arithmetic itself loses.
#[test]
fn enclosures_hold_for_the_dense_reference() {
    let mut scenes = vec![TWO_BLOCKS.to_owned()];
    scenes.extend((0..25).map(random_mesh));
    for text in scenes {
        let model =
            AnyModel::new(&AnyScene::parse(&text, "m.toml").unwrap(), None, PenaltyMass::Consistent).unwrap();
        let AnyModel::Mesh(mesh) = &model else { panic!() };
        let free = *spectrum(mesh, 0.0, 0.0).last().unwrap();
        assert!((model.reference().unwrap() / free - 1.0).abs() < 1e-10, "{text}");
        for (beta_s, ratio) in
            [(0.0, 1.0), (0.3, 0.5), (5.0, 2.0), (100.0, 1.0), (1e4, 30.0), (1e3, f64::INFINITY)]
        {
            let l = *spectrum(mesh, beta_s, beta_s / (ratio * free)).last().unwrap();
            // Summed into K and M, the contact takes digits from them.
            let lost = 1e-14 * mesh.pencil().size() as f64 * (1.0 + beta_s / ratio.min(1e3));
            let step = model.critical_step(beta_s, ratio, &Asking::default()).unwrap().step.unwrap();
            let courant = (free / l).sqrt();
            let place = format!("{beta_s}, {ratio}: {step:?}, dense {courant}\n{text}");
            assert!(step.lower <= courant * (1.0 + lost) && courant <= step.upper * (1.0 + lost), "{place}");
            // Six roundings on the way to C_r and back.
            assert!(step.upper / step.lower - 1.0 <= 1e-9 + 6.0 * f64::EPSILON, "{place}");
        }
    }
}

/// What is left of the proof of the reference is part of the width: no row is wider than asked, where that is hard too.
#[test]
fn no_row_is_wider_than_asked() {
    let model = |cells: usize| {
        let text = format!(
            "name = \"c\"\ndimension = 3\n[[body]]\nname = \"c\"\nbox = [1.0, 1.0, 1.0]\ncells = [{cells}, {cells}, {cells}]\n\
             element = \"hex8\"\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\n[[contact]]\n\
             surfaces = [\"c.bottom\", \"wall\"]\n"
        );
        AnyModel::new(&AnyScene::parse(&text, "c.toml").unwrap(), None, PenaltyMass::Consistent).unwrap()
    };
    let cases = [3, 8, 13].into_iter().flat_map(|cells| (9..13).map(move |digits| (cells, digits)));
    for (cells, digits) in cases {
        let (model, tolerance) = (model(cells), 10_f64.powi(-digits));
        let asking = Asking { tolerance: Some(tolerance), ..Asking::default() };
        for (beta_s, ratio) in [(0.1, 0.5), (1.0, 1.0), (3.0, 4.0), (1e3, f64::INFINITY)] {
            let place = format!("{cells}, 1e-{digits}, {beta_s}, {ratio}");
            match model.critical_step(beta_s, ratio, &asking).unwrap().step {
                Ok(step) => {
                    assert!(step.upper / step.lower - 1.0 <= tolerance + 6.0 * f64::EPSILON, "{place}")
                }
                // The rounding of a factor leaves some 1e-11.
                Err(wide) => assert!(digits > 10, "{place}: {wide:?}"),
            }
        }
    }
}
