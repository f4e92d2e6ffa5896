//! Unknowns at rest with contacts, and the mass that they hand over.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::{Gap, Matrix, Penalty, Pencil};
use bipenalty::schemes::{ContactRule, Equilibrium, MassRedistribution, Scheme, System};
use bipenalty::sparse::{Csr, SparseVector};
use bipenalty::stability::{AnyModel, AnyScene};
use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::numbers::Numbers;
use crate::scenes::random_mesh;

/// The minimum of u'Ku/2 - f'u over u_c under g <= 0, by trying every set of closed contacts: lambda and u.
fn by_enumeration(
    (k, gaps): (&Mat<f64>, &[Gap]),
    unknowns: &[usize],
    load: &[f64],
    u: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let (c, j) = (unknowns.len(), gaps.len());
    let entry =
        |gap: &Gap, i: usize| gap.column.0.iter().find(|(at, _)| *at as usize == i).map_or(0.0, |e| e.1);
    for set in 0..1_usize << j {
        let closed: Vec<usize> = (0..j).filter(|at| set >> at & 1 == 1).collect();
        let n = c + closed.len();
        // [K Z; Z' 0] [u_c; lambda] = [f - K_ci u_i; -g0 - Z_i'u_i]
        let at = |i: usize| unknowns[i];
        let matrix = Mat::from_fn(n, n, |row, column| match (row < c, column < c) {
            (true, true) => k[(at(row), at(column))],
            (true, false) => entry(&gaps[closed[column - c]], at(row)),
            (false, true) => entry(&gaps[closed[row - c]], at(column)),
            (false, false) => 0.0,
        });
        let others: Vec<f64> = (0..u.len()).map(|i| if unknowns.contains(&i) { 0.0 } else { u[i] }).collect();
        let right = Mat::from_fn(n, 1, |row, _| {
            if row < c {
                load[at(row)] - (0..u.len()).map(|i| k[(at(row), i)] * others[i]).sum::<f64>()
            } else {
                let gap = &gaps[closed[row - c]];
                -gap.initial - gap.column.dot(&others)
            }
        });
        let x = matrix.full_piv_lu().solve(&right);
        let mut found = others;
        (0..c).for_each(|i| found[at(i)] = x[(i, 0)]);
        let lambda: Vec<f64> = (0..closed.len()).map(|i| x[(c + i, 0)]).collect();
        let open = (0..j).filter(|i| !closed.contains(i));
        let apart = |i: usize| gaps[i].column.dot(&found) + gaps[i].initial <= 1e-12;
        if lambda.iter().all(|l| *l >= 0.0) && open.into_iter().all(apart) {
            let mut force = vec![0.0; j];
            closed.iter().zip(lambda).for_each(|(at, l)| force[*at] = l);
            return (force, found);
        }
    }
    panic!("no set of contacts balances")
}

/// 300 springs of any kind, 1 to 5 contacts that share unknowns, some unknowns prescribed.
#[test]
fn rest_is_the_minimum_that_enumeration_finds() {
    let mut random = Numbers(11);
    let mut pressed = [0; 6];
    for _ in 0..300 {
        let (n, j) = (6 + random.below(5), 1 + random.below(5));
        let a = Mat::from_fn(n, n, |_, _| random.between(-1.0, 1.0));
        let k = Mat::from_fn(n, n, |i, l| {
            (0..n).map(|m| a[(m, i)] * a[(m, l)]).sum::<f64>() + if i == l { 0.3 } else { 0.0 }
        });
        let triplets: Vec<(u32, u32, f64)> =
            (0..n * n).map(|at| ((at / n) as u32, (at % n) as u32, k[(at / n, at % n)])).collect();
        let stiffness = Matrix::Sparse(Csr::from_triplets(n, n, &triplets));
        let unknowns: Vec<usize> = (0..n).filter(|i| *i < j || random.next() < 0.7).collect();
        let gaps: Vec<Gap> = (0..j)
            .map(|at| {
                let others = (0..n as u32).filter(|i| *i as usize != at);
                let mut column = vec![(at as u32, 1.0)];
                column.extend(others.filter(|_| random.next() < 0.2).map(|i| (i, 0.0)));
                column.iter_mut().skip(1).for_each(|entry| entry.1 = random.between(-0.4, 0.4));
                column.sort_by_key(|entry| entry.0);
                Gap { column: SparseVector(column), scale: 1.0, initial: random.between(-0.5, 0.3) }
            })
            .collect();
        let load: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
        let mut u: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
        let (want, place) = by_enumeration((&k, &gaps), &unknowns, &load, &u);
        let (mut force, mut gap) = (vec![0.0; j], vec![0.0; j]);
        let mut rest = Equilibrium::new(&stiffness, &gaps, &unknowns).unwrap();
        rest.settle(&load, ContactRule::Unilateral, &mut u, &mut force, &mut gap);
        // Condition numbers stay below some 1e3.
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-10);
        assert!(near(&force, &want) && near(&u, &place), "{force:?} {want:?}");
        for (of, g) in gaps.iter().zip(&gap) {
            assert!((of.column.dot(&u) + of.initial - g).abs() <= 1e-10 && *g <= 1e-10);
        }
        pressed[want.iter().filter(|l| **l > 0.0).count()] += 1;
    }
    assert!(pressed[..4].iter().all(|count| *count > 10), "{pressed:?}");
}

#[test]
fn what_has_no_rest_is_refused() {
    let spring =
        |k: f64| Matrix::Sparse(Csr::from_triplets(2, 2, &[(0, 0, k), (0, 1, -k), (1, 0, -k), (1, 1, k)]));
    let gap = |i: u32| Gap { column: SparseVector(vec![(i, 1.0)]), scale: 1.0, initial: 0.0 };
    let place =
        |gaps: &[Gap], unknowns: &[usize]| Equilibrium::new(&spring(1.0), gaps, unknowns).unwrap_err().place;
    assert_eq!(place(&[gap(1)], &[0]), "contact 1");
    assert_eq!(place(&[], &[0, 1]), "unknowns at rest");
    assert_eq!(place(&[gap(0), gap(0)], &[0]), "contacts");
}

fn stepping(seed: u64, mass: MassMatrix) -> Pencil {
    let scene = AnyScene::parse(&random_mesh(seed), "m.toml").unwrap();
    let AnyModel::Mesh(mesh) = AnyModel::new(&scene, Some(mass), PenaltyMass::Consistent).unwrap() else {
        panic!()
    };
    mesh.stepping_pencil().unwrap()
}

fn system(pencil: &Pencil, rule: ContactRule) -> System<'_> {
    let critical_step = 2.0 / pencil.reference().sqrt();
    let time_step = 0.99 * critical_step;
    System {
        pencil,
        penalty: Penalty::NONE,
        load: Vec::new(),
        time_step,
        critical_step,
        rule,
        account: false,
    }
}

/// A rigid translation in each direction has the kinetic energy of the whole mass after the contacts gave theirs away.
#[test]
fn redistribution_keeps_the_mass_in_each_direction() {
    let (mut kept, mut refused) = (0, 0);
    for (seed, mass) in
        (0..40).flat_map(|seed| [MassMatrix::LUMPED, MassMatrix::CONSISTENT].map(|m| (seed, m)))
    {
        let pencil = stepping(seed, mass);
        let n = pencil.size();
        for direction in 0..2 {
            let v: Vec<f64> =
                pencil.directions().iter().map(|d| f64::from(u8::from(*d == direction))).collect();
            let system = system(&pencil, ContactRule::HeldOpen);
            let mut motion = match MassRedistribution.start(system, vec![0.0; n], v.clone()) {
                Ok(motion) => motion,
                // Held below and touched above, a body of one layer has no node inside; corners of elements of second
                // order have no mass of their own.
                Err(refusal) => {
                    let why = refusal.to_string();
                    assert!(
                        why.contains("no mass inside") || why.contains("elements of first order"),
                        "{why}"
                    );
                    refused += 1;
                    continue;
                }
            };
            let want = 0.5 * pencil.mass().quadratic(&v, &v);
            // v is half a step behind, by a kick of 0 without strain; the sums of n masses round.
            let found = motion.energy().kinetic;
            assert!((found / want - 1.0).abs() <= 1e-13 * n as f64, "{seed} {direction}: {found} {want}");
            kept += 1;
        }
    }
    assert!(kept > 90, "{kept} kept, {refused} refused");
}

/// At 0.99 of the contact-free step, contacts held open or closed: what is bounded by the energy at the start stays so.
#[test]
fn redistribution_is_stable_up_to_the_contact_free_step() {
    let mut random = Numbers(5);
    let mut tried = 0;
    for (seed, mass) in
        (0..20).flat_map(|seed| [MassMatrix::LUMPED, MassMatrix::CONSISTENT].map(|m| (seed, m)))
    {
        let pencil = stepping(seed, mass);
        for rule in [ContactRule::HeldOpen, ContactRule::HeldClosed] {
            let v = (0..pencil.size()).map(|_| random.between(-1.0, 1.0)).collect();
            let Ok(mut motion) = MassRedistribution.start(system(&pencil, rule), vec![0.0; pencil.size()], v)
            else {
                continue;
            };
            let first = motion.energy().kinetic + motion.energy().strain;
            (0..20_000).for_each(|_| motion.step());
            let energy = motion.energy();
            // At C = 0.99 an elliptic orbit swells by 1/(1 - C^2) = 50; growth by 1e-3 a step would be 1e17.
            assert!(energy.kinetic + energy.strain <= 100.0 * first, "{seed} {rule:?}: {energy:?} {first}");
            tried += 1;
        }
    }
    assert!(tried > 45, "{tried}");
}
