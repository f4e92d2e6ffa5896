//! Bodies at rest beside what is known of them.

use bipenalty::fem::MassMatrix;
use bipenalty::impact::Encounter;
use bipenalty::mesh::Place;
use bipenalty::penalty::PenaltyMass;
use bipenalty::scene::{Bar, End, Impact, Scene};
use bipenalty::schemes::StaticContact;
use bipenalty::stability::{AnyModel, AnyScene, Model};

/// A row of bars between a fixed end and a wall, every gap closed by the load at the last node: EA/L in series.
#[test]
fn bars_in_a_row_are_springs_in_series() {
    let bar = |length, modulus| Bar { length, youngs_modulus: modulus, ..Bar::unit(5) };
    let impact = Impact { duration: 1.0, gaps: vec![0.01], gravity: 0.0 };
    let scene = Scene::new("row", End::Fixed, vec![bar(2.0, 3.0)], End::Wall, Some(impact)).unwrap();
    let model = Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
    let pencil = Encounter::of_bars(&model).unwrap().pencil().clone();
    let mut statics = StaticContact::new(&pencil).unwrap();
    let (n, stiffness) = (pencil.size(), 3.0 / 2.0);
    for push in [-0.1, 0.0, 0.01, 0.3, 2.0] {
        let mut load = vec![0.0; n];
        load[n - 1] = push;
        let rest = statics.solve(&load, &[]).unwrap();
        let expected = f64::max(push - 0.01 * stiffness, 0.0);
        assert!((rest.force[0] - expected).abs() < 1e-14, "{push}: {:?}", rest.force);
        assert!(
            (rest.gap[0] - f64::min(push / stiffness - 0.01, 0.0)).abs() < 1e-14,
            "{push}: {:?}",
            rest.gap
        );
    }
    // Moved onto the wall by 0.05 as a whole.
    let rest = statics.solve(&[], &[0.05]).unwrap();
    assert!((rest.force[0] - 0.04 * stiffness).abs() < 1e-14);
    let refused =
        |refusal: Result<_, bipenalty::error::Refusal>| refusal.map(|_: StaticContact| ()).unwrap_err();
    assert_eq!(refused(StaticContact::carried(&pencil, &vec![1.0; n])).place, "motion");
    assert_eq!(statics.solve(&[f64::NAN], &[]).unwrap_err().place, "load");
    let free = Scene::new("free", End::Free, vec![Bar::unit(5)], End::Wall, None).unwrap();
    let free = Model::new(free, MassMatrix::LUMPED, PenaltyMass::Consistent).pencil();
    assert_eq!(refused(StaticContact::new(&free)).place, "stiffness");
    // Carried, of mass m: under F in its middle the wall takes F, and the mean is L/3 EA/F from the wall: u = F x^2/(2 L EA).
    let mut carried = StaticContact::carried(&free, &[1.0; 6]).unwrap();
    let found = carried.solve(&[], &[0.1]).unwrap();
    let mean =
        found.displacement[1..5].iter().sum::<f64>() + 0.5 * (found.displacement[0] + found.displacement[5]);
    assert!(mean.abs() < 1e-14);
    // Five elements of 1: u_k - u_{k-1} = -F (k - 1/2)/5.
    let mut u = vec![0.0];
    (1..6).for_each(|k| u.push(u[k - 1] - (f64::from(k as u32) - 0.5) / 5.0));
    let offset = (u[1..5].iter().sum::<f64>() + 0.5 * (u[0] + u[5])) / 5.0;
    let expected = 0.1 / (offset - u[5]);
    assert!((found.force[0] / expected - 1.0).abs() < 1e-13, "{:?} {expected}", found.force);
}

/// The far displacement of a half space under a point force over that of Hertz: F (1 + nu)(3 - 2 nu)/(2 pi E R) at the depth R.
fn far(force: f64, radius: f64) -> f64 {
    force * 1.3 * 2.4 / (2.0 * std::f64::consts::PI * 210e9 * radius)
}

/// 4/3 E* R^1/2 d^3/2 against a rigid plane.
fn hertz(radius: f64, approach: f64) -> f64 {
    4.0 / 3.0 * 210e9 / (1.0 - 0.09) * radius.sqrt() * approach.max(0.0).powf(1.5)
}

/// The sphere carried at its plane by its inertia, cells of h = 0.14 mm at the contact. The node that is pressed first stands for a
/// cell, over which the pressure falls by (h/2a)^2; the finite size is of first order in a/R, what it leaves of second.
#[test]
fn a_sphere_on_a_plane_follows_hertz() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/analyses/scenes/sphere-on-plane.toml");
    let scene = AnyScene::parse(&std::fs::read_to_string(path).unwrap(), path).unwrap();
    let model = AnyModel::new(&scene, Some(MassMatrix::LUMPED), PenaltyMass::Consistent).unwrap();
    let encounter = Encounter::of_scene(&scene, &model).unwrap();
    let down: Vec<f64> = encounter.velocity().iter().map(|v| v / 10.0).collect();
    let mut statics = StaticContact::carried(encounter.pencil(), &down).unwrap();
    let (radius, cell) = (0.01, 0.14e-3);
    println!("a/R    d, um    F, N     Hertz            with the finite size   nodes");
    for share in [0.03, 0.05, 0.07, 0.09, 0.106, 0.12_f64] {
        let approach = radius * share * share;
        let rest = statics.solve(&[], &vec![approach; encounter.pencil().gaps().len()]).unwrap();
        let force = 4.0 * rest.force.iter().sum::<f64>();
        let pressed = rest.force.iter().filter(|force| **force > 0.0).count();
        let plain = hertz(radius, approach);
        let finite = hertz(radius, approach + far(force, radius));
        let errors = [force / plain - 1.0, force / finite - 1.0];
        let [of_plain, of_finite] = errors.map(|error| 100.0 * error);
        println!(
            "{share:.3}  {:6.2}  {force:8.1}  {plain:7.1} ({of_plain:+6.2} %)  {finite:7.1} ({of_finite:+.2} %)  {pressed}",
            approach * 1e6
        );
        let allowed = (0.5 * cell / (share * radius)).powi(2) + share * share;
        assert!(errors[1].abs() <= allowed, "{share}: {errors:?}, allowed {allowed}");
    }
}

/// A quarter of a block of 1 m, cells^3, under a rigid paraboloid of R = 4 m that comes down by each approach: the whole force,
/// and the pressure at the middle, the force of the node there over a quarter of a cell.
fn indented(cells: usize, approaches: &[f64]) -> Vec<[f64; 2]> {
    let text = format!(
        "name = \"block\"\ndimension = 3\n[[body]]\nname = \"block\"\nbox = [1.0, 1.0, 1.0]\ncells = [{cells}, {cells}, {cells}]\n\
         element = \"hex8\"\nyoungs_modulus = 210e9\npoissons_ratio = 0.3\ndensity = 7850.0\n\
         [[contact]]\nsurfaces = [\"block.top\", \"wall\"]\n\
         [[hold]]\nsurface = \"block.bottom\"\ndirections = [\"y\"]\n[[hold]]\nsurface = \"block.left\"\ndirections = [\"x\"]\n\
         [[hold]]\nsurface = \"block.back\"\ndirections = [\"z\"]\n[impact]\nduration = 1.0\n"
    );
    let scene = AnyScene::parse(&text, "block.toml").unwrap();
    let model = AnyModel::new(&scene, Some(MassMatrix::LUMPED), PenaltyMass::Consistent).unwrap();
    let AnyModel::Mesh(mesh) = &model else { panic!() };
    let square = |place: &Place| place.coordinates[0].powi(2) + place.coordinates[2].powi(2);
    let squares: Vec<f64> = mesh.places().unwrap().iter().map(square).collect();
    let middle = squares.iter().position(|square| *square == 0.0).unwrap();
    let mut statics = StaticContact::new(&mesh.stepping_pencil().unwrap()).unwrap();
    let area = 0.25 / (cells * cells) as f64;
    let mut one = |approach: &f64| {
        let closing: Vec<f64> = squares.iter().map(|square| approach - square / (2.0 * WIDE)).collect();
        let rest = statics.solve(&[], &closing).unwrap();
        [4.0 * rest.force.iter().sum::<f64>(), rest.force[middle] / area]
    };
    approaches.iter().map(&mut one).collect()
}

const WIDE: f64 = 4.0;

/// F gives the contact radius a^3 = 3 F R/(4 E*) and the pressure p0 = 3 F/(2 pi a^2). What sides and support change is a smooth
/// displacement of size F/(E L): its constant part adds kappa F/E to the approach, with one kappa for all, its curvature
/// F/(E L^3) changes 1/R by (a/L)^3. The force of the node in the middle is that of a cell, to whose corner the pressure falls by
/// (h/2a)^2.
#[test]
fn a_block_under_a_paraboloid_has_the_pressure_and_the_force_of_hertz() {
    let approaches = [0.2, 0.3, 0.4].map(|a: f64| a * a / WIDE);
    let meshes = [8, 12, 16].map(|cells| (cells, indented(cells, &approaches)));
    let local = |force: f64| (force / hertz(WIDE, 1.0)).powf(2.0 / 3.0);
    let finest = meshes[2].1[2][0];
    let kappa = (local(finest) - approaches[2]) / finest;
    let mut errors = Vec::new();
    for (cells, found) in &meshes {
        for (approach, [force, pressure]) in approaches.iter().zip(found) {
            let a = (0.75 * force * WIDE * 0.91 / 210e9).cbrt();
            let peak = 1.5 * force / (std::f64::consts::PI * a * a);
            let found = [force / hertz(WIDE, approach + kappa * force) - 1.0, pressure / peak - 1.0];
            println!("{cells} cells, a = {a:.4}: force {:+.4}, pressure {:+.4}", found[0], found[1]);
            let allowed = (0.5 / (*cells as f64 * a)).powi(2) + a.powi(3);
            assert!(found.iter().all(|error| error.abs() <= allowed), "{found:?} {allowed}");
            errors.push(found);
        }
    }
    // From 8 to 16 cells: the first order would halve the errors of the smallest contact.
    assert!((0..2).all(|i| errors[6][i].abs() < 0.5 * errors[0][i].abs()), "{errors:?}");
}
