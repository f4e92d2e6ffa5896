//! A mesh in parts against the same mesh whole: the driver asks, threads that hold one part each answer.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "common/reduced.rs"]
mod reduced;

use std::sync::{Barrier, Mutex};

use bipenalty::convex::factor::Verdict;
use bipenalty::convex::session::{Answer, Facts, Finished, Question, Session};
use bipenalty::convex::source::Found;
use bipenalty::convex::span::{Row, Sizes};
use bipenalty::convex::{Asked, Curve, MeshPencil, Options};
use bipenalty::fem::MassMatrix;
use bipenalty::mesh::MeshScene;
use bipenalty::parts::{Part, Share, split};
use bipenalty::pencil::Matrix;
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, Par, Side};
use reduced::reduced;

/// Two blocks of unlike meshes; `cells` of the upper one decide whether nodes meet nodes.
fn scene(cells: &str) -> MeshScene {
    let text = format!(
        r#"
        name = "two-blocks"
        dimension = 2
        plane = "strain"
        [[body]]
        name = "lower"
        box = [3.0, 1.0]
        cells = [12, 4]
        element = "quad4"
        youngs_modulus = 210.0
        poissons_ratio = 0.3
        density = 7.85
        [[body]]
        name = "upper"
        box = [3.0, 1.0]
        cells = {cells}
        origin = [0.0, 1.0]
        element = "quad4"
        youngs_modulus = 70.0
        poissons_ratio = 0.3
        density = 2.7
        [[contact]]
        surfaces = ["upper.bottom", "lower.top"]
        [[hold]]
        surface = "lower.bottom"
        directions = ["x", "y"]
        "#
    );
    MeshScene::parse(&text, "two-blocks.toml").unwrap()
}

/// What the threads of a run share: a sum over all of them that gives each the same bits.
struct Sum(Mutex<Vec<f64>>, Barrier, usize);

impl Sum {
    fn over_all(&self, values: &mut [f64]) {
        {
            let mut sum = self.0.lock().unwrap();
            if sum.is_empty() {
                sum.resize(values.len(), 0.0);
            }
            sum.iter_mut().zip(values.iter()).for_each(|(sum, v)| *sum += v);
        }
        self.1.wait();
        values.copy_from_slice(&self.0.lock().unwrap());
        if self.1.wait().is_leader() {
            self.0.lock().unwrap().clear();
        }
        self.1.wait();
    }
}

/// The top vector of (a K + t P, M), among those with closed gaps if asked for, by dense reduction; and its residual, 0.
fn top(pencil: &MeshPencil, (a, t): (f64, f64), closed: bool) -> (f64, Vec<f64>) {
    // So stiff that what is left of the gaps is nothing.
    let t = if closed { -1e6 } else { t };
    let (n, (symmetric, factor)) = (pencil.size(), reduced(pencil, a, t));
    let found = symmetric.self_adjoint_eigen(Side::Lower).unwrap();
    let mut vector = Mat::from_fn(n, 1, |i, _| found.U()[(i, n - 1)]);
    solve_upper_triangular_in_place(factor.L().transpose(), vector.as_mut(), Par::Seq);
    (found.S()[n - 1], (0..n).map(|i| vector[(i, 0)]).collect())
}

/// The verdict on all parts.
fn together(verdicts: &[Verdict]) -> Verdict {
    verdicts.iter().fold(Verdict::Proven, |all, next| match (all, *next) {
        (Verdict::Refuted, _) | (_, Verdict::Refuted) => Verdict::Refuted,
        (Verdict::TooClose(a), Verdict::TooClose(b)) => Verdict::TooClose(a.max(b)),
        (Verdict::Proven, other) | (other, Verdict::Proven) => other,
    })
}

/// Adds a vector of the whole mesh to all parts; the forms of all together.
fn add(parts: &mut [Part], x: &[f64]) -> Option<Row> {
    let sum = Sum(Mutex::default(), Barrier::new(parts.len()), parts.len());
    let run = |part: &mut Part| {
        let local: Vec<f64> = part.unknowns().iter().map(|u| x[*u as usize]).collect();
        part.add(&local, x.len(), &mut |values| sum.over_all(values))
    };
    let rows: Vec<Option<Row>> = std::thread::scope(|scope| {
        let threads: Vec<_> = parts.iter_mut().map(|part| scope.spawn(|| run(part))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert!(rows.iter().all(|row| row.is_some() == rows[0].is_some()) && sum.2 == parts.len());
    let mut all = rows[0].clone()?;
    for row in rows.into_iter().skip(1).flatten() {
        assert_eq!((&row.stiffness, &row.mass), (&all.stiffness, &all.mass), "the sums differ between parts");
        all.gaps.extend(row.gaps);
        all.gap_sizes.extend(row.gap_sizes);
    }
    Some(all)
}

/// The map of points from parts, with dense eigenvectors of the whole pencil.
fn enclose(whole: &MeshPencil, parts: &mut [Part], points: &[(f64, f64)], tolerance: f64) -> Finished {
    let scales = parts.iter().flat_map(|part| part.pencil().contacts().iter().map(|c| c.scale)).collect();
    let sizes = parts.iter().map(Part::sizes).reduce(Sizes::and).unwrap();
    let facts = Facts { unknowns: whole.size(), scales, sizes, sharp: false };
    let options = Options { tolerance, ..Options::default() };
    let mut session = Session::new(facts, points.to_vec(), None, options).unwrap();
    while let Some(question) = session.question().cloned() {
        let answer = match question {
            Question::Seek { combination, closed, .. } => {
                let (value, vector) = top(whole, combination, closed);
                Answer::Found { found: Found { value, residual: 0.0 }, row: add(parts, &vector) }
            }
            // Never good enough: every vector is looked for.
            Question::Residual { .. } => Answer::Residual(1.0),
            Question::Prove { u, combination, margin } => {
                let verdicts: Vec<Verdict> =
                    parts.iter().map(|part| part.prove(u, combination, margin)).collect();
                Answer::Verdict(together(&verdicts))
            }
        };
        session.tell(answer).unwrap();
    }
    session.finish().unwrap()
}

fn whole(scene: &MeshScene, mass: MassMatrix) -> MeshPencil {
    let assembled = scene.assemble(mass).unwrap();
    let gaps = assembled.gaps();
    MeshPencil::new(Matrix::Sparse(assembled.stiffness), assembled.mass, gaps).unwrap()
}

fn parts(scene: &MeshScene, mass: MassMatrix, count: usize, edge: usize) -> Vec<Part> {
    let ready = |share: Share| Part::new(share, 1 << 30).unwrap();
    split(scene, mass, count, edge).unwrap().0.into_iter().map(ready).collect()
}

const RATIOS: [f64; 4] = [0.3, 1.0, 4.0, f64::INFINITY];
const PENALTIES: [f64; 5] = [0.0, 0.3, 3.0, 1e2, 1e6];

fn points() -> Vec<(f64, f64)> {
    RATIOS.iter().flat_map(|r| PENALTIES.iter().map(move |b| (*b, *r))).collect()
}

#[test]
fn the_parts_add_up_to_the_whole() {
    for (cells, mass) in [("[12, 4]", MassMatrix::LUMPED), ("[10, 3]", MassMatrix::CONSISTENT)] {
        let scene = scene(cells);
        let whole = whole(&scene, mass);
        let n = whole.size();
        let x: Vec<f64> = (0..n).map(|i| ((i * i + 3 * i) % 17) as f64 - 8.0).collect();
        for count in [1, 2, 3] {
            let parts = parts(&scene, mass, count, 2);
            assert_eq!(parts.len(), count);
            for (a, t) in [(1.0, 0.0), (0.0, 1.0), (1.0, -7.0)] {
                let (mut expected, mut sum) = (vec![0.0; n], vec![0.0; n]);
                whole.multiply(a, t, &x, &mut expected);
                for part in &parts {
                    let local: Vec<f64> = part.unknowns().iter().map(|u| x[*u as usize]).collect();
                    let mut y = vec![0.0; local.len()];
                    part.pencil().multiply(a, t, &local, &mut y);
                    part.unknowns().iter().zip(y).for_each(|(u, y)| sum[*u as usize] += y);
                }
                let size = expected.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                let off = sum.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off <= 1e-13 * size, "{count} parts: {off:e} of {size:e}");
            }
        }
    }
}

#[test]
fn one_part_or_several_enclose_the_same_map() {
    for (cells, mass) in [("[12, 4]", MassMatrix::LUMPED), ("[10, 3]", MassMatrix::CONSISTENT)] {
        let scene = scene(cells);
        let whole = whole(&scene, mass);
        let tolerance = 0.03;
        let maps: Vec<Finished> = [1, 2, 3]
            .map(|count| enclose(&whole, &mut parts(&scene, mass, count, 4), &points(), tolerance))
            .into();
        let exact = Curve::new(&whole, Options { tolerance: 1e-7, ..Options::default() });
        let mut exact = exact.unwrap();
        for map in &maps {
            assert!((map.mesh / exact.mesh() - 1.0).abs() < 1e-9, "{:e} {:e}", map.mesh, exact.mesh());
            let asked: Vec<Asked> = points().iter().map(|(b, r)| Asked::of(*b, *r, map.mesh)).collect();
            for ((found, exact), asked) in map.points.iter().zip(exact.enclose(&asked)).zip(&asked) {
                let exact = exact.unwrap_or_else(|wide| wide.enclosed);
                assert!(
                    found.lower <= exact.upper && exact.lower <= found.upper,
                    "{asked:?} {found:?} {exact:?}"
                );
                // Where nodes meet nodes; elsewhere patches of four elements are higher.
                let wide = if cells == "[12, 4]" { tolerance } else { 0.3 };
                assert!(found.step_width() <= wide, "{asked:?}: {found:?}, {exact:?}");
            }
        }
        // The same vectors and the same patches: the same lower bounds, but for the order of sums, and upper ones as close
        // as the height of patches is looked for, whose trials such a difference may move.
        for (map, (found, first)) in
            maps.iter().flat_map(|map| map.points.iter().zip(&maps[0].points)).enumerate()
        {
            assert!((found.lower / first.lower - 1.0).abs() < 1e-6, "{map}: {found:?} {first:?}");
            let height = 0.06 * (first.upper / first.lower - 1.0);
            assert!((found.upper / first.upper - 1.0).abs() < height.max(1e-6), "{map}: {found:?} {first:?}");
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let scene = scene("[12, 4]");
    assert!(split(&scene, MassMatrix::LUMPED, 1000, 3).unwrap_err().to_string().contains("parts"));
    let share = split(&scene, MassMatrix::LUMPED, 2, 3).unwrap().0.swap_remove(0);
    let spoilt: [fn(&mut Share); 6] = [
        |s| s.unknowns.swap(0, 1),
        |s| s.patch.truncate(1),
        |s| s.elements.elements[0].1[0] = Some(u32::MAX - 1),
        |s| s.elements.shapes[0].stiffness[1] += 1.0,
        |s| s.elements.shapes[0].mass[0] = f64::NAN,
        |s| s.carrier.as_mut().unwrap()[0] = 1000,
    ];
    for spoil in spoilt {
        let mut share = share.clone();
        spoil(&mut share);
        assert!(Part::new(share, 1 << 30).is_err());
    }
    // Patches whose contacts were not shared out yet do it themselves.
    let alone = Share { carrier: None, ..split(&scene, MassMatrix::LUMPED, 1, 3).unwrap().0.swap_remove(0) };
    assert!(Part::new(alone, 1 << 30).unwrap().patches().0 > 1);
}

#[test]
fn a_session_takes_only_answers_to_its_question() {
    let scene = scene("[12, 4]");
    let whole = whole(&scene, MassMatrix::LUMPED);
    let parts = parts(&scene, MassMatrix::LUMPED, 1, 4);
    let scales = parts[0].pencil().contacts().iter().map(|c| c.scale).collect();
    let facts = Facts { unknowns: whole.size(), scales, sizes: parts[0].sizes(), sharp: false };
    let mut session = Session::new(facts, points(), None, Options::default()).unwrap();
    assert!(session.tell(Answer::Residual(0.0)).is_err(), "nothing was asked yet");
    assert!(matches!(session.question(), Some(Question::Seek { .. })));
    assert!(session.tell(Answer::Verdict(Verdict::Proven)).is_err());
    let short = Row { stiffness: vec![1.0], mass: vec![1.0], gaps: vec![], gap_sizes: vec![], square: 1.0 };
    let found = Found { value: 1.0, residual: 0.0 };
    assert!(session.tell(Answer::Found { found, row: Some(short) }).is_err());
    assert!(session.finish().unwrap_err().to_string().contains("an answer to every question"));
}
