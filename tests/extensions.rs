//! What a stranger can add with the public interface alone: a scheme, an engine, an element, a pencil, each in one place and
//! one line of its suite.

#![allow(clippy::unwrap_used)]

#[path = "common/conformance/mod.rs"]
#[macro_use]
mod conformance;
#[path = "extensions/backwards.rs"]
mod backwards;
#[path = "extensions/beam.rs"]
mod beam;
#[path = "extensions/damped.rs"]
mod damped;
#[path = "extensions/truss.rs"]
mod truss;

use bipenalty::error::Refusal;
use bipenalty::schemes::Scheme;

scheme_conformance! {
    damped_central_difference => damped::Damped { rate: 0.05 };
    undamped => damped::Damped { rate: 0.0 };
}

engine_conformance! {
    right_to_left => |_, pencil| Ok(Box::new(backwards::Backwards::new(pencil)?)), 1e-14;
}

pencil_conformance! {
    beam_on_a_stop => beam::cantilever(6).unwrap();
    truss_against_a_wall => truss::truss().unwrap();
}

/// Each of them is a page.
#[test]
fn each_takes_less_than_sixty_lines() {
    for source in [
        include_str!("extensions/damped.rs"),
        include_str!("extensions/beam.rs"),
        include_str!("extensions/backwards.rs"),
        include_str!("extensions/truss.rs"),
    ] {
        let code =
            source.lines().filter(|line| !line.trim().is_empty() && !line.trim_start().starts_with("//"));
        assert!(code.count() < 60, "{}", source.lines().next().unwrap());
    }
}

/// A scheme of one's own runs wherever one of this crate does.
#[test]
fn a_scheme_of_ones_own_makes_an_impact() -> Result<(), Refusal> {
    use bipenalty::fem::MassMatrix;
    use bipenalty::impact::{Ending, Recording, Run, Summary};
    use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
    use std::sync::Arc;
    let scene = bipenalty::scene::built_in("signorini").unwrap().unwrap().with_elements(40)?;
    let model = bipenalty::stability::Model::new(scene, MassMatrix::LUMPED, PenaltyMass::Consistent);
    let error = |rate: f64| -> Result<f64, Refusal> {
        let scheme: Arc<dyn Scheme> = Arc::new(damped::Damped { rate });
        let run = Run::new(model.clone(), scheme, StiffnessPenalty::new(10.0)?, Ratio::OPTIMAL)?;
        let history = run.execute(&Recording::default(), None)?;
        assert_eq!(history.ending, Ending::Finished);
        Ok(Summary::of(&run, &history).force_error.unwrap())
    };
    // Without damping the contact chatters.
    let (damped, undamped) = (error(5.0)?, error(0.0)?);
    assert!(damped < undamped, "{damped} {undamped}");
    Ok(())
}
