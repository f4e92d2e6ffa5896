//! The scenes of the studies: two blocks, one on the other, the lower one held below.

use std::path::PathBuf;

use crate::error::Result;
use bipenalty::mesh::MeshScene;
use bipenalty::stability::AnyScene;

/// Steel: E in Pa, nu, rho in kg/m^3.
const STEEL: [f64; 3] = [210e9, 0.3, 7850.0];

/// An edge of the blocks along x, and along z in space, m; they are half as high.
const EDGE: f64 = 0.2;

/// Two blocks of steel.
#[derive(Debug, Clone)]
pub struct Blocks {
    /// Name of the scene.
    pub name: String,
    /// The element of both.
    pub element: &'static str,
    /// Cells along x of the lower and of the upper one; half as many along y.
    pub cells: [usize; 2],
}

impl Blocks {
    /// The speed of pressure waves, m/s: ((lambda + 2 mu)/rho)^(1/2).
    pub fn wave_speed() -> f64 {
        let [e, nu, rho] = STEEL;
        (e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / rho).sqrt()
    }

    /// An edge of a cell of the upper block, m.
    pub fn cell(&self) -> f64 {
        EDGE / self.cells[1] as f64
    }

    /// The size of an upper cell over that of a lower one.
    pub fn size_ratio(&self) -> f64 {
        self.cells[0] as f64 / self.cells[1] as f64
    }

    fn in_space(&self) -> bool {
        ["tet4", "tet10", "hex8", "hex20"].contains(&self.element)
    }

    /// The scene; the nodes of the upper block touch faces of the lower one.
    ///
    /// # Errors
    /// None for the scenes of the studies: as [`MeshScene::parse`].
    pub fn scene(&self) -> Result<AnyScene> {
        let height = 0.5 * EDGE;
        let vector = |x: f64, y: f64| match self.in_space() {
            true => format!("[{x:?}, {y:?}, {x:?}]"),
            false => format!("[{x:?}, {y:?}]"),
        };
        let [e, nu, rho] = STEEL;
        let body = |name: &str, origin: f64, cells: usize| {
            let low = (cells / 2).max(1);
            let cells = if self.in_space() {
                format!("[{cells}, {low}, {cells}]")
            } else {
                format!("[{cells}, {low}]")
            };
            format!(
                "[[body]]\nname = \"{name}\"\nbox = {}\ncells = {cells}\norigin = {}\nelement = \"{}\"\n\
                 youngs_modulus = {e:?}\npoissons_ratio = {nu:?}\ndensity = {rho:?}\n",
                vector(EDGE, height),
                vector(0.0, origin),
                self.element
            )
        };
        let (plane, held) = if self.in_space() {
            ("dimension = 3", "[\"x\", \"y\", \"z\"]")
        } else {
            ("dimension = 2\nplane = \"strain\"", "[\"x\", \"y\"]")
        };
        let text = format!(
            "name = \"{}\"\n{plane}\n{}{}[[contact]]\nsurfaces = [\"upper.bottom\", \"lower.top\"]\n\
             [[hold]]\nsurface = \"lower.bottom\"\ndirections = {held}\n",
            self.name,
            body("lower", 0.0, self.cells[0]),
            body("upper", height, self.cells[1]),
        );
        Ok(AnyScene::Mesh(MeshScene::parse(&text, &format!("{}.toml", self.name))?))
    }
}

/// The scene of a disc on a plane with its mesh, where the repository is at hand.
pub fn disc() -> Option<PathBuf> {
    let places = ["analyses/scenes", concat!(env!("CARGO_MANIFEST_DIR"), "/scenes")];
    places.iter().map(|place| PathBuf::from(place).join("disc-on-plane.toml")).find(|path| path.is_file())
}
