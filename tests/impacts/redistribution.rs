//! Mass redistribution on meshes beside dense matrices that are made of the elements alone, and what it promises.

use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Encounter, Passage};
use bipenalty::mesh::{Elements, HELD};
use bipenalty::penalty::PenaltyMass;
use bipenalty::pencil::Pencil;
use bipenalty::schemes::{ContactRule, Motion, SchemeName};
use bipenalty::stability::{AnyModel, AnyScene};

use super::random::{self, Random};

const SCHEME: SchemeName = SchemeName::MassRedistribution;

fn motion(encounter: &Encounter, rule: ContactRule, c: f64) -> (Box<dyn Motion>, f64) {
    let penalty = encounter.penalty(1.0, 1.0);
    let passage = Passage::new(encounter.clone(), SCHEME, penalty, c, 1.0).unwrap().with_rule(rule);
    (passage.prepare(false).unwrap(), passage.time_step())
}

/// Gaussian elimination with exchange of rows.
fn solved(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for column in 0..n {
        let pivot = (column..n).max_by(|i, j| a[*i][column].abs().total_cmp(&a[*j][column].abs())).unwrap();
        a.swap(column, pivot);
        b.swap(column, pivot);
        for row in column + 1..n {
            let share = a[row][column] / a[column][column];
            let above = a[column].clone();
            a[row].iter_mut().zip(above).skip(column).for_each(|(x, above)| *x -= share * above);
            b[row] -= share * b[column];
        }
    }
    for row in (0..n).rev() {
        let rest: f64 = (row + 1..n).map(|j| a[row][j] * b[j]).sum();
        b[row] = (b[row] - rest) / a[row][row];
    }
    b
}

/// Dense matrices of a scene of quad4, lumped, with the mass of nodes in contact moved: each element has a quarter of its mass at a
/// node, which its nodes out of contact share evenly.
struct Dense {
    k: Vec<Vec<f64>>,
    mass: Vec<f64>,
    gaps: Vec<(Vec<f64>, f64)>,
    massless: Vec<usize>,
    load: Vec<f64>,
}

impl Dense {
    fn new(encounter: &Encounter, elements: &Elements) -> Self {
        let n = encounter.pencil().size();
        let (mut k, mut mass) = (vec![vec![0.0; n]; n], vec![0.0; n]);
        let gap = |gap: &bipenalty::pencil::Gap| {
            let mut z = vec![0.0; n];
            gap.column.0.iter().for_each(|(i, entry)| z[*i as usize] = *entry);
            (z, gap.initial)
        };
        let gaps: Vec<_> = encounter.pencil().gaps().iter().map(gap).collect();
        let in_contact = |dofs: &[u32]| {
            dofs.iter().any(|dof| *dof != HELD && gaps.iter().any(|(z, _)| z[*dof as usize] != 0.0))
        };
        let mut massless = Vec::new();
        for e in 0..elements.len() {
            let (dofs, (stiffness, nodal)) = (elements.dofs(e), elements.matrices(e).unwrap());
            for (a, row) in dofs.iter().enumerate().filter(|(_, dof)| **dof != HELD) {
                for (b, column) in dofs.iter().enumerate().filter(|(_, dof)| **dof != HELD) {
                    k[*row as usize][*column as usize] += stiffness[a * dofs.len() + b];
                }
            }
            let whole: f64 = nodal.iter().sum();
            for i in 0..2 {
                let node = |a: usize| &dofs[2 * a..2 * a + 2];
                let free = (0..4).filter(|a| node(*a)[i] != HELD);
                let (touched, other): (Vec<usize>, Vec<usize>) = free.partition(|a| in_contact(node(*a)));
                let moved = 0.25 * whole * (touched.len() as f64 / other.len() as f64 + 1.0);
                other.iter().for_each(|a| mass[node(*a)[i] as usize] += moved);
                massless.extend(touched.iter().map(|a| node(*a)[i] as usize));
            }
        }
        massless.sort_unstable();
        massless.dedup();
        let load = if encounter.load().is_empty() { vec![0.0; n] } else { encounter.load().to_vec() };
        Self { k, mass, gaps, massless, load }
    }

    fn force(&self, u: &[f64], i: usize) -> f64 {
        self.load[i] - self.k[i].iter().zip(u).map(|(k, u)| k * u).sum::<f64>()
    }

    /// Finds u of the massless unknowns and lambda by trying every set of closed contacts.
    fn place(&self, u: &mut [f64]) -> Vec<f64> {
        let (c, contacts) = (self.massless.len(), self.gaps.len());
        self.massless.iter().for_each(|i| u[*i] = 0.0);
        for set in 0..1_u32 << contacts {
            let closed: Vec<usize> = (0..contacts).filter(|j| set >> j & 1 == 1).collect();
            let size = c + closed.len();
            let (mut a, mut b) = (vec![vec![0.0; size]; size], vec![0.0; size]);
            for (row, i) in self.massless.iter().enumerate() {
                self.massless.iter().enumerate().for_each(|(column, j)| a[row][column] = self.k[*i][*j]);
                for (at, j) in closed.iter().enumerate() {
                    a[row][c + at] = self.gaps[*j].0[*i];
                    a[c + at][row] = self.gaps[*j].0[*i];
                }
                b[row] = self.force(u, *i);
            }
            closed.iter().enumerate().for_each(|(at, j)| b[c + at] = -self.gaps[*j].1);
            let x = solved(a, b);
            let mut found = u.to_vec();
            self.massless.iter().zip(&x).for_each(|(i, x)| found[*i] = *x);
            let gap = |j: usize| {
                self.gaps[j].0.iter().zip(&found).map(|(z, u)| z * u).sum::<f64>() + self.gaps[j].1
            };
            let open = (0..contacts).filter(|j| !closed.contains(j)).all(|j| gap(j) <= 1e-12);
            if open && x[c..].iter().all(|lambda| *lambda >= 0.0) {
                let mut lambda = vec![0.0; contacts];
                closed.iter().zip(&x[c..]).for_each(|(j, x)| lambda[*j] = *x);
                u.copy_from_slice(&found);
                return lambda;
            }
        }
        panic!("no set of closed contacts");
    }
}

/// Two blocks, nodes matching or not, and a wall below: 200 steps of the scheme are those of dense matrices, elimination with
/// exchange of rows and the trial of every set of closed contacts.
#[test]
fn steps_are_those_of_dense_matrices_and_every_set_of_contacts() {
    let body = |name: &str, cells: [usize; 2], origin: f64, velocity: [f64; 2]| {
        format!(
            "[[body]]\nname = \"{name}\"\nbox = [1.0, 0.6]\ncells = {cells:?}\norigin = [0.0, {origin:?}]\nelement = \"quad4\"\n\
             youngs_modulus = 3.0\npoissons_ratio = 0.3\ndensity = 1.2\nvelocity = {velocity:?}\n"
        )
    };
    let mut pressed = 0;
    for (upper, wall) in [([1, 2], true), ([2, 2], false), ([3, 3], false)] {
        let mut text = String::from("name = \"blocks\"\ndimension = 2\nplane = \"stress\"\n");
        text += &body("lower", [2, 3], 0.0, [0.0, 0.05]);
        text += &body("upper", upper, 0.6, [0.03, -0.2]);
        text += "[[contact]]\nsurfaces = [\"upper.bottom\", \"lower.top\"]\n";
        text += match wall {
            true => "[[contact]]\nsurfaces = [\"lower.bottom\", \"wall\"]\n",
            false => "[[hold]]\nsurface = \"lower.bottom\"\ndirections = [\"y\"]\n",
        };
        text += "[[hold]]\nsurface = \"upper.left\"\ndirections = [\"x\"]\n[impact]\nduration = 1.0\ngravity = [0.0, -0.1]\n";
        let scene = AnyScene::parse(&text, "blocks.toml").unwrap();
        let model = AnyModel::new(&scene, Some(MassMatrix::LUMPED), PenaltyMass::Consistent).unwrap();
        let AnyModel::Mesh(mesh) = &model else { panic!() };
        let encounter = Encounter::of_scene(&scene, &model).unwrap();
        let gaps: Vec<f64> = (0..encounter.pencil().gaps().len()).map(|j| -0.01 * (j % 3) as f64).collect();
        let encounter = encounter.with_gaps(&gaps).unwrap();
        let dense = Dense::new(&encounter, mesh.mesh().unwrap());
        let (mut motion, dt) = motion(&encounter, ContactRule::Unilateral, 0.9);
        let n = encounter.pencil().size();
        let (mut u, mut v) = (vec![0.0; n], encounter.velocity().to_vec());
        let mut lambda = dense.place(&mut u);
        let inner: Vec<usize> = (0..n).filter(|i| !dense.massless.contains(i)).collect();
        for step in 0..=200 {
            let state = motion.state();
            let largest = lambda.iter().copied().fold(1e-3, f64::max);
            for (a, b) in state.force.iter().zip(&lambda) {
                assert!((a - b).abs() < 1e-9 * largest, "step {step}: {:?} {lambda:?}", state.force);
            }
            let off = state.displacement.iter().zip(&u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10, "step {step}: {off:e}");
            pressed += lambda.iter().filter(|lambda| **lambda > 0.0).count();
            let half = if step == 0 { 0.5 } else { 1.0 };
            let kick: Vec<f64> =
                inner.iter().map(|i| half * dt * dense.force(&u, *i) / dense.mass[*i]).collect();
            inner.iter().zip(kick).for_each(|(i, kick)| v[*i] += kick);
            inner.iter().for_each(|i| u[*i] += dt * v[*i]);
            lambda = dense.place(&mut u);
            motion.step();
        }
    }
    assert!(pressed > 300, "{pressed}");
}

/// The kinetic energy of a translation at 1 m/s is half the mass of the bodies, of which the massless unknowns have none. Held
/// open or closed the scheme are central differences of M' >= M and of a stiffness that is no larger: at C = dt/dt_cr < 1 the
/// inner nodes keep v'Mv/2 <= H/(1 - C^2) for good, H the leapfrog energy of the start.
#[test]
fn random_meshes_keep_their_mass_and_their_energy() {
    let mut random = Random(31);
    let mut kept = 0;
    for case in 0..60 {
        let mass = random::mass(&mut random);
        let encounter = random::mesh(&mut random, mass);
        let n = encounter.pencil().size();
        let Ok(_) = Passage::new(encounter.clone(), SCHEME, encounter.penalty(1.0, 1.0), 0.9, 1.0)
            .unwrap()
            .prepare(false)
        else {
            continue;
        };
        kept += 1;
        // Held open far from contact: nothing but the translation.
        let moving = encounter.clone().with_velocity(vec![1.0; n]).unwrap().with_load(Vec::new()).unwrap();
        let (mut steps, _) = motion(&moving, ContactRule::HeldOpen, 0.5);
        let (found, ones) = (steps.energy().kinetic, vec![1.0; n]);
        let expected = 0.5 * encounter.pencil().mass().quadratic(&ones, &ones);
        assert!((found / expected - 1.0).abs() < 1e-13 * n as f64, "{case}: {found} {expected}");

        let c = 0.99;
        for rule in [ContactRule::HeldOpen, ContactRule::HeldClosed] {
            let touching = vec![0.0; encounter.pencil().gaps().len()];
            let encounter = encounter.clone().with_load(Vec::new()).unwrap().with_gaps(&touching).unwrap();
            let (mut steps, _) = motion(&encounter, rule, c);
            let massless: Vec<bool> = massless(&encounter);
            // Displacements grow by flight in proportion to the steps n, and forces round with them: n^2 units.
            let rounding = 4.0 * f64::EPSILON * f64::powi(2000.0, 2);
            let bound = steps.energy().balance() / (1.0 - c * c) * (1.0 + rounding);
            for step in 0..2000 {
                steps.step();
                let mut v = steps.state().velocity.clone();
                v.iter_mut().zip(&massless).filter(|(_, is)| **is).for_each(|(v, _)| *v = 0.0);
                let kinetic = 0.5 * encounter.pencil().mass().quadratic(&v, &v);
                assert!(kinetic <= bound, "{case} {rule:?} step {step}: {kinetic:e} {bound:e}");
            }
        }
    }
    assert!(kept > 20, "{kept}");
}

/// The unknowns of nodes that carry a gap: each unknown that a node of two directions in a row shares with one in a gap.
fn massless(encounter: &Encounter) -> Vec<bool> {
    let mut massless = vec![false; encounter.pencil().size()];
    let heirs = encounter.pencil().heirs().unwrap();
    heirs.0.iter().for_each(|(i, _)| massless[*i as usize] = true);
    massless
}

/// Contacts push, closed ones do not move, and no gap is penetrated by more than rounding.
#[test]
fn random_meshes_are_pushed_and_never_pulled() {
    let (mut random, mut pressed, mut refused) = (Random(32), 0, 0);
    for case in 0..80 {
        let mass = random::mass(&mut random);
        let encounter = random::mesh(&mut random, mass);
        let passage = Passage::new(encounter.clone(), SCHEME, encounter.penalty(1.0, 1.0), 0.9, 1.0).unwrap();
        let mut motion = match passage.prepare(false) {
            Ok(motion) => motion,
            Err(refusal) => {
                // One layer of elements between two contacts leaves no heir, a single cell may turn about its others.
                assert!(
                    ["mass redistribution", "stiffness", "contacts"].contains(&&*refusal.place),
                    "{refusal}"
                );
                refused += 1;
                continue;
            }
        };
        for _ in 0..400 {
            motion.step();
            let state = motion.state();
            let size = state.displacement.iter().fold(0.1, |a: f64, u| a.max(u.abs()));
            for (gap, force) in state.gap.iter().zip(&state.force) {
                assert!(*force >= 0.0 && *gap <= 1e-12 * size, "{case}: {gap:e} {force:e}");
                assert!(*force == 0.0 || *gap == 0.0, "{case}: {gap:e} {force:e}");
                pressed += usize::from(*force > 0.0);
            }
        }
    }
    println!("{pressed} forces, {refused} refused");
    assert!(pressed > 10_000 && refused < 40, "{pressed} {refused}");
}

/// Every element with lumped mass steps; with consistent mass those whose mass matrix lends enough, else a refusal.
#[test]
fn every_element_is_redistributed() {
    for element in ["tri3", "tri6", "quad4", "quad8", "tet4", "tet10", "hex8", "hex20"] {
        let solid = element.starts_with("tet") || element.starts_with("hex");
        let (dimension, sizes, cells, plane) = match solid {
            true => (3, "[1.0, 0.8, 1.0]", "[2, 2, 2]", ""),
            false => (2, "[1.0, 0.8]", "[3, 2]", "plane = \"strain\"\n"),
        };
        let velocity = if solid { "[0.0, -1.0, 0.0]" } else { "[0.0, -1.0]" };
        let text = format!(
            "name = \"block\"\ndimension = {dimension}\n{plane}[[body]]\nname = \"block\"\nbox = {sizes}\ncells = {cells}\n\
             element = \"{element}\"\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\nvelocity = {velocity}\n\
             [[contact]]\nsurfaces = [\"block.bottom\", \"wall\"]\n[impact]\nduration = 1.0\n"
        );
        for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
            let encounter = random::of_mesh(&text, mass);
            let passage =
                Passage::new(encounter.clone(), SCHEME, encounter.penalty(1.0, 1.0), 0.9, 4.0).unwrap();
            match passage.execute(1, None, |_, _| ()) {
                Ok(record) => {
                    let impulse: f64 = record.resultant().iter().map(|f| f * passage.time_step()).sum();
                    println!("{element} {}: {impulse:.3} N s, {} switches", mass.name(), record.switches);
                    // Thrown back: at most twice the momentum that came.
                    assert!(impulse > 0.8 && impulse < 1.6, "{element} {impulse}");
                    let allowed = 4.0 * f64::EPSILON * record.steps as f64 * record.largest_energy();
                    assert!(record.imbalance() <= allowed, "{element} {:e}", record.imbalance());
                }
                Err(refusal) => {
                    assert!(mass != MassMatrix::LUMPED, "{element}: {refusal}");
                    println!("{element}: {refusal}");
                }
            }
        }
    }
}

/// What cannot be redistributed is refused by name.
#[test]
fn what_no_node_can_take_over_is_refused() {
    let block = |cells: &str, element: &str, contacts: &str| {
        format!(
            "name = \"block\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"block\"\nbox = [1.0, 0.8]\ncells = {cells}\n\
             element = \"{element}\"\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\n{contacts}"
        )
    };
    let on = |side: &str| format!("[[contact]]\nsurfaces = [\"block.{side}\", \"wall\"]\n");
    let (bottom, top) = (on("bottom"), on("top"));
    let refusal = |encounter: &Encounter| {
        let penalty = encounter.penalty(1.0, 1.0);
        let passage = Passage::new(encounter.clone(), SCHEME, penalty, 0.9, 1.0).unwrap();
        passage.prepare(false).map(|_| ()).unwrap_err()
    };
    for (text, mass, place, value) in [
        // One layer between two contacts, twice the same contact, and a consistent mass that lends what it does not have.
        (
            block("[3, 1]", "quad4", &(bottom.clone() + &top)),
            MassMatrix::LUMPED,
            "mass redistribution",
            "no node",
        ),
        (block("[3, 2]", "quad4", &(bottom.clone() + &bottom)), MassMatrix::LUMPED, "contacts", "8"),
        (block("[3, 2]", "tri6", &bottom), MassMatrix::CONSISTENT, "mass redistribution", "would lose"),
    ] {
        let refusal = refusal(&random::of_mesh(&text, mass));
        assert!(refusal.place == place && refusal.value.contains(value), "{refusal}");
    }
    // The same matrices without the mesh do not tell which unknowns are beside which.
    let encounter = random::of_mesh(&block("[3, 2]", "quad4", &bottom), MassMatrix::LUMPED);
    let known = encounter.pencil();
    let (stiffness, mass) = (known.stiffness().clone(), known.mass().clone());
    let raw = Pencil::new(stiffness, mass, known.gaps().to_vec(), known.bounds(), known.reference()).unwrap();
    let n = raw.size();
    let raw = Encounter::new(raw, vec![0.0; n], Vec::new(), encounter.critical_step()).unwrap();
    let refusal = refusal(&raw);
    assert!(refusal.value.contains("does not tell"), "{refusal}");
}
