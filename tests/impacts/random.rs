//! Random encounters: rows of bars and small meshes with many contacts, all nodes in unsteady motion.

use bipenalty::fem::MassMatrix;
use bipenalty::impact::Encounter;
use bipenalty::penalty::PenaltyMass;
use bipenalty::scene::{Bar, End, Impact, Scene};
use bipenalty::stability::{AnyModel, AnyScene, Model};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }
}

/// Lumped, averaged or consistent.
pub fn mass(random: &mut Random) -> MassMatrix {
    random.one(&[MassMatrix::LUMPED, MassMatrix::AVERAGED, MassMatrix::CONSISTENT])
}

/// One to four bars between ends of any kind, up to five contacts.
pub fn bars(random: &mut Random, mass: MassMatrix) -> Encounter {
    loop {
        let bar = |random: &mut Random| Bar {
            length: random.between(0.3, 3.0),
            elements: 1 + random.below(7),
            youngs_modulus: 10_f64.powf(random.between(-1.0, 1.0)),
            density: 10_f64.powf(random.between(-1.0, 1.0)),
            area: random.between(0.3, 3.0),
            velocity: random.between(-1.0, 1.0),
        };
        let bars: Vec<Bar> = (0..=random.below(4)).map(|_| bar(random)).collect();
        let (left, right) = (
            random.one(&[End::Free, End::Fixed, End::Wall]),
            random.one(&[End::Free, End::Fixed, End::Wall]),
        );
        let contacts = bars.len() - 1 + [left, right].iter().filter(|end| **end == End::Wall).count();
        if contacts == 0 {
            continue;
        }
        let gaps = (0..contacts).map(|_| random.one(&[0.0, 0.05, 0.3])).collect();
        let gravity = random.one(&[0.0, 0.0, 0.5, -1.0]);
        let impact = Impact { duration: 1.0, gaps, gravity };
        let Ok(scene) = Scene::new("random", left, bars, right, Some(impact)) else { continue };
        let model = Model::new(scene, mass, PenaltyMass::Consistent);
        let encounter = Encounter::of_bars(&model).unwrap();
        return thrown(random, encounter);
    }
}

/// Noise over the velocities of the bodies.
fn thrown(random: &mut Random, encounter: Encounter) -> Encounter {
    let noise = random.one(&[0.0, 0.3, 1.0]);
    let velocity = encounter.velocity().iter().map(|v| v + noise * random.between(-1.0, 1.0)).collect();
    encounter.with_velocity(velocity).unwrap()
}

/// The bodies of a mesh scene as they are thrown.
pub fn of_mesh(text: &str, mass: MassMatrix) -> Encounter {
    let scene = AnyScene::parse(text, "mesh.toml").unwrap();
    let model = AnyModel::new(&scene, Some(mass), PenaltyMass::Consistent).unwrap();
    Encounter::of_scene(&scene, &model).unwrap()
}

/// A block on a wall, or two blocks whose nodes meet or do not meet: contacts that share nodes.
pub fn mesh(random: &mut Random, mass: MassMatrix) -> Encounter {
    let kind = random.below(3);
    let body = |name: &str, random: &mut Random, cells: usize, origin: f64, velocity: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nbox = [2.0, 1.0]\ncells = [{cells}, {}]\norigin = [0.0, {origin:?}]\nelement = \"quad4\"\n\
             youngs_modulus = {:?}\npoissons_ratio = {:?}\ndensity = {:?}\nvelocity = [{:?}, {velocity:?}]\n",
            1 + random.below(3),
            10_f64.powf(random.between(-0.7, 0.7)),
            random.between(0.0, 0.4),
            10_f64.powf(random.between(-0.7, 0.7)),
            random.between(-0.2, 0.2),
        )
    };
    let cells = 1 + random.below(6);
    let other = if kind == 1 { cells } else { 1 + random.below(6) };
    let mut text = String::from("name = \"random\"\ndimension = 2\nplane = \"strain\"\n");
    text += &body("lower", random, cells, 0.0, if kind == 0 { -0.5 } else { 0.0 });
    if kind == 0 {
        text += "[[contact]]\nsurfaces = [\"lower.bottom\", \"wall\"]\n";
    } else {
        text += &body("upper", random, other, 1.0, -1.0);
        text += "[[contact]]\nsurfaces = [\"upper.bottom\", \"lower.top\"]\n";
        text += random.one(&[
            "",
            "[[hold]]\nsurface = \"lower.bottom\"\ndirections = [\"x\", \"y\"]\n",
            "[[contact]]\nsurfaces = [\"lower.bottom\", \"wall\"]\n",
        ]);
    }
    text += &format!("[impact]\nduration = 1.0\ngravity = [0.0, {:?}]\n", random.one(&[0.0, -0.5]));
    let encounter = of_mesh(&text, mass);
    let gaps: Vec<f64> = encounter.pencil().gaps().iter().map(|_| -random.one(&[0.0, 0.02, 0.1])).collect();
    thrown(random, encounter.with_gaps(&gaps).unwrap())
}
