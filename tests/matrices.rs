//! Matrices of other codes: what is read, and what is refused with its file and line.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use bipenalty::matrices::{Matrices, MatrixScene, Reference, parse};
use bipenalty::pencil::Matrix;
use bipenalty::sparse::{Csr, SparseVector};

/// A folder of its own for one case.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("matrices").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

const K: &str = "%%MatrixMarket matrix coordinate real symmetric\n% a bar of two elements\n3 3 5\n1 1 1.0\n2 1 -1.0\n2 2 2.0\n3 2 -1.0\n3 3 1.0\n";
const M: &str = "%%MatrixMarket matrix array real general\n3 1\n0.5\n1\n0.5\n";
const Z: &str = "%%MatrixMarket matrix coordinate integer general\n3 2 2\n1 1 -1\n3 2 1\n";
const SCENE: &str = "name = \"bar\"\n[matrices]\nstiffness = \"K.mtx\"\nmass = \"M.mtx\"\ngaps = \"Z.mtx\"\n";

fn scene(
    case: &str,
    k: &str,
    m: &str,
    z: &str,
    w: Option<&str>,
) -> bipenalty::error::Result<bipenalty::matrices::Matrices> {
    let folder = folder(case);
    for (name, text) in [("K.mtx", k), ("M.mtx", m), ("Z.mtx", z), ("w.mtx", w.unwrap_or(""))] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let scales = if w.is_some() { "scales = \"w.mtx\"\n" } else { "" };
    MatrixScene::parse(&format!("{SCENE}{scales}"), folder.join("scene.toml").to_str().unwrap())?.read()
}

#[test]
fn a_bar_as_matrices_is_the_bar() {
    let read = scene("bar", K, M, Z, None).unwrap();
    assert_eq!((read.stiffness.len(), read.stiffness.get(0, 1), read.stiffness.get(1, 0)), (7, -1.0, -1.0));
    assert_eq!(read.mass, Matrix::Diagonal(vec![0.5, 1.0, 0.5]));
    assert_eq!((read.gaps[0].0.clone(), read.gaps[1].0.clone()), (vec![(0, -1.0)], vec![(2, 1.0)]));
    // EA/h of the element at each end.
    assert_eq!(read.scales, [1.0, 1.0]);
    assert_eq!(read.reference, Reference::Mesh);
    let given =
        scene("scales", K, M, Z, Some("%%MatrixMarket matrix array real general\n2 1\n3\n4\n")).unwrap();
    assert_eq!(given.scales, [3.0, 4.0]);
}

/// The scale of a gap between two bodies is that of the softer one; K's connections tell the bodies.
#[test]
fn unconnected_parts_are_bodies() {
    let k = "%%MatrixMarket matrix coordinate real general\n4 4 8\n1 1 5\n1 2 -5\n2 1 -5\n2 2 5\n3 3 2\n3 4 -2\n4 3 -2\n4 4 2\n";
    let m = "%%MatrixMarket matrix array real general\n4 1\n1\n1\n1\n1\n";
    let z = "%%MatrixMarket matrix coordinate real general\n4 1 2\n2 1 1\n3 1 -1\n";
    assert_eq!(scene("bodies", k, m, z, None).unwrap().scales, [2.0]);
}

#[test]
fn every_form_of_a_matrix_reads_the_same() {
    let path = Path::new("K.mtx");
    let whole = |text: &str| {
        let read = parse(text, path).unwrap();
        let mut entries = read.whole();
        entries.sort_by_key(|(i, j, _)| (*i, *j));
        (read.rows, entries)
    };
    let expected = whole(K);
    let forms = [
        "%%matrixmarket MATRIX Coordinate Real General\n3 3 7\n1 1 1\n1 2 -1\n2 1 -1\n2 2 2\n2 3 -1\n3 2 -1\n3 3 1\n",
        "** Abaqus, the lower triangle\n4,1, 4,1, 1.0\n7,1, 4,1, -1.0D0\n7,1, 7,1, 2.\n9,1, 7,1, -1.\n9,1, 9,1, 1.e0\n",
        "9,1,9,1,1.0\n4,1,7,1,-1.0\n7,1,7,1,2.0\n9,1,7,1,-1.0\n4,1,4,1,1.0\n",
        "  1   1   1.0\n  2   1  -1.0\n  2   2   2.0\n  3   2  -1.0\n  3   3   1.0\n",
        "1, 1, 1.0\n1, 2, -1.0\n2, 1, -1.0\n2, 2, 2.0\n2, 3, -1.0\n3, 2, -1.0\n3, 3, 1.0\n",
    ];
    for form in forms {
        assert_eq!(whole(form), expected, "{form}");
    }
    let array = "%%MatrixMarket matrix array real symmetric\n3 3\n1\n-1\n0\n2\n-1\n1\n";
    let stored = whole(array).1.into_iter().filter(|(.., value)| *value != 0.0).collect::<Vec<_>>();
    assert_eq!(stored, expected.1);
}

#[test]
fn what_cannot_be_used_is_refused_with_file_and_line() {
    let change = |text: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    let k = |from: &str, to: &str| (change(K, from, to), M.to_owned(), Z.to_owned());
    let m = |text: &str| (K.to_owned(), text.to_owned(), Z.to_owned());
    let z = |text: &str| (K.to_owned(), M.to_owned(), text.to_owned());
    let general = "%%MatrixMarket matrix coordinate real general\n3 3 7\n1 1 1\n1 2 -1\n2 1 -1\n2 2 2\n2 3 -1\n3 2 -1.001\n3 3 1\n";
    let head = "%%MatrixMarket matrix coordinate real symmetric\n";
    let cases = [
        (
            "unsymmetric",
            (general.to_owned(), M.to_owned(), Z.to_owned()),
            "K.mtx, line 7",
            "a symmetric matrix",
        ),
        ("index", k("3 2 -1.0", "4 2 -1.0"), "K.mtx, line 7: row 4", "1 to 3"),
        ("zero-index", k("3 2 -1.0", "3 0 -1.0"), "K.mtx, line 7: column 0", "1 to 3"),
        ("nan", k("2 2 2.0", "2 2 nan"), "K.mtx, line 6", "a finite number"),
        ("inf", k("2 2 2.0", "2 2 1e999"), "K.mtx, line 6", "a finite number"),
        ("word", k("2 2 2.0", "2 2 two"), "K.mtx, line 6: \"two\"", "a finite number"),
        ("short-line", k("2 2 2.0", "2 2"), "K.mtx, line 6", "a finite number"),
        ("long-line", k("2 2 2.0", "2 2 2.0 7"), "K.mtx, line 6: \"7\"", "the end of the line"),
        ("truncated", k("3 3 1.0\n", ""), "K.mtx, line 7: the end of the file after 4 entries", "5 entries"),
        ("surplus", k("3 3 1.0\n", "3 3 1.0\n3 3 1.0\n"), "K.mtx, line 9", "5 entries"),
        ("upper", k("3 2 -1.0", "2 3 -1.0"), "K.mtx, line 7", "the lower triangle"),
        ("oblong", k("3 3 5", "3 4 5"), "K.mtx, line 3: 3 x 4", "square"),
        ("count", k("3 3 5", "3 3 99999999999"), "K.mtx, line 3", "an integer below"),
        ("banner", k("real", "complex"), "K.mtx, line 1", "real|integer"),
        ("empty", (String::new(), M.to_owned(), Z.to_owned()), "K.mtx, line 1", "at least one entry"),
        (
            "abaqus-short",
            ("1,1,1,1,2.0\n1,1,2,1\n".to_owned(), M.to_owned(), Z.to_owned()),
            "K.mtx, line 2",
            "node, dof, node, dof, value",
        ),
        (
            "abaqus-held",
            ("1,1,1,1,1e36\n".to_owned(), M.to_owned(), Z.to_owned()),
            "K.mtx, line 1",
            "held degree of freedom",
        ),
        (
            "mass-size",
            m("%%MatrixMarket matrix array real general\n2 1\n1\n1\n"),
            "M.mtx, line 2: 2 x 1",
            "3 x 3",
        ),
        (
            "mass-zero",
            m("%%MatrixMarket matrix array real general\n3 1\n0.5\n0\n1\n"),
            "M.mtx, line 4: mass 0 of unknown 2",
            "above 0",
        ),
        (
            "mass-negative",
            m(&format!("{head}3 3 3\n1 1 1\n2 2 1\n3 3 -1\n")),
            "M.mtx, line 5: mass -1",
            "above 0",
        ),
        ("mass-missing", m(&format!("{head}3 3 2\n1 1 1\n2 2 1\n")), "mass 0 of unknown 3", "above 0"),
        (
            "mass-indefinite",
            m(&format!("{head}3 3 4\n1 1 1\n2 1 2\n2 2 1\n3 3 1\n")),
            "M.mtx, line 4: entry",
            "positive definite",
        ),
        (
            "gap-zero",
            z("%%MatrixMarket matrix coordinate real general\n3 2 2\n1 1 -1\n3 2 0.0\n"),
            "Z.mtx, line 4: column 2",
            "other than 0",
        ),
        (
            "gap-missing",
            z("%%MatrixMarket matrix coordinate real general\n3 2 1\n1 1 -1\n"),
            "Z.mtx, line 2: column 2",
            "other than 0",
        ),
        (
            "gap-size",
            z("%%MatrixMarket matrix coordinate real general\n4 1 1\n1 1 -1\n"),
            "Z.mtx, line 2: 4 x 1",
            "3 x k",
        ),
        (
            "gap-rigid",
            z("%%MatrixMarket matrix array real general\n3 1\n1\n1\n1\n"),
            "Z.mtx, line 3: scale 0",
            "scales = a file",
        ),
    ];
    for (case, (k, m, z), place, allowed) in cases {
        let message = scene(case, &k, &m, &z, None).map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(place) && message.contains(allowed), "{case}: {message}");
    }
    let w =
        scene("scale", K, M, Z, Some("%%MatrixMarket matrix array real general\n2 1\n3\n-4\n")).map(|_| ());
    let message = w.unwrap_err().to_string();
    assert!(message.contains("w.mtx, line 4: scale -4 of contact 2"), "{message}");
}

#[test]
fn rounding_of_the_other_triangle_is_allowed_and_removed() {
    let general = "%%MatrixMarket matrix coordinate real general\n3 3 7\n1 1 1\n1 2 -1\n2 1 -1.00000000000001\n2 2 2\n2 3 -1\n3 2 -1\n3 3 1\n";
    let read = scene("rounded", general, M, Z, None).unwrap();
    assert_eq!(read.stiffness.get(0, 1), read.stiffness.get(1, 0));
}

#[test]
fn scenes_are_refused_with_their_line() {
    let refused = |from: &str, to: &str| {
        let text = format!("{SCENE}reference = 4.0\n").replacen(from, to, 1);
        MatrixScene::parse(&text, "s.toml").unwrap_err().to_string()
    };
    assert!(
        refused("reference = 4.0", "reference = -4.0").contains("s.toml, line 6, matrices.reference: -4")
    );
    assert!(
        refused("reference = 4.0", "reference = \"element\"").contains("s.toml, line 6, matrices.reference")
    );
    assert!(refused("gaps", "gabs").contains("s.toml, line 5"));
    assert!(refused("\"bar\"", "\"b a\"").contains("s.toml, line 1, name"));
    let scene = MatrixScene::parse(&format!("{SCENE}reference = 4.0\n"), "s.toml").unwrap();
    assert_eq!(scene.reference, Reference::OmegaSquared(4.0));
    assert!(scene.read().unwrap_err().to_string().contains("K.mtx"));
}

/// Lund A and B of the Harwell-Boeing collection: the largest eigenvalue of a real structure.
#[test]
fn lund_has_its_largest_eigenvalue() {
    let folder = format!("{}/tests/data/lund", env!("CARGO_MANIFEST_DIR"));
    let gaps =
        folder_file("lund", "Z.mtx", "%%MatrixMarket matrix coordinate real general\n147 1 1\n1 1 1\n");
    let text = format!(
        "name = \"lund\"\n[matrices]\nstiffness = \"{folder}/stiffness.mtx\"\nmass = \"{folder}/mass.mtx\"\ngaps = {gaps:?}\n"
    );
    let read = MatrixScene::parse(&text, "lund.toml").unwrap().read().unwrap();
    let Matrix::Sparse(mass) = &read.mass else { panic!("a consistent mass") };
    // Power iteration on M^-1 K by a dense factorisation.
    let n = mass.rows();
    let dense = faer::Mat::from_fn(n, n, |i, j| mass.get(i, j));
    let llt = dense.llt(faer::Side::Lower).unwrap();
    let (mut x, mut kx) = (vec![1.0; n], vec![0.0; n]);
    x.iter_mut().enumerate().for_each(|(i, x)| *x += (i as f64).sin());
    let mut largest = 0.0;
    for _ in 0..4000 {
        read.stiffness.multiply(&x, &mut kx);
        let mut y = faer::Mat::from_fn(n, 1, |i, _| kx[i]);
        faer::linalg::solvers::Solve::solve_in_place(&llt, y.as_mut());
        let energy: f64 = x.iter().zip(&kx).map(|(x, kx)| x * kx).sum();
        let mut mx = vec![0.0; n];
        mass.multiply(&x, &mut mx);
        largest = energy / x.iter().zip(&mx).map(|(x, mx)| x * mx).sum::<f64>();
        let norm = (0..n).map(|i| y[(i, 0)].powi(2)).sum::<f64>().sqrt();
        x.iter_mut().enumerate().for_each(|(i, x)| *x = y[(i, 0)] / norm);
    }
    assert!((largest / 2.20462364e6 - 1.0).abs() < 1e-8, "{largest}");
}

/// Rounding leaves what is zero on one side of the diagonal: stored or not, the mean is that of both.
#[test]
fn a_mirror_that_is_zero_counts_once() {
    let bar = [(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0), (1, 2, -1.0), (2, 1, -1.0), (2, 2, 1.0)];
    let tiny = 1e-16;
    for rounding in [vec![(0, 2, tiny)], vec![(0, 2, tiny), (2, 0, 0.0)], vec![(2, 0, tiny), (0, 2, 0.0)]] {
        let k = Csr::from_triplets(3, 3, &[&bar[..], &rounding].concat());
        let gaps = vec![SparseVector(vec![(2, 1.0)])];
        let mass = Matrix::Diagonal(vec![1.0; 3]);
        let read = Matrices::new(k, mass, gaps, None, Reference::Mesh).unwrap();
        assert_eq!([read.stiffness.get(0, 2), read.stiffness.get(2, 0)], [0.5 * tiny; 2]);
    }
}

fn folder_file(case: &str, name: &str, text: &str) -> PathBuf {
    let path = folder(case).join(name);
    std::fs::write(&path, text).unwrap();
    path
}
