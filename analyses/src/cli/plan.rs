//! What a run computes, by what, and what the scene lets it leave out: the text of `--explain`.

use bipenalty::penalty::PenaltyMass;
use bipenalty::scene::End;
use bipenalty::stability::{EngineName, Grid, Model};

/// The plan for `model` over `grid`: engine, cost of a point, and what is left out and why.
pub fn explain(model: &Model, engine: EngineName, grid: &Grid) -> String {
    let scene = model.scene();
    let bars = if scene.bars().len() == 1 { "bar" } else { "bars" };
    format!(
        "{} ({} {bars}, {} elements, {} mass): {}\n    left out: {}",
        scene.name(),
        scene.bars().len(),
        scene.elements(),
        model.mass().name(),
        method(model, engine),
        left_out(model, engine, grid).join("; "),
    )
}

fn method(model: &Model, engine: EngineName) -> String {
    let contacts = model.scales().len();
    let certificate = "certified by two signs a point";
    match engine {
        EngineName::Auto | EngineName::ClosedForm if is_one_bar(model) => {
            format!("closed-form, one quadratic a point and Newton steps near the band edge, {certificate}")
        }
        EngineName::Auto | EngineName::ClosedForm if contacts == 1 => {
            format!("closed-form, one scalar equation T(l) = s - l m a point, {certificate}")
        }
        EngineName::Auto | EngineName::ClosedForm => {
            format!("closed-form, bisection on the {contacts} contacts of the row, {certificate}")
        }
        EngineName::Secular if contacts == 1 => {
            "secular, T(l) compressed octave by octave, 26 eliminations of the pencil each".to_owned()
        }
        EngineName::Secular => format!("secular, bisection on the determinant of {contacts} contacts"),
        EngineName::Sturm => "sturm, about 53 eliminations of the pencil a point".to_owned(),
        EngineName::Dense => "dense, one reduction with faer a point, proven by two Sturm counts".to_owned(),
        #[cfg(feature = "lapack")]
        EngineName::Lapack => {
            "lapack, one reduction with LAPACK a point, proven by two Sturm counts".to_owned()
        }
    }
}

/// Whether the closed form treats the scene as one uniform bar with a free far end.
fn is_one_bar(model: &Model) -> bool {
    let scene = model.scene();
    let free = |end: End| end == End::Free;
    match scene.bars() {
        [_] => free(scene.left()) != free(scene.right()) && !has_fixed_end(model),
        [a, b] => {
            let same = a.element_stiffness() == b.element_stiffness()
                && a.element_mass() == b.element_mass()
                && a.elements == b.elements;
            same && free(scene.left()) && free(scene.right())
        }
        _ => false,
    }
}

fn has_fixed_end(model: &Model) -> bool {
    model.scene().left() == End::Fixed || model.scene().right() == End::Fixed
}

fn left_out(model: &Model, engine: EngineName, grid: &Grid) -> Vec<&'static str> {
    let mut left_out =
        vec!["eigenvectors (a limit needs none)", "initial velocities and gaps (every contact is closed)"];
    let ratios = || grid.ratios.iter().map(|r| r.get());
    if ratios().any(f64::is_infinite) {
        left_out.push("M_p at r = inf");
    }
    if grid.stiffness_penalties.iter().any(|b| b.get() == 0.0) {
        left_out.push("all penalties at beta_s = 0");
    }
    if !engine.needs_pencil() {
        left_out.push("the assembled matrices (the bars are uniform: cost independent of their elements)");
    } else if model.mass().is_lumped() {
        left_out.push("off-diagonal mass (lumped)");
    }
    if !engine.needs_pencil() && is_one_bar(model) && model.scene().bars().len() == 2 {
        left_out.push("the second bar (equal to the first: the gap feels half of each)");
    }
    if !engine.is_dense() && engine != EngineName::Sturm && model.form() == PenaltyMass::Consistent {
        left_out.push("a new function for each (beta_s, r): one T(l) serves all");
    }
    left_out
}
