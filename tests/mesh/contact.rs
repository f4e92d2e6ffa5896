//! Gaps, scales, supports and the names of places.

use bipenalty::fem::MassMatrix;
use bipenalty::mesh::{Assembled, HELD, MeshScene};

pub(crate) fn box_text(name: &str, size: &str, cells: &str, origin: &str, element: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nbox = {size}\ncells = {cells}\norigin = {origin}\nelement = \"{element}\"\n\
         youngs_modulus = 2.0\npoissons_ratio = 0.3\ndensity = 1.5\n"
    )
}

pub(crate) const PLANE: &str = "name = \"two\"\ndimension = 2\nplane = \"strain\"\n";
pub(crate) const SPACE: &str = "name = \"two\"\ndimension = 3\n";
const MEET: &str = "[[contact]]\nsurfaces = [\"a.bottom\", \"b.top\"]\n";

pub(crate) fn assemble(text: &str) -> Assembled {
    MeshScene::parse(text, "two.toml").unwrap().assemble(MassMatrix::LUMPED).unwrap()
}

/// z'u for the displacement `u` of every node, by body.
fn gap_rates(assembled: &Assembled, u: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Vec<f64> {
    let of = &assembled.elements;
    let mut x = vec![0.0; of.unknowns()];
    for (i, body) in of.bodies.iter().enumerate() {
        for (local, place) in body.mesh.nodes.iter().enumerate() {
            for direction in 0..of.dimension {
                let dof = of.dofs[(of.first[i].0 + local) * of.dimension + direction];
                if dof != HELD {
                    x[dof as usize] = u(i, *place)[direction];
                }
            }
        }
    }
    assembled.contacts.iter().map(|contact| contact.column.dot(&x)).collect()
}

/// Meshes that do not match, with every face: nothing closes in a common translation; pressing one body closes each gap
/// by as much; a linear field that both share opens none, wherever the nodes project.
#[test]
fn gaps_see_the_relative_motion_of_two_bodies() {
    for (element, depth) in [
        ("tri3", 0),
        ("tri6", 0),
        ("quad4", 0),
        ("quad8", 0),
        ("tet4", 1),
        ("tet10", 1),
        ("hex8", 1),
        ("hex20", 1),
    ] {
        let (size, head) = if depth == 0 { ("[1.0, 1.0]", PLANE) } else { ("[1.0, 1.0, 1.0]", SPACE) };
        let (upper, lower) = if depth == 0 { ("[4, 2]", "[3, 2]") } else { ("[4, 2, 3]", "[3, 1, 2]") };
        let (above, below) =
            if depth == 0 { ("[0.1, 0.0]", "[0.0, -1.0]") } else { ("[0.1, 0.0, 0.05]", "[0.0, -1.0, 0.0]") };
        let text = [
            head,
            &box_text("a", size, upper, above, element),
            &box_text("b", size, lower, below, element),
            MEET,
        ]
        .concat();
        let assembled = assemble(&text);
        assert!(assembled.contacts.len() > 3, "{element}");
        for rate in gap_rates(&assembled, |_, _| [0.3, -0.7, 0.2]) {
            assert!(rate.abs() < 1e-14, "{element}: {rate}");
        }
        for rate in gap_rates(&assembled, |body, _| [0.5, if body == 0 { -1.0 } else { 0.0 }, 0.25]) {
            assert!((rate - 1.0).abs() < 1e-14, "{element}: {rate}");
        }
        for rate in gap_rates(&assembled, |_, [x, y, z]| [y, 2.0 * x - 3.0 * z + y, x]) {
            assert!(rate.abs() < 1e-13, "{element}: {rate}");
        }
        assert!(assembled.contacts.iter().all(|contact| contact.initial_gap == 0.0 && contact.scale > 0.0));
        // The nodes of the upper body that overhang by 0.1 are left out.
        assert!(assembled.contacts.iter().all(|contact| contact.place.coordinates[0] <= 1.0));
    }
}

#[test]
fn matching_meshes_meet_node_to_node_and_keep_their_distance() {
    let [a, b] = [("a", "[0.0, 0.25]"), ("b", "[0.0, -1.0]")]
        .map(|(name, origin)| box_text(name, "[2.0, 1.0]", "[7, 2]", origin, "quad4"));
    let assembled = assemble(&[PLANE, &a, &b, MEET].concat());
    assert_eq!(assembled.contacts.len(), 8);
    for contact in &assembled.contacts {
        let mut weights: Vec<f64> = contact.column.0.iter().map(|(_, z)| *z).collect();
        weights.sort_by(f64::total_cmp);
        assert_eq!(weights, [-1.0, 1.0]);
        assert_eq!(contact.initial_gap, -0.25, "open by 0.25 m");
    }
    assert_eq!(
        assembled.contacts[2].place.to_string(),
        format!("at ({}, 0.25), between a and b", 2.0 * (2.0 / 7.0))
    );
}

/// A bar of one row of elements with nu = 0 on its end: w = z'Kz/(z'z)^2 = K_ii of the corner node.
#[test]
fn the_scale_is_the_stiffness_of_the_softer_side() {
    let text = [
        PLANE,
        &box_text("a", "[2.0, 1.0]", "[4, 2]", "[0.0, 0.0]", "quad4"),
        "[[contact]]\nsurfaces = [\"a.bottom\", \"wall\"]\n",
    ]
    .concat();
    let assembled = assemble(&text);
    assert_eq!(assembled.contacts.len(), 5);
    for contact in &assembled.contacts {
        let [(dof, z)] = contact.column.0[..] else { panic!("{:?}", contact.column) };
        assert_eq!((z, contact.initial_gap), (-1.0, 0.0), "down is into the wall");
        assert_eq!(contact.scale, assembled.stiffness.get(dof as usize, dof as usize));
    }
    let soft = box_text("b", "[2.0, 1.0]", "[4, 2]", "[0.0, -1.0]", "quad4")
        .replace("youngs_modulus = 2.0", "youngs_modulus = 0.5");
    let pair = assemble(
        &[PLANE, &box_text("a", "[2.0, 1.0]", "[4, 2]", "[0.0, 0.0]", "quad4"), &soft, MEET].concat(),
    );
    for (pair, wall) in pair.contacts.iter().zip(&assembled.contacts) {
        assert!((pair.scale / wall.scale - 0.25).abs() < 1e-14, "{} {}", pair.scale, wall.scale);
    }
}

#[test]
fn supports_remove_degrees_of_freedom() {
    let block = box_text("a", "[2.0, 1.0]", "[4, 2]", "[0.0, 0.0]", "quad4");
    let hold = "[[hold]]\nsurface = \"a.left\"\ndirections = [\"x\"]\n";
    let (free, held) = (assemble(&[PLANE, &block].concat()), assemble(&[PLANE, &block, hold].concat()));
    assert_eq!((free.stiffness.rows(), held.stiffness.rows()), (30, 27));
    let of = &held.elements;
    for (at, dof) in of.dofs.iter().enumerate() {
        let place = of.bodies[0].mesh.nodes[at / 2];
        assert_eq!(*dof == HELD, place[0] == 0.0 && at % 2 == 0);
        for (other, column) in
            of.dofs.iter().enumerate().filter(|(_, column)| *dof != HELD && **column != HELD)
        {
            assert_eq!(held.stiffness.get(*dof as usize, *column as usize), free.stiffness.get(at, other));
        }
    }
    // The elements add up to the matrix.
    let mut sum = vec![0.0; 27 * 27];
    for e in 0..of.len() {
        let (dofs, (k, _)) = (of.dofs(e), of.matrices(e).unwrap());
        for (i, row) in dofs.iter().enumerate().filter(|(_, dof)| **dof != HELD) {
            for (j, column) in dofs.iter().enumerate().filter(|(_, dof)| **dof != HELD) {
                sum[*row as usize * 27 + *column as usize] += k[i * dofs.len() + j];
            }
        }
    }
    for (at, sum) in sum.iter().enumerate() {
        assert!((sum - held.stiffness.get(at / 27, at % 27)).abs() < 1e-14);
    }
}
