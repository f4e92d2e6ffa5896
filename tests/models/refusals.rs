//! What does not apply is refused, by place, value and what is allowed.

use bipenalty::fem::MassMatrix;
use bipenalty::penalty::PenaltyMass;
use bipenalty::schemes::SchemeName;
use bipenalty::stability::{AnyModel, AnyScene, Asking, EngineName};

use crate::bars::{as_matrices, bars};

const BLOCK: &str = r#"name = "block"
dimension = 2
plane = "strain"
[[body]]
name = "block"
box = [2.0, 1.0]
cells = [4, 2]
element = "quad4"
youngs_modulus = 1.0
poissons_ratio = 0.3
density = 1.0
[[contact]]
surfaces = ["block.bottom", "wall"]
"#;

const BAR: &str =
    "name = \"rod\"\n[[bar]]\nlength = 1.0\nelements = 4\nyoungs_modulus = 1.0\ndensity = 1.0\narea = 1.0\n";

const FILES: &str = "name = \"m\"\n[matrices]\nstiffness = \"K.mtx\"\nmass = \"M.mtx\"\ngaps = \"Z.mtx\"\n";

#[test]
fn the_tables_of_a_file_say_what_it_is() {
    let scene = |text: &str| AnyScene::parse(text, "s.toml");
    assert!(matches!(scene(BLOCK).unwrap(), AnyScene::Mesh(_)));
    assert!(matches!(scene(BAR).unwrap(), AnyScene::Bars(_)));
    assert!(matches!(scene(FILES).unwrap(), AnyScene::Matrices(_)));
    assert!(matches!(AnyScene::load("hunek").unwrap(), AnyScene::Bars(_)));
    let both =
        format!("{BAR}{}", BLOCK.split_once("[[body]]").map(|(_, rest)| format!("[[body]]{rest}")).unwrap());
    let message = scene(&both).unwrap_err().to_string();
    assert!(message.contains("[[bar]] (line 2) beside [[body]] (line 8)"), "{message}");
    let message = scene("name = \"empty\"\n").unwrap_err().to_string();
    assert!(message.contains("s.toml") && message.contains("[[bar]], [matrices] and [[body]]"), "{message}");
    let message = scene("name = \"empty\n").unwrap_err().to_string();
    assert!(message.contains("line 1"), "{message}");
    assert!(AnyScene::load("no-such-scene").unwrap_err().to_string().contains("no-such-scene"));
}

#[test]
fn what_does_not_apply_is_refused() {
    let mesh = AnyScene::parse(BLOCK, "block.toml").unwrap();
    let files = AnyScene::parse(FILES, "m.toml").unwrap();
    assert!(mesh.with_elements(3).unwrap_err().place == "elements");
    let of = |scene: &AnyScene, mass, form| AnyModel::new(scene, mass, form).unwrap_err().to_string();
    assert!(of(&mesh, None, PenaltyMass::Diagonalised).starts_with("penalty mass"));
    assert!(of(&files, Some(MassMatrix::LUMPED), PenaltyMass::Consistent).starts_with("mass: lumped"));
    assert!(of(&files, None, PenaltyMass::Consistent).contains("K.mtx"));
    let model = AnyModel::new(&mesh, None, PenaltyMass::Consistent).unwrap();
    let matrices = AnyModel::Mesh(Box::new(as_matrices(&bars("signorini", 4, MassMatrix::LUMPED))));
    let rod = AnyModel::Bars(bars("signorini", 4, MassMatrix::LUMPED));
    let place = |model: &AnyModel, asking: Asking| {
        model.critical_step(1.0, 1.0, &asking).map(|_| String::new()).unwrap_or_else(|refusal| refusal.place)
    };
    let usual = Asking::default;
    assert_eq!(place(&model, Asking { engine: EngineName::Sturm, ..usual() }), "engine");
    assert_eq!(place(&matrices, Asking { patch: Some(2), ..usual() }), "patch");
    assert_eq!(place(&rod, Asking { patch: Some(2), ..usual() }), "patch");
    assert_eq!(place(&model, Asking { patch: Some(0), ..usual() }), "patch");
    assert_eq!(place(&model, Asking { tolerance: Some(1e-20), ..usual() }), "tolerance");
    assert_eq!(place(&model, Asking { memory: Some(10), ..usual() }), "memory of a patch");
    // A diagonal mass leaves evidence by chance; a consistent one has no factor in ten bytes.
    let consistent = AnyModel::Mesh(Box::new(as_matrices(&bars("signorini", 4, MassMatrix::CONSISTENT))));
    assert_eq!(place(&matrices, Asking { memory: Some(10), ..usual() }), "");
    assert_eq!(place(&consistent, Asking { memory: Some(10), ..usual() }), "mass matrix");
    // Park limits are proven or refused: evidence by chance has no proof that K is semidefinite.
    let park = || Asking { limit: SchemeName::Park.into(), ..usual() };
    assert_eq!(place(&matrices, Asking { memory: Some(10), ..park() }), "limit");
    assert_eq!(place(&matrices, park()), "");
    assert_eq!(model.contour(0.5, (0.1, 10.0), (0.1, 10.0), &park()).unwrap_err().place, "contour");
    assert!(
        model.critical_step(-1.0, 1.0, &usual()).is_err() && model.critical_step(1.0, 0.0, &usual()).is_err()
    );
    assert!(model.critical_step(1e308, 1.0, &usual()).is_err());
}
