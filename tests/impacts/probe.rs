use bipenalty::fem::MassMatrix;
use bipenalty::impact::{Recording, Run, Summary};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::scene::built_in;
use bipenalty::schemes::SchemeName;
use bipenalty::stability::Model;

#[test]
fn probe() {
    for scene in ["signorini", "hunek", "bouncing-bar"] {
        for (beta_s, ratio, c) in [
            (1.0, 1.0, 0.5),
            (1e4, 1.0, 0.5),
            (1e12, 1.0, 0.5),
            (1e4, 1.0, 0.99),
            (1e4, 0.25, 0.99),
            (1e4, f64::INFINITY, 0.9),
        ] {
            for mass in [MassMatrix::LUMPED, MassMatrix::CONSISTENT] {
                for scheme in SchemeName::ALL {
                    let model = Model::new(built_in(scene).unwrap().unwrap(), mass, PenaltyMass::Consistent);
                    let run = Run::new(
                        model,
                        scheme,
                        StiffnessPenalty::new(beta_s).unwrap(),
                        Ratio::new(ratio).unwrap(),
                    )
                    .unwrap()
                    .with_relative_courant(c)
                    .unwrap();
                    let history =
                        run.execute(&Recording { energies: true, ..Recording::default() }, None).unwrap();
                    let s = Summary::of(&run, &history);
                    let peak = history.forces(0).fold(0.0, f64::max);
                    println!(
                        "{scene:13} {beta_s:7.0e} {ratio:4} {c:4} {:10} {:20} err {:?} energy {:?} switches {} peak {peak:.4} imbalance {:.1e}",
                        mass.name(),
                        scheme.name(),
                        s.force_error.map(|e| (e * 1e4).round() / 1e4),
                        s.energy_ratio.map(|e| (e * 1e5).round() / 1e5),
                        s.switches,
                        history.imbalance()
                    );
                }
            }
        }
    }
}
