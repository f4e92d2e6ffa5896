//! Far below t = 0: ratios below 1 and large beta_s, to the width that single points are asked to.

use bipenalty::convex::{Asked, Curve, Enclosed, MeshPencil, Options};
use bipenalty::fem::MassMatrix;
use bipenalty::mesh::MeshScene;
use bipenalty::pencil::Matrix;

use crate::exact::Exact;
use crate::numbers::Numbers;
use crate::scenes::random_mesh;
use crate::{enclosure, random_pencil};

/// The pencil of a random mesh.
fn pencil(seed: u64) -> MeshPencil {
    let scene = MeshScene::parse(&random_mesh(seed), "m.toml").unwrap();
    let mass = if seed % 3 == 0 { MassMatrix::CONSISTENT } else { MassMatrix::LUMPED };
    let assembled = scene.assemble(mass).unwrap();
    let gaps = assembled.gaps();
    MeshPencil::new(Matrix::Sparse(assembled.stiffness), assembled.mass, gaps).unwrap()
}

#[test]
fn survey() {
    let mut random = Numbers(std::env::var("SEED").map_or(11, |s| s.parse().unwrap()));
    let first = random.0 * 300;
    let tolerance: f64 = std::env::var("TOL").map_or(1e-9, |s| s.parse().unwrap());
    for kind in 0..2 {
        let (mut points, mut wide, mut bad) = (0, 0, 0);
        for case in 0..300 {
            let pencil = if kind == 0 { random_pencil(&mut random) } else { pencil(first + case) };
            let mut curve =
                Curve::new(&pencil, Options { tolerance, ..Options::default() }).unwrap();
            let mesh = curve.mesh();
            let asked: Vec<Asked> = (0..16)
                .map(|i| {
                    let stiffness = random.log(1e-6, 1e12);
                    let ratio = if i == 0 { f64::INFINITY } else { random.log(1e-2, 1e3) };
                    Asked::of(stiffness, ratio, mesh)
                })
                .collect();
            let exact = (pencil.size() <= 60).then(|| Exact::new(&pencil));
            for (asked, found) in asked.iter().zip(curve.enclose(&asked)) {
                let Enclosed { lower, upper } = enclosure(found);
                points += 1;
                let x = (asked.stiffness - lower * asked.mass) * curve.upper().slope() / lower;
                if found.is_err() {
                    wide += 1;
                    println!(
                        "kind {kind} case {case} n {} s {:e} x {x:e} width {:e}",
                        pencil.size(),
                        asked.stiffness,
                        enclosure(found).step_width()
                    );
                }
                if let Some(exact) = &exact {
                    let error = exact.error(lower, curve.upper().slope(), *asked);
                    let ok = !exact.above(lower * (1.0 - error), *asked)
                        && exact.above(upper * (1.0 + error), *asked);
                    bad += usize::from(!ok);
                }
            }
        }
        println!("kind {kind}: {wide} of {points}, {bad} do not hold");
    }
}

#[test]
fn probe() {
    let mut random = Numbers(3);
    for case in 0..300 {
        let pencil = random_pencil(&mut random);
        let mut curve = Curve::new(&pencil, Options { tolerance: 1e-9, ..Options::default() }).unwrap();
        let mesh = curve.mesh();
        let asked: Vec<Asked> = (0..16)
            .map(|i| {
                let stiffness = random.log(1e-6, 1e12);
                let ratio = if i == 0 { f64::INFINITY } else { random.log(1e-2, 1e3) };
                Asked::of(stiffness, ratio, mesh)
            })
            .collect();
        if ![20, 116].contains(&case) {
            continue;
        }
        let found = curve.enclose(&asked);
        for (asked, found) in asked.iter().zip(found) {
            if found.is_err() {
                let e = enclosure(found);
                println!("case {case} mesh {mesh:e} {asked:?} {e:?} t {:e}", asked.stiffness - e.lower * asked.mass);
                let exact = Exact::new(&pencil);
                for share in [0.0, 0.01, 0.5, 0.99, 1.0] {
                    let l = e.lower + share * (e.upper - e.lower);
                    println!("  {share} above {}", exact.above(l, *asked));
                }
                let mut points = curve.upper().points().to_vec();
                points.sort_by(|a, b| a.t.total_cmp(&b.t));
                for p in &points {
                    let low = curve.lower_at(p.t);
                    println!("   {:e} {:e} {:e} reach {:e}", p.t, p.u, p.u / low - 1.0, (asked.stiffness-p.t)/asked.mass/e.lower-1.0);
                }
            }
        }
    }
}
