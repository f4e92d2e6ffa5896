//! The convex function of any mesh: enclosures against dense eigenvalues, proofs by patches and by factorisation.

// A helper that cannot go on fails its test.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "convex/blocks.rs"]
mod blocks;
#[path = "common/definite.rs"]
mod definite;
#[path = "common/double_double.rs"]
mod double_double;
#[path = "convex/exact.rs"]
mod exact;
#[path = "convex/far.rs"]
mod far;
#[path = "common/numbers.rs"]
mod numbers;
#[path = "convex/patches.rs"]
mod patches;
#[path = "common/reduced.rs"]
mod reduced;
#[path = "models/scenes.rs"]
mod scenes;

use bipenalty::convex::factor::Verdict;
use bipenalty::convex::{Asked, Curve, Enclosed, MeshPencil, Options, Patches, Prover, TooWide};
use bipenalty::pencil::{Gap, Matrix};
use bipenalty::sparse::{Csr, SparseVector};
use blocks::{Blocks, dense_largest};
use exact::Exact;
use numbers::Numbers;

/// Springs between random masses, singular where nothing is held; contrasts of 1e6; contacts that share unknowns.
fn random_pencil(random: &mut Numbers) -> MeshPencil {
    let n = 2 + random.below(29);
    let (mut k, mut m) = (Vec::new(), Vec::new());
    let (soft, light) = (random.log(1e-3, 1e3), random.log(1e-3, 1e3));
    for i in 1..n as u32 {
        let stiff = random.log(0.1, 10.0) * if (i as usize) < n / 2 { soft } else { 1.0 };
        let j = if random.next() < 0.8 { i - 1 } else { random.below(i as usize) as u32 };
        k.extend([(i, i, stiff), (j, j, stiff), (i, j, -stiff), (j, i, -stiff)]);
    }
    if random.next() < 0.5 {
        k.push((0, 0, 1.0));
    }
    let diagonal: Vec<f64> =
        (0..n).map(|i| random.log(0.3, 3.0) * if i < n / 2 { light } else { 1.0 }).collect();
    let consistent = random.next() < 0.4;
    for i in 0..n as u32 {
        m.push((i, i, diagonal[i as usize]));
        if i > 0 {
            let off = 0.45 * (diagonal[i as usize] * diagonal[i as usize - 1]).sqrt();
            m.extend([(i, i - 1, off), (i - 1, i, off)]);
        }
    }
    let count = 1 + random.below(n.min(50));
    let contacts = (0..count).map(|_| random_contact(random, n)).collect();
    let mass =
        if consistent { Matrix::Sparse(Csr::from_triplets(n, n, &m)) } else { Matrix::Diagonal(diagonal) };
    MeshPencil::new(Matrix::Sparse(Csr::from_triplets(n, n, &k)), mass, contacts).unwrap()
}

fn random_contact(random: &mut Numbers, n: usize) -> Gap {
    let mut entries = vec![(random.below(n) as u32, 1.0)];
    for _ in 0..random.below(3) {
        let at = random.below(n) as u32;
        if entries.iter().all(|(i, _)| *i != at) {
            entries.push((at, -random.next()));
        }
    }
    entries.sort_by_key(|(i, _)| *i);
    Gap { column: SparseVector(entries), scale: random.log(0.1, 10.0), initial: 0.0 }
}

/// What a point is enclosed by, to the width asked for or not.
fn enclosure(found: Result<Enclosed, TooWide>) -> Enclosed {
    found.unwrap_or_else(|wide| wide.enclosed)
}

/// The limits are those of double-double arithmetic.
#[test]
fn five_hundred_random_pencils_are_enclosed_as_narrowly_as_asked() {
    let mut random = Numbers(7);
    for case in 0..500 {
        let pencil = random_pencil(&mut random);
        let tolerance = if case % 2 == 0 { 1e-3 } else { 1e-6 };
        let mut curve = Curve::new(&pencil, Options { tolerance, ..Options::default() }).unwrap();
        let mesh = dense_largest(&pencil, 1.0, 0.0);
        let asked: Vec<Asked> = (0..6)
            .map(|i| {
                let stiffness = random.log(1e-6, 1e12);
                let ratio = if i == 0 { f64::INFINITY } else { random.log(1e-2, 1e3) };
                Asked::of(stiffness, ratio, mesh)
            })
            .collect();
        let exact = Exact::new(&pencil);
        for (asked, found) in asked.iter().zip(curve.enclose(&asked)) {
            let place = format!("case {case}, {asked:?}, {found:?}");
            let enclosed = found.unwrap_or_else(|wide| panic!("{place}: {wide}"));
            assert!(enclosed.step_width() <= tolerance, "{place}");
            let error = exact.error(enclosed.lower, curve.upper().slope(), *asked);
            assert!(error < 1e-3 * tolerance, "{place}: the oracle errs by {error:e}");
            assert!(!exact.above(enclosed.lower * (1.0 - error), *asked), "{place}");
            assert!(exact.above(enclosed.upper * (1.0 + error), *asked), "{place}");
        }
    }
}

/// f(t) is convex, nondecreasing, and its slope at most mu.
#[test]
fn lower_and_upper_bounds_are_convex_and_close_on_two_blocks() {
    let blocks = Blocks::new(12, 8, [1.0, 0.5]);
    let pencil = blocks.pencil();
    let mut curve = Curve::new(&pencil, Options { tolerance: 1e-5, ..Options::default() }).unwrap();
    let asked: Vec<Asked> = (-40_i32..=80)
        .map(|i| Asked {
            stiffness: f64::from(i).signum() * (f64::from(i.abs()) / 10.0).exp() / 50.0,
            mass: 0.0,
        })
        .collect();
    let found: Vec<Enclosed> = curve.enclose(&asked).into_iter().map(Result::unwrap).collect();
    for (asked, enclosed) in asked.iter().zip(&found) {
        assert!(enclosed.step_width() <= 1e-5, "{asked:?} {enclosed:?}");
        let dense = dense_largest(&pencil, 1.0, asked.stiffness);
        let error = 1e-11 * dense;
        assert!(
            enclosed.lower <= dense + error && dense <= enclosed.upper + error,
            "{asked:?} {enclosed:?} {dense}"
        );
    }
    for triple in found.windows(3).zip(asked.windows(3)) {
        let ((f, t), share) = (
            triple,
            (triple.1[1].stiffness - triple.1[0].stiffness) / (triple.1[2].stiffness - triple.1[0].stiffness),
        );
        assert!(
            t.len() == 3 && f[1].lower <= (f[0].upper + share * (f[2].upper - f[0].upper)) * (1.0 + 1e-12)
        );
        assert!(f[0].lower <= f[1].upper);
    }
    println!("{:?}", curve.effort());
}

#[test]
fn patches_lie_above_the_exact_value_and_close_in_on_it() {
    let blocks = Blocks::new(24, 12, [1.0, 0.5]);
    let pencil = blocks.pencil();
    let options = Options { tolerance: 1e-4, ..Options::default() };
    for t in [-3.0, 0.0, 1.0, 30.0] {
        let asked = [Asked { stiffness: t, mass: 0.0 }];
        let exact = Curve::new(&pencil, options).unwrap().enclose(&asked)[0].unwrap();
        let mut last = f64::INFINITY;
        for size in [1.0, 2.0, 4.0, 12.0] {
            let patches = blocks.patches(&pencil, size);
            let mut curve = Curve::with(&pencil, Prover::Patches(Box::new(patches)), options).unwrap();
            let bound = enclosure(curve.enclose(&asked)[0]);
            println!("t = {t}, patches of {size}: {:e} too high", bound.upper / exact.upper - 1.0);
            assert!(bound.upper >= exact.lower && bound.lower <= exact.upper, "{bound:?} {exact:?}");
            assert!(bound.upper <= last * 1.001);
            last = bound.upper;
        }
        assert!(last < 1.01 * exact.upper, "{t}: {last} {exact:?}");
    }
}

/// Patches that share out elements and contacts at random: none proves a value below the exact one, each proves one above.
#[test]
fn no_partition_proves_less_than_the_exact_value() {
    let mut random = Numbers(3);
    for case in 0..60 {
        let blocks = Blocks::new(2 + random.below(4), 1 + random.below(3), [1.0, random.log(0.1, 10.0)]);
        let pencil = blocks.pencil();
        let count = 1 + random.below(blocks.elements.elements.len());
        let patch: Vec<usize> = blocks.elements.elements.iter().map(|_| random.below(count)).collect();
        let patches = Patches::new(&pencil, &blocks.elements, &patch, 1 << 30).unwrap();
        for t in [-3.0, 0.0, 0.5, 20.0, 1e4] {
            let exact = dense_largest(&pencil, 1.0, t);
            let place = format!("case {case}, t = {t}, {count} patches, {:?}", patches.counts());
            // Below, and with all the rounding that is allowed for.
            let below = patches.prove(exact * (1.0 - 1e-6), 1.0, t, 1e-9);
            assert!(below != Verdict::Proven, "{place}");
            // Single elements with all of the contact at a corner stand no more than this.
            let above = patches.prove(20.0 * exact.max(1.0), 1.0, t, 1e-6);
            assert_eq!(above, Verdict::Proven, "{place}");
        }
    }
}

#[test]
fn one_patch_is_the_whole_mesh_and_identical_patches_count_once() {
    let blocks = Blocks::new(16, 8, [1.0, 1.0]);
    let pencil = blocks.pencil();
    let (total, distinct) = blocks.patches(&pencil, 4.0).counts();
    assert!(distinct < total, "{distinct} of {total}");
    assert_eq!(blocks.patches(&pencil, 1e9).counts(), (1, 1));
}

/// Bars in a row as matrices: the closed form of the chain, x = (omega/omega_e)^2, lumped, Signorini, far end free.
#[test]
fn a_bar_as_matrices_gives_the_closed_form() {
    let n = 40_u32;
    let (mut k, mut m) = (Vec::new(), vec![0.0; n as usize + 1]);
    for i in 0..n {
        k.extend([(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)]);
        m[i as usize] += 0.5;
        m[i as usize + 1] += 0.5;
    }
    let size = n as usize + 1;
    let gap = SparseVector(vec![(n, 1.0)]);
    let pencil = MeshPencil::new(
        Matrix::Sparse(Csr::from_triplets(size, size, &k)),
        Matrix::Diagonal(m),
        vec![Gap { column: gap, scale: 1.0, initial: 0.0 }],
    )
    .unwrap();
    let mut curve = Curve::new(&pencil, Options { tolerance: 1e-9, ..Options::default() }).unwrap();
    for x in [1.01_f64, 1.1, 2.0, 30.0, 1e4] {
        for r in [2.0_f64, 50.0, f64::INFINITY] {
            let theta = (2.0 * x - 1.0).acosh();
            let beta_s = (4.0 * x * (x - 1.0)).sqrt() * (f64::from(n) * theta).tanh() / (1.0 - x / r);
            if beta_s <= 0.0 || x == r {
                continue;
            }
            let enclosed =
                curve.enclose(&[Asked { stiffness: beta_s, mass: beta_s / (4.0 * r) }])[0].unwrap();
            assert!(enclosed.step_width() <= 1e-9, "x = {x}, r = {r}: {enclosed:?}");
            let error = 1e-14 * 4.0 * x / (1.0 - x / r);
            assert!(
                enclosed.lower <= 4.0 * x + error && 4.0 * x - error <= enclosed.upper,
                "x = {x}, r = {r}: {enclosed:?}"
            );
        }
    }
}

#[test]
fn refused_are_matrices_that_are_none() {
    let k = Matrix::Sparse(Csr::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)]));
    let skew = Matrix::Sparse(Csr::from_triplets(2, 2, &[(0, 1, 1.0), (1, 0, -1.0)]));
    let unit = || Matrix::Diagonal(vec![1.0; 2]);
    let gap = |entries: &[(u32, f64)], scale| {
        vec![Gap { column: SparseVector(entries.to_vec()), scale, initial: 0.0 }]
    };
    assert!(MeshPencil::new(k.clone(), unit(), Vec::new()).is_ok());
    assert!(MeshPencil::new(skew, unit(), Vec::new()).is_err());
    assert!(MeshPencil::new(k.clone(), Matrix::Diagonal(vec![1.0, 0.0]), Vec::new()).is_err());
    assert!(MeshPencil::new(k.clone(), Matrix::Diagonal(vec![1.0; 3]), Vec::new()).is_err());
    assert!(MeshPencil::new(k.clone(), unit(), gap(&[], 1.0)).is_err());
    assert!(MeshPencil::new(k.clone(), unit(), gap(&[(2, 1.0)], 1.0)).is_err());
    assert!(MeshPencil::new(k.clone(), unit(), gap(&[(0, 1.0)], 0.0)).is_err());
    let indefinite = Csr::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0), (1, 0, 2.0)]);
    let pencil = MeshPencil::new(k, Matrix::Sparse(indefinite), gap(&[(0, 1.0)], 1.0)).unwrap();
    assert!(Curve::new(&pencil, Options::default()).is_err());
}

/// The map of issue size: 100 x 100 points of two blocks, to 1e-3.
fn map(width: usize, height: usize, patches: Option<f64>) -> (Vec<Enclosed>, f64) {
    let start = std::time::Instant::now();
    let blocks = Blocks::new(width, height, [1.0, 0.5]);
    let pencil = blocks.pencil();
    println!("{} unknowns, assembled {:?}", pencil.size(), start.elapsed());
    let options = Options { tolerance: if patches.is_some() { 1e-2 } else { 1e-3 }, ..Options::default() };
    let mut curve = match patches {
        Some(size) => {
            let patches = blocks.patches(&pencil, size);
            println!("patches {:?}, largest {}", patches.counts(), patches.largest());
            Curve::with(&pencil, Prover::Patches(Box::new(patches)), options).unwrap()
        }
        None => Curve::new(&pencil, options).unwrap(),
    };
    println!("begun {:?} {:?}", start.elapsed(), curve.effort());
    let mesh = curve.mesh();
    let log = |i: usize, low: f64, high: f64| low * (high / low).powf(i as f64 / 99.0);
    let asked: Vec<Asked> = (0..100)
        .flat_map(|i| {
            (0..100).map(move |j| (log(i, 1e-3, 1e9), if j == 99 { f64::INFINITY } else { log(j, 0.1, 1e3) }))
        })
        .map(|(stiffness, ratio)| Asked::of(stiffness, ratio, mesh))
        .collect();
    let found: Vec<Enclosed> = curve.enclose(&asked).into_iter().map(enclosure).collect();
    let widest = found.iter().map(Enclosed::step_width).fold(0.0, f64::max);
    println!(
        "map {:?}: widest {widest:e}, {:?}, {} vectors",
        start.elapsed(),
        curve.effort(),
        curve.dimension()
    );
    (found, widest)
}

#[test]
fn a_map_of_ten_thousand_points_is_enclosed_to_a_thousandth() {
    let (found, widest) = map(30, 20, None);
    assert_eq!(found.len(), 10_000);
    assert!(widest <= 1e-3, "{widest:e}");
}

#[test]
#[ignore = "takes a minute"]
fn a_map_of_a_hundred_and_sixty_thousand_unknowns() {
    assert!(map(283, 140, None).1 <= 1e-3);
}

#[test]
#[ignore = "takes a minute"]
fn a_map_of_a_hundred_and_sixty_thousand_unknowns_by_patches() {
    assert!(map(283, 140, Some(20.0)).1 <= 1e-2);
}
