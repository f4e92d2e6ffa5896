//! Far below t = 0: ratios below 1 and large beta_s, to the width that single points are asked to.

use bipenalty::convex::{Asked, Curve, Enclosed, MeshPencil, Options, TooWide};
use bipenalty::fem::MassMatrix;
use bipenalty::mesh::MeshScene;
use bipenalty::pencil::{Gap, Matrix};
use bipenalty::sparse::{Csr, SparseVector};

use crate::exact::Exact;
use crate::numbers::Numbers;
use crate::random_pencil;
use crate::scenes::random_mesh;

fn mesh_pencil(seed: u64) -> MeshPencil {
    let scene = MeshScene::parse(&random_mesh(seed), "m.toml").unwrap();
    let mass = if seed.is_multiple_of(3) { MassMatrix::CONSISTENT } else { MassMatrix::LUMPED };
    let assembled = scene.assemble(mass).unwrap();
    let gaps = assembled.gaps();
    MeshPencil::new(Matrix::Sparse(assembled.stiffness), assembled.mass, gaps).unwrap()
}

/// Sixteen points of a map, one of the pure penalty method.
fn random_points(random: &mut Numbers, mesh: f64) -> Vec<Asked> {
    let point = |i| {
        let stiffness = random.log(1e-6, 1e12);
        let ratio = if i == 0 { f64::INFINITY } else { random.log(1e-2, 1e3) };
        Asked::of(stiffness, ratio, mesh)
    };
    (0..16).map(point).collect()
}

/// The limits are those of double-double arithmetic, which takes too long beyond this many unknowns.
const JUDGED: usize = 60;

/// Encloses random points of a pencil to 1e-9: how many, and how many with |t| mu beyond 1e7 l, where n roundings of |t| mu take
/// more than that from a proof in the unknowns of the matrices.
fn enclosed_all(pencil: &MeshPencil, random: &mut Numbers, place: &str) -> (usize, usize) {
    let mut curve = Curve::new(pencil, Options { tolerance: 1e-9, ..Options::default() }).unwrap();
    let asked = random_points(random, curve.mesh());
    let exact = (pencil.size() <= JUDGED).then(|| Exact::new(pencil));
    let found = curve.enclose(&asked);
    let mu = curve.upper().slope();
    let mut far = 0;
    for (asked, found) in asked.iter().zip(found) {
        let place = format!("{place}, {} unknowns, {asked:?}, {found:?}", pencil.size());
        let Enclosed { lower, upper } = found.unwrap_or_else(|wide| panic!("{place}: {wide}"));
        far += usize::from((asked.stiffness - lower * asked.mass) * mu < -1e7 * lower);
        if let Some(exact) = &exact {
            let error = exact.error(lower, mu, *asked);
            assert!(error < 1e-12, "{place}: the oracle errs by {error:e}");
            assert!(!exact.above(lower * (1.0 - error), *asked), "{place}");
            assert!(exact.above(upper * (1.0 + error), *asked), "{place}");
        }
    }
    (asked.len(), far)
}

/// Contacts that share unknowns, up to as many as there are, some of them dependent.
#[test]
fn points_of_random_pencils_are_enclosed_to_1e_9_wherever_t_lies() {
    let mut random = Numbers(3);
    let (mut points, mut far) = (0, 0);
    for case in 0..200 {
        let pencil = random_pencil(&mut random);
        let found = enclosed_all(&pencil, &mut random, &format!("pencil {case}"));
        (points, far) = (points + found.0, far + found.1);
    }
    println!("{points} points, {far} far below t = 0");
    assert!(far > 200, "{far} of {points}");
}

/// Nodes on faces and on walls, of any element in the plane and in space, lumped and consistent.
#[test]
fn points_of_random_meshes_are_enclosed_to_1e_9_wherever_t_lies() {
    let mut random = Numbers(12);
    let (mut points, mut far) = (0, 0);
    for seed in 0..150 {
        let found = enclosed_all(&mesh_pencil(seed), &mut random, &format!("mesh {seed}"));
        (points, far) = (points + found.0, far + found.1);
    }
    println!("{points} points, {far} far below t = 0");
    assert!(far > 150, "{far} of {points}");
}

fn unit() -> Matrix {
    Matrix::Diagonal(vec![1.0; 2])
}

fn gap(entries: &[(u32, f64)], scale: f64) -> Gap {
    Gap { column: SparseVector(entries.to_vec()), scale, initial: 0.0 }
}

/// Two masses, of scales 1 and 1e-12 N/m: at t = -5e11 N/m f = 1/2 is what is left of terms of 5e11. Each is a gap of its
/// own; what rounding forbids is a width of less than its unit.
#[test]
fn a_width_that_rounding_forbids_is_said() {
    let pencil =
        MeshPencil::new(unit(), unit(), vec![gap(&[(0, 1.0)], 1.0), gap(&[(1, 1.0)], 1e-12)]).unwrap();
    let mut curve = Curve::new(&pencil, Options::default()).unwrap();
    let point = [Asked { stiffness: 5e11, mass: 2e12 }];
    let near = curve.enclose_to(&point, 1e-12)[0].unwrap();
    let TooWide { enclosed, tolerance } = curve.enclose_to(&point, 1e-16)[0].unwrap_err();
    for enclosed in [near, enclosed] {
        assert!(enclosed.lower <= 0.5 && 0.5 <= enclosed.upper && enclosed.upper < 0.6, "{enclosed:?}");
    }
    assert!(tolerance == 1e-16 && enclosed.step_width() > tolerance);
}

/// A gap with entries so unlike that no unknown stands for it: proven as it stands, to n roundings of |t| mu at best, and said.
#[test]
fn where_gaps_make_no_unknowns_the_width_is_said() {
    let k = Csr::from_triplets(2, 2, &[(0, 0, 2.0), (1, 1, 1.0), (0, 1, -1.0), (1, 0, -1.0)]);
    let of = |entry| {
        let gaps = vec![gap(&[(0, 1.0), (1, -1.0)], 1.0), gap(&[(0, entry), (1, 1.0)], 1e-9)];
        let pencil = MeshPencil::new(Matrix::Sparse(k.clone()), unit(), gaps).unwrap();
        let mut curve = Curve::new(&pencil, Options { tolerance: 1e-9, ..Options::default() }).unwrap();
        let asked = Asked { stiffness: 5e8, mass: 2e9 };
        (Exact::new(&pencil), asked, curve.enclose(&[asked])[0])
    };
    let (_, _, found) = of(1e-90);
    assert!(found.is_ok(), "{found:?}");
    let (exact, asked, found) = of(1e-120);
    let TooWide { enclosed, .. } = found.unwrap_err();
    assert!(enclosed.step_width() < 1e-4, "{enclosed:?}");
    assert!(!exact.above(enclosed.lower * (1.0 - 1e-15), asked), "{enclosed:?}");
    assert!(exact.above(enclosed.upper * (1.0 + 1e-15), asked), "{enclosed:?}");
}
