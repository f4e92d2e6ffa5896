//! Who governs the step: shares that add up, a mode that has the frequency of the limit, and its file.

use bipenalty::penalty::PenaltyMass;
use bipenalty::schemes::SchemeName;
use bipenalty::stability::{AnyModel, AnyScene, Asking, MeshModel};

use crate::scenes::TWO_BLOCKS;

fn blocks() -> AnyModel {
    AnyModel::new(&AnyScene::parse(TWO_BLOCKS, "b.toml").unwrap(), None, PenaltyMass::Consistent).unwrap()
}

/// The quotient of the mode is l of the point, and the shares are parts of a whole.
#[test]
fn the_mode_has_the_frequency_of_the_limit_and_its_shares_add_up() {
    let model = blocks();
    let AnyModel::Mesh(mesh) = &model else { panic!() };
    let reference = model.reference().unwrap();
    for (beta_s, ratio) in [(1e-3, 1.0), (2.0, f64::INFINITY), (1e4, 5.0), (30.0, 0.5)] {
        let found = model.governs(beta_s, ratio, &Asking::default()).unwrap();
        let step = model.critical_step(beta_s, ratio, &Asking::default()).unwrap().step.unwrap();
        let (own, gaps) = mesh.pencil().quotients(&found.mode);
        let quotient = (own + beta_s * gaps) / (1.0 + beta_s / (ratio * reference) * gaps);
        let place = format!("{beta_s}, {ratio}: {:?}, {quotient}", found.l);
        assert!((quotient / found.l.value - 1.0).abs() < 1e-9, "{place}");
        assert!((step.omega_max.powi(2) / found.l.value - 1.0).abs() < 1e-8, "{place}");
        let contacts: f64 = found.contacts.iter().map(|c| c.share).sum();
        let bodies: f64 = found.bodies.iter().map(|(_, part)| part).sum();
        assert!((contacts - 1.0).abs() < 1e-12 && (bodies - 1.0).abs() < 1e-12, "{place}");
        assert!(found.contacts.windows(2).all(|pair| pair[0].share >= pair[1].share));
        assert!(found.elements.windows(2).all(|pair| pair[0].1 >= pair[1].1) && found.elements.len() == 10);
        assert!((found.contact_energy - beta_s * gaps / (own + beta_s * gaps)).abs() < 1e-9, "{place}");
    }
    // A stiff contact holds the energy of the mode; a weak one leaves it to the mesh.
    assert!(model.governs(1e6, f64::INFINITY, &Asking::default()).unwrap().contact_energy > 0.999);
    assert!(model.governs(1e-6, 1.0, &Asking::default()).unwrap().contact_energy < 1e-5);
}

/// One contact a thousand times as stiff as the others governs, and is named by its place.
#[test]
fn the_stiffest_contact_governs() {
    let model = blocks();
    let AnyModel::Mesh(mesh) = &model else { panic!() };
    let (k, m, gaps) = mesh.matrices();
    let scales: Vec<f64> = (0..gaps.len()).map(|j| if j == 3 { 1e3 } else { 1.0 }).collect();
    let columns = gaps.iter().map(|gap| gap.column.clone()).collect();
    let other = MeshModel::from_matrices(k.clone(), m.clone(), columns, &scales, None).unwrap();
    let found = AnyModel::Mesh(Box::new(other)).governs(10.0, f64::INFINITY, &Asking::default()).unwrap();
    assert!(found.contacts[0].contact == 3 && found.contacts[0].share > 0.99, "{:?}", found.contacts);
    assert_eq!(found.contacts[0].to_string().split(':').next(), Some("contact 4"));
    let named = model.governs(10.0, f64::INFINITY, &Asking::default()).unwrap().contacts[0].to_string();
    assert!(named.contains(", 2), between upper and lower: ") && named.ends_with(" %"), "{named}");
    let corrector = Asking { limit: SchemeName::PredictorCorrector.into(), ..Asking::default() };
    assert!(model.governs(1.0, 1.0, &corrector).is_err());
}

/// Bars have no mesh: their mode is found, and no file is written of it.
#[test]
fn the_mode_of_a_mesh_is_written_for_paraview() {
    let model = blocks();
    let found = model.governs(100.0, f64::INFINITY, &Asking::default()).unwrap();
    let mut file = Vec::new();
    model.write_mode(&found, &mut file, "mode.vtu").unwrap();
    let text = String::from_utf8(file).unwrap();
    let array = |name: &str| -> Vec<f64> {
        let after = text.split(&format!("Name=\"{name}\"")).nth(1).unwrap();
        let body = after.split_once('>').unwrap().1.split("</DataArray>").next().unwrap();
        body.split_whitespace().map(|word| word.parse().unwrap()).collect()
    };
    // 7 x 5 and 6 x 4 nodes, 24 and 15 squares.
    assert!(text.contains("NumberOfPoints=\"59\" NumberOfCells=\"39\""));
    assert_eq!((array("connectivity").len(), array("types")), (4 * 39, vec![9.0; 39]));
    assert_eq!(array("offsets").last(), Some(&156.0));
    assert!(array("connectivity").iter().all(|node| *node < 59.0));
    assert_eq!(array("body").iter().sum::<f64>(), 15.0);
    assert!((array("strain_energy").iter().sum::<f64>() - 1.0).abs() < 1e-12);
    let mode = array("mode");
    let (nodes, free) = (mode.len() / 3, found.mode.iter().map(|x| x * x).sum::<f64>());
    assert!(nodes == 59 && (mode.iter().map(|x| x * x).sum::<f64>() / free - 1.0).abs() < 1e-12);
    // The lower block is held at the bottom: its first seven nodes do not move, and nothing leaves the plane.
    assert!(mode[..21].iter().all(|x| *x == 0.0) && mode.iter().skip(2).step_by(3).all(|x| *x == 0.0));
    assert_eq!(text.matches("<DataArray").count(), text.matches("</DataArray>").count());

    let bars = AnyModel::Bars(crate::bars::bars("hunek", 6, bipenalty::fem::MassMatrix::LUMPED));
    let found = bars.governs(1e4, 10.0, &Asking::default()).unwrap();
    assert!((found.contacts[0].share - 1.0).abs() < 1e-12 && found.contact_energy > 0.9, "{found:?}");
    assert_eq!(bars.write_mode(&found, &mut Vec::new(), "mode.vtu").unwrap_err().place, "format");
}
