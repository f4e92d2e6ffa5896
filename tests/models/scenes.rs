//! Small scenes of meshes.

// Each test file uses its own part of this module.
#![allow(dead_code)]

use crate::numbers::Numbers;

/// Two blocks of different material and mesh, the lower one held, in node-to-face contact.
pub const TWO_BLOCKS: &str = r#"name = "two-blocks"
dimension = 2
plane = "strain"
[[body]]
name = "lower"
box = [3.0, 2.0]
cells = [6, 4]
element = "quad4"
youngs_modulus = 2.0
poissons_ratio = 0.3
density = 1.0
[[body]]
name = "upper"
box = [2.0, 1.0]
cells = [5, 3]
origin = [0.5, 2.0]
element = "quad4"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
[[contact]]
surfaces = ["upper.bottom", "lower.top"]
[[hold]]
surface = "lower.bottom"
directions = ["x", "y"]
"#;

/// A small scene of one or two bodies in the plane or in space, of any element; unlike materials and cells, with or without
/// supports, in contact with each other or with a wall.
pub fn random_mesh(seed: u64) -> String {
    let mut random = Numbers(seed * 77 + 5);
    let space = random.next() < 0.35;
    let kinds: &[&str] = if space {
        &["tet4", "hex8", "hex8", "tet10", "hex20"]
    } else {
        &["tri3", "quad4", "quad4", "tri6", "quad8"]
    };
    let plane = if space {
        ""
    } else if random.next() < 0.5 {
        "plane = \"strain\"\n"
    } else {
        "plane = \"stress\"\n"
    };
    let mut text = format!("name = \"random\"\ndimension = {}\n{plane}", if space { 3 } else { 2 });
    let two = random.next() < 0.7;
    for body in 0..=usize::from(two) {
        let most = if space { 2 } else { 4 };
        let cells: Vec<usize> = (0..if space { 3 } else { 2 }).map(|_| 1 + random.below(most)).collect();
        let (size, origin) = if space {
            ("[2.0, 1.0, 1.0]", format!("[0.0, {body}.0, 0.0]"))
        } else {
            ("[2.0, 1.0]", format!("[0.0, {body}.0]"))
        };
        let (e, nu, rho) = (random.log(1e-2, 1e2), 0.45 * random.next(), random.log(0.1, 10.0));
        text += &format!(
            "[[body]]\nname = \"b{body}\"\nbox = {size}\norigin = {origin}\ncells = {cells:?}\nelement = \"{}\"\n\
             youngs_modulus = {e}\npoissons_ratio = {nu}\ndensity = {rho}\n",
            kinds[random.below(kinds.len())]
        );
    }
    if two {
        text += "[[contact]]\nsurfaces = [\"b1.bottom\", \"b0.top\"]\n";
    }
    if !two || random.next() < 0.3 {
        text += &format!("[[contact]]\nsurfaces = [\"b{}.top\", \"wall\"]\n", usize::from(two));
    }
    if random.next() < 0.5 {
        text += "[[hold]]\nsurface = \"b0.bottom\"\ndirections = [\"x\", \"y\"]\n";
    }
    text
}
