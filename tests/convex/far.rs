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
    let mut random = Numbers(11);
    for kind in 0..2 {
        let (mut points, mut wide, mut bad) = (0, 0, 0);
        for case in 0..300 {
            let pencil = if kind == 0 { random_pencil(&mut random) } else { pencil(case) };
            let mut curve =
                Curve::new(&pencil, Options { tolerance: 1e-9, ..Options::default() }).unwrap();
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
    let mut random = Numbers(11);
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
        if ![27, 46].contains(&case) {
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
                for t in [1e-12, 1e-8, 1e-4, 1e-2, 1.0].map(|part| part * (asked.stiffness - e.lower * asked.mass)) {
                        let f = curve.lower_at(t);
                        println!("    t {t:.9e} lower {f:.15e}");
                }
            }
        }
    }
}
