//! Meshes: element matrices against an independent assembler, patches, rigid motions, mass, convergence, contact.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "mesh/contact.rs"]
mod contact;
#[path = "mesh/files.rs"]
mod files;

use bipenalty::fem::MassMatrix;
use bipenalty::mesh::elasticity::{ElementMatrices, Lumping, Material, Plane};
use bipenalty::mesh::element::{Coordinates, Kind};
use bipenalty::mesh::structured::Cuboid;
use bipenalty::mesh::{Assembled, Body, Elements, MeshScene};
use bipenalty::pencil::Matrix;
use bipenalty::sparse::Csr;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};

pub(crate) fn material(nu: f64) -> Material {
    Material { youngs_modulus: 2.5, poissons_ratio: nu, density: 1.7, thickness: 1.0 }
}

/// The eigenvalues of the dense pencil (K, M), ascending.
fn eigenvalues(k: &Mat<f64>, m: &Mat<f64>) -> Vec<f64> {
    let n = k.nrows();
    let llt = m.llt(Side::Lower).expect("a definite mass");
    let mut left = k.clone();
    solve_lower_triangular_in_place(llt.L(), left.as_mut(), Par::Seq);
    let mut both = left.transpose().to_owned();
    solve_lower_triangular_in_place(llt.L(), both.as_mut(), Par::Seq);
    let both = Mat::from_fn(n, n, |i, j| 0.5 * (both[(i, j)] + both[(j, i)]));
    both.self_adjoint_eigenvalues(Side::Lower).unwrap()
}

fn dense(matrix: &Csr) -> Mat<f64> {
    Mat::from_fn(matrix.rows(), matrix.columns(), |i, j| matrix.get(i, j))
}

fn dense_mass(mass: &Matrix) -> Mat<f64> {
    let mut dense = Mat::zeros(mass.size(), mass.size());
    (0..mass.size()).for_each(|i| mass.row(i).for_each(|(j, m)| dense[(i, j)] = m));
    dense
}

fn spectrum(assembled: &Assembled) -> Vec<f64> {
    eigenvalues(&dense(&assembled.stiffness), &dense_mass(&assembled.mass))
}

fn element_spectrum(
    kind: Kind,
    nodes: &[Coordinates],
    nu: f64,
    plane: Option<Plane>,
    gamma: f64,
) -> Vec<f64> {
    let element = kind.element();
    let computed = ElementMatrices::new(element, nodes, &material(nu), plane).unwrap();
    let (n, d, mass) = (nodes.len(), element.dimension, computed.mass(element, gamma));
    let k = Mat::from_fn(n * d, n * d, |i, j| computed.stiffness[i * n * d + j]);
    let m = Mat::from_fn(n * d, n * d, |i, j| if i % d == j % d { mass[i / d * n + j / d] } else { 0.0 });
    eigenvalues(&k, &m)
}

pub(crate) fn plane(kind: Kind) -> Option<Plane> {
    (kind.element().dimension == 2).then_some(Plane::Strain)
}

/// The nodes of a box's mesh, moved by `f`, with its elements.
pub(crate) fn body(kind: Kind, cells: [usize; 3], f: impl Fn(Coordinates) -> Coordinates) -> Body {
    let cells = if kind.element().dimension == 2 { [cells[0], cells[1], 1] } else { cells };
    let cuboid = Cuboid { size: [2.0, 1.5, 1.0], cells, origin: [0.3, -0.2, 0.1], kind };
    let mut mesh = cuboid.mesh();
    mesh.distort(f);
    Body { name: "body".into(), mesh, material: material(0.3), velocity: [0.0; 3] }
}

fn elements(kind: Kind, cells: [usize; 3], gamma: f64, f: impl Fn(Coordinates) -> Coordinates) -> Elements {
    Elements::new(vec![body(kind, cells, f)], kind.element().dimension, plane(kind), gamma)
}

/// A bend that changes every element's shape and keeps every Jacobian positive.
pub(crate) fn bend(x: Coordinates) -> Coordinates {
    let [a, b, c] = x;
    [
        a + 0.1 * (2.0 * b).sin() + 0.05 * a * c,
        b + 0.08 * (3.0 * a).cos() + 0.04 * c * c,
        c * (1.0 + 0.1 * a * b),
    ]
}

#[test]
fn element_matrices_are_those_of_an_independent_assembler() {
    let table: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string("tests/data/elements.json").unwrap()).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let numbers =
        |value: &serde_json::Value| value.as_array().unwrap().iter().map(number).collect::<Vec<_>>();
    let of = &table["material"];
    let rows = table["elements"].as_array().unwrap();
    assert_eq!(rows.len(), 12, "four plane elements twice, four of space");
    for row in rows {
        let name = row["element"].as_str().unwrap();
        let kind = Kind::ALL.into_iter().find(|kind| kind.element().name == name).unwrap();
        let places = row["nodes"].as_array().unwrap().iter().map(numbers);
        let nodes: Vec<Coordinates> =
            places.map(|x| std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0))).collect();
        let plane = row["plane"].as_str().map(|p| if p == "strain" { Plane::Strain } else { Plane::Stress });
        let material = Material {
            youngs_modulus: number(&of["youngs_modulus"]),
            poissons_ratio: number(&of["poissons_ratio"]),
            density: number(&of["density"]),
            thickness: if plane.is_some() { number(&of["thickness"]) } else { 1.0 },
        };
        let computed = ElementMatrices::new(kind.element(), &nodes, &material, plane).unwrap();
        for (ours, lower) in [(&computed.stiffness, &row["stiffness"]), (&computed.mass, &row["mass"])] {
            let (size, lower) = (ours.len().isqrt(), numbers(lower));
            assert_eq!(lower.len(), size * (size + 1) / 2);
            let largest = lower.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            for (at, (i, j)) in (0..size).flat_map(|i| (0..=i).map(move |j| (i, j))).enumerate() {
                let error =
                    (ours[i * size + j] - lower[at]).abs().max((ours[j * size + i] - lower[at]).abs());
                assert!(error < 1e-12 * largest, "{name} {plane:?} ({i}, {j}): {error:e} of {largest}");
            }
        }
    }
}

/// A linear displacement on a distorted mesh: no force at inner nodes, and the energy of the constant strain.
#[test]
fn constant_strain_passes_the_patch_test() {
    for kind in Kind::ALL {
        let d = kind.element().dimension;
        // Straight edges: middle nodes stay in the middle, as a linear field needs for serendipity elements.
        let elements = elements(kind, [3, 2, 2], 1.0, bend);
        let k = elements.stiffness().unwrap();
        let gradient = [[0.3, -0.2, 0.5], [0.1, 0.4, -0.3], [0.2, 0.6, -0.1]];
        let nodes = &elements.bodies[0].mesh.nodes;
        let u: Vec<f64> = nodes
            .iter()
            .flat_map(|x| (0..d).map(move |i| (0..d).map(|j| gradient[i][j] * x[j]).sum::<f64>()))
            .collect();
        let mut force = vec![0.0; u.len()];
        k.multiply(&u, &mut force);
        let mesh = &elements.bodies[0].mesh;
        let outer: Vec<u32> = mesh.surfaces.values().flat_map(|faces| mesh.nodes_of(faces)).collect();
        let largest = force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        let inner = (0..nodes.len()).filter(|node| !outer.contains(&(*node as u32)));
        let rest = inner.flat_map(|node| &force[node * d..][..d]).fold(0.0_f64, |most, f| most.max(f.abs()));
        assert!(rest < 1e-13 * largest.max(1.0), "{kind:?}: {rest:e} of {largest}");
        let strain = |i: usize, j: usize| 0.5 * (gradient[i][j] + gradient[j][i]);
        let (e, nu) = (2.5, 0.3);
        let (mu, lambda) = (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
        let trace: f64 = (0..d).map(|i| strain(i, i)).sum();
        let square: f64 = (0..d).flat_map(|i| (0..d).map(move |j| strain(i, j).powi(2))).sum();
        let mass: f64 =
            (0..elements.len()).map(|e| elements.matrices(e).unwrap().1.iter().sum::<f64>()).sum();
        let exact = (lambda * trace * trace + 2.0 * mu * square) * mass / 1.7;
        let energy: f64 = u.iter().zip(&force).map(|(u, f)| u * f).sum();
        assert!((energy / exact - 1.0).abs() < 1e-12, "{kind:?}: {energy} {exact}");
    }
}

#[test]
fn a_free_mesh_has_its_rigid_motions_and_no_others() {
    for (kind, gamma) in Kind::ALL.into_iter().flat_map(|kind| [0.0, 0.5, 1.0].map(|gamma| (kind, gamma))) {
        let d = kind.element().dimension;
        for cells in [[1, 1, 1], [2, 1, 1]] {
            let elements = elements(kind, cells, gamma, bend);
            let (k, m) = (elements.stiffness().unwrap(), elements.mass().unwrap());
            let values = eigenvalues(&dense(&k), &dense_mass(&m));
            let (rigid, largest) = (if d == 2 { 3 } else { 6 }, values[values.len() - 1]);
            assert!(values[rigid - 1].abs() < 1e-12 * largest, "{kind:?} {gamma}: {values:?}");
            assert!(values[rigid] > 1e-4 * largest, "{kind:?} {gamma}: {values:?}");
        }
    }
}

#[test]
fn the_mass_is_that_of_the_body_whatever_its_form() {
    for kind in Kind::ALL {
        let d = kind.element().dimension;
        let exact = 1.7 * 2.0 * 1.5 * d as f64;
        for gamma in [0.0, 0.3, 1.0] {
            let mass = elements(kind, [3, 2, 2], gamma, |x| x).mass().unwrap();
            assert_eq!(matches!(mass, Matrix::Diagonal(_)), gamma == 1.0);
            if gamma == 1.0 {
                assert!((0..mass.size()).all(|i| mass.diagonal(i) > 0.0), "{kind:?}");
            }
            let total: f64 = (0..mass.size()).flat_map(|i| mass.row(i)).map(|(_, m)| m).sum();
            assert!((total / exact - 1.0).abs() < 1e-13, "{kind:?} {gamma}: {total} {exact}");
        }
    }
}

#[test]
fn row_sums_of_second_order_are_refused() {
    for kind in Kind::ALL {
        let element = kind.element();
        let computed = ElementMatrices::new(element, element.nodes, &material(0.3), plane(kind)).unwrap();
        let sums = computed.lumped(element, Lumping::RowSums);
        assert_eq!(sums.is_err(), element.order() == 2, "{kind:?}");
        let scaled = computed.lumped(element, Lumping::ScaledDiagonal).unwrap();
        assert!(scaled.iter().all(|m| *m > 0.0));
    }
}

/// Closed forms in units of E/(rho a^2): squares with 2 x 2 points, the cube with nu = 0.3.
#[test]
fn squares_and_cubes_have_their_closed_form() {
    let (nu, a) = (0.3, 0.7);
    let unit = 2.5 / 1.7 / (a * a);
    let nodes = |kind: Kind| kind.element().nodes.iter().map(|x| x.map(|x| 0.5 * a * x)).collect::<Vec<_>>();
    let strain = (1.0 + nu) * (1.0 - 2.0 * nu);
    let cases = [
        (Kind::Quad4, Some(Plane::Stress), 1.0, 4.0 / (1.0 - nu)),
        (
            Kind::Quad4,
            Some(Plane::Stress),
            0.0,
            f64::max(12.0 / (1.0 - nu), 6.0 * (3.0 - nu) / (1.0 - nu * nu)),
        ),
        (Kind::Quad4, Some(Plane::Strain), 1.0, 4.0 / strain),
        (Kind::Quad4, Some(Plane::Strain), 0.0, f64::max(12.0, 6.0 * (3.0 - 4.0 * nu)) / strain),
        (Kind::Hex8, None, 1.0, 10.0),
    ];
    for (kind, plane, gamma, exact) in cases {
        let largest = *element_spectrum(kind, &nodes(kind), nu, plane, gamma).last().unwrap() / unit;
        assert!((largest / exact - 1.0).abs() < 1e-13, "{kind:?} {plane:?} {gamma}: {largest} {exact}");
    }
}

/// Rollers on all sides of a rectangle leave u = (sin(pi x) cos(pi y), -cos(pi x) sin(pi y)), without change of volume:
/// l = 2 pi^2 mu/rho. Consistent mass: the error falls with h^2 at first and h^4 at second order.
#[test]
fn eigenvalues_converge_with_their_order() {
    for kind in [Kind::Tri3, Kind::Quad4, Kind::Tri6, Kind::Quad8] {
        let errors: Vec<f64> = [4, 8].map(|n| error_of_shear_mode(kind, n)).into();
        let order = (errors[0] / errors[1]).log2();
        let expected = if kind.element().order() == 1 { 2.0 } else { 4.0 };
        assert!((order - expected).abs() < 0.35, "{kind:?}: {errors:?}, order {order}");
    }
}

fn error_of_shear_mode(kind: Kind, n: usize) -> f64 {
    let name = kind.element().name;
    let holds: String = [("left", "x"), ("right", "x"), ("bottom", "y"), ("top", "y")]
        .map(|(side, axis)| format!("[[hold]]\nsurface = \"b.{side}\"\ndirections = [\"{axis}\"]\n"))
        .concat();
    let text = format!(
        "name = \"b\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"b\"\nbox = [1, 1]\ncells = [{n}, {n}]\n\
         element = \"{name}\"\nyoungs_modulus = 2.5\npoissons_ratio = 0.25\ndensity = 1.7\n{holds}"
    );
    let assembled = MeshScene::parse(&text, "b.toml").unwrap().assemble(MassMatrix::CONSISTENT).unwrap();
    // mu = E/(2 (1 + nu)) = 1.
    let exact = 2.0 * std::f64::consts::PI.powi(2) / 1.7;
    let values = spectrum(&assembled);
    values.iter().map(|l| (l / exact - 1.0).abs()).fold(f64::INFINITY, f64::min)
}
