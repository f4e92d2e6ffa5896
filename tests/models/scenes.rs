//! Small scenes of meshes.

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
