//! Gmsh files and what scenes refuse.

use super::contact::{PLANE, SPACE, box_text};
use bipenalty::fem::MassMatrix;
use bipenalty::mesh::MeshScene;

fn refusal(text: &str) -> String {
    match MeshScene::parse(text, "folder/two.toml") {
        Ok(scene) => scene.assemble(MassMatrix::LUMPED).map(|_| ()).unwrap_err().to_string(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn what_means_nothing_is_refused_with_its_line() {
    let a = box_text("a", "[1.0, 1.0]", "[2, 2]", "[0.0, 0.0]", "quad4");
    let b = box_text("b", "[1.0, 1.0]", "[2, 2]", "[3.0, -1.0]", "quad4");
    let meet = |first: &str, second: &str| format!("[[contact]]\nsurfaces = [\"{first}\", \"{second}\"]\n");
    let hold =
        |surface: &str, way: &str| format!("[[hold]]\nsurface = \"{surface}\"\ndirections = [\"{way}\"]\n");
    let change = |from: &str, to: &str| [PLANE, &a.replace(from, to)].concat();
    let cases = [
        (
            [PLANE, &a, &b, &meet("a.bottom", "b.top")].concat(),
            "line 23, contact 1, surfaces",
            "surfaces that meet",
        ),
        ([PLANE, &a, &b, &meet("a.top", "b.top")].concat(), "line 23", "surfaces that meet"),
        ([PLANE, &a, &meet("a.front", "wall")].concat(), "line 14", "left right bottom top"),
        ([PLANE, &a, &meet("c.top", "wall")].concat(), "line 14", "a body of this scene: a"),
        ([PLANE, &a, &meet("a.top", "a.top")].concat(), "line 14", "twice"),
        ([PLANE, &a, &hold("a.top", "z")].concat(), "line 15, hold 1, directions", "\"x\", \"y\""),
        (
            change("poissons_ratio = 0.3", "poissons_ratio = 0.5"),
            "line 11, body 1, poissons_ratio",
            "below 0.5",
        ),
        (change("density = 1.5", "density = nan"), "line 12, body 1, density", "above 0"),
        (change("cells = [2, 2]", "cells = [2, 0]"), "line 7, body 1, cells", "at least 1"),
        (change("box = [1.0, 1.0]", "box = [1.0]"), "line 6, body 1, box", "2 finite numbers above 0"),
        (change("\"quad4\"", "\"hex8\""), "line 9, body 1, element", "tri3 tri6 quad4 quad8"),
        (change("\"quad4\"", "\"quad9\""), "line 9", "quad9"),
        (change("density", "densitty"), "line 12", "densitty"),
        (change("cells = [2, 2]", "mesh = \"a.msh\"\ncells = [2, 2]"), "body 1", "one of box and mesh"),
        (change("cells = [2, 2]", "cells = [4000000000000, 4000000000000]"), "cells", "fewer cells"),
        (change("cells = [2, 2]", "cells = [4000000, 4000000]"), "unknowns", "memory"),
        ([SPACE, &a].concat(), "body 1, box", "3 finite numbers"),
        (format!("name = \"two\"\ndimension = 2\n{a}"), "plane", "strain"),
        ([PLANE, &a, &a].concat(), "line 14, body 2, name", "a name of its own"),
    ];
    for (text, place, allowed) in cases {
        let message = refusal(&text);
        assert!(message.contains(place) && message.contains(allowed), "{message}\n{text}");
    }
}

fn write(name: &str, bytes: &[u8]) -> String {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, bytes).unwrap();
    path.display().to_string()
}

fn gmsh_scene(path: &str, dimension: usize, tail: &str) -> String {
    let plane = if dimension == 2 { "plane = \"stress\"\n" } else { "" };
    format!(
        "name = \"part\"\ndimension = {dimension}\n{plane}[[body]]\nname = \"part\"\nmesh = {path:?}\n\
         youngs_modulus = 2.0\npoissons_ratio = 0.3\ndensity = 1.5\n{tail}"
    )
}

/// Files that Gmsh wrote: their area or volume, their surfaces, the same from text and binary.
#[test]
fn files_of_gmsh_give_the_same_from_text_and_binary() {
    let folder = format!("{}/tests/data/gmsh", env!("CARGO_MANIFEST_DIR"));
    for (name, dimension, measure, side) in [
        ("plate-1", 2, 2.0, 1.0),
        ("plate-2", 2, 2.0, 1.0),
        ("quads", 2, 2.0, 1.0),
        ("block-1", 3, 1.0, 1.0),
        ("block-2", 3, 1.0, 1.0),
        ("bricks", 3, 1.0, 1.0),
    ] {
        let read = |form: &str| {
            let text = gmsh_scene(
                &format!("{folder}/{name}-{form}.msh"),
                dimension,
                "[[contact]]\nsurfaces = [\"part.base\", \"wall\"]\n",
            );
            MeshScene::parse(&text, "part.toml").unwrap().assemble(MassMatrix::CONSISTENT).unwrap()
        };
        let (text, binary) = (read("text"), read("binary"));
        assert_eq!(text.stiffness.rows(), binary.stiffness.rows(), "{name}");
        assert_eq!(text.contacts.len(), binary.contacts.len());
        let mass: f64 =
            (0..text.elements.len()).map(|e| text.elements.matrices(e).unwrap().1.iter().sum::<f64>()).sum();
        assert!((mass / (1.5 * measure) - 1.0).abs() < 1e-12, "{name}: {mass}");
        let mesh = &text.elements.bodies[0].mesh;
        let base = mesh.nodes_of(&mesh.surfaces["base"]);
        assert!(
            !base.is_empty() && base.iter().all(|node| mesh.nodes[*node as usize][dimension - 1] == 0.0),
            "{name}"
        );
        assert_eq!(base.len(), text.contacts.len());
        for contact in &text.contacts {
            let [(dof, z)] = contact.column.0[..] else { panic!("{:?}", contact.column) };
            assert!(
                (z + side).abs() < 1e-14 && dof as usize % dimension == dimension - 1,
                "{name}: the normal points down"
            );
        }
    }
}

#[test]
fn files_that_are_no_mesh_are_refused_with_their_line() {
    let folder = format!("{}/tests/data/gmsh", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(format!("{folder}/plate-1-text.msh")).unwrap();
    let binary = std::fs::read(format!("{folder}/plate-1-binary.msh")).unwrap();
    let scene = |path: &str| refusal(&gmsh_scene(path, 2, ""));
    for cut in (0..text.len() - 20).step_by(37) {
        let message = scene(&write("cut.msh", &text.as_bytes()[..cut]));
        assert!(message.contains("cut.msh, line"), "{cut}: {message}");
    }
    for cut in (0..binary.len() - 20).step_by(41) {
        let message = scene(&write("cut-binary.msh", &binary[..cut]));
        assert!(message.contains("cut-binary.msh, "), "{cut}: {message}");
    }
    let old = scene(&write("old.msh", text.replacen("4.1 0 8", "2.2 0 8", 1).as_bytes()));
    assert!(old.contains("old.msh, line 2") && old.contains("4.1"), "{old}");
    assert!(scene("no-such.msh").contains("no-such.msh"));
    assert!(
        refusal(&gmsh_scene(&format!("{folder}/plate-1-text.msh"), 3, ""))
            .contains("no element of dimension 3")
    );
    let unknown = gmsh_scene(
        &format!("{folder}/plate-1-text.msh"),
        2,
        "[[hold]]\nsurface = \"part.lid\"\ndirections = [\"x\"]\n",
    );
    assert!(refusal(&unknown).contains("surfaces of part: base"), "{}", refusal(&unknown));
    // Triangles that run clockwise.
    let mirrored =
        bipenalty::mesh::gmsh::read(std::path::Path::new(&format!("{folder}/plate-1-text.msh")), 2).unwrap();
    let mut body = super::body(bipenalty::mesh::element::Kind::Tri3, [1, 1, 1], |x| x);
    body.mesh = mirrored;
    body.mesh.distort(|[x, y, z]| [-x, y, z]);
    let elements = bipenalty::mesh::Elements::new(
        vec![body],
        2,
        super::plane(bipenalty::mesh::element::Kind::Tri3),
        1.0,
    );
    let message = elements.stiffness().unwrap_err().to_string();
    assert!(
        message.contains("body body, element 1 at")
            && message.contains("Jacobian determinant")
            && message.contains(": -0."),
        "{message}"
    );
}
