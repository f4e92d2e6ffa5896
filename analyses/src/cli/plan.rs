//! What a run computes, by what, and what the scene lets it leave out: the text of `--explain`.

use super::{Intent, LimitOptions};
use crate::error::Refusal;
use bipenalty::penalty::PenaltyMass;
use bipenalty::scene::End;
use bipenalty::schemes::SchemeName;
use bipenalty::schemes::explicit::{ExplicitFacts, ExplicitScheme};
use bipenalty::stability::{AnyModel, EngineName, Grid, LimitOf, Model, Plan, Prover};

/// The plan for `model` over `grid`: engine, cost of a point, and what is left out and why.
///
/// # Errors
/// As [`AnyModel::plan`].
pub fn explain(model: &AnyModel, limit: &LimitOptions, grid: &Grid) -> Result<Intent, Refusal> {
    let (subject, method) = match (model, limit.limit.scheme()) {
        (AnyModel::Mesh(_), _) => explain_mesh(model, limit, grid)?,
        (AnyModel::Bars(model), None) => explain_bars(model, limit.engine, grid),
        (AnyModel::Bars(model), Some(scheme)) => explain_scheme(model, scheme),
    };
    Ok(match limit.asking()?.limit {
        LimitOf::Explicit(scheme) => Intent::of(subject, format!("{method}\n{}", step_and_cost(&scheme))),
        LimitOf::Damped(_) => {
            Intent::of(subject, format!("{method}\ndamped: some ten such problems for each point"))
        }
        LimitOf::Spectrum | LimitOf::Scheme(_) => Intent::of(subject, method),
    })
}

/// What `points` limits take one core, s, by the times of `work-precision` on a machine of 2025, and what a mesh takes whose matrix is
/// factorised: 0.6 to 2.3 times the time of five maps and points of 6,500 to 160,000 unknowns; `None` where they were not timed.
pub(super) fn seconds_of(model: &AnyModel, limit: &LimitOptions, points: usize) -> Option<f64> {
    let AnyModel::Bars(model) = model else {
        return seconds_of_mesh(&model.plan(points, &limit.asking().ok()?).ok()?);
    };
    if limit.limit.scheme().is_some() || model.scales().len() > 1 {
        return None;
    }
    let elements = model.scene().elements() as f64;
    let each = match limit.engine {
        EngineName::Auto | EngineName::ClosedForm => 4e-6,
        EngineName::Sturm => 3.5e-7 * elements,
        EngineName::Dense => 2.7e-10 * elements.powi(3),
        _ => return None,
    };
    Some(each * points as f64)
}

fn seconds_of_mesh(plan: &Plan) -> Option<f64> {
    /// A multiplication of a factorisation, what else an entry of the factor takes in a proof, and an entry of K in a product, s.
    const MULTIPLICATION: f64 = 3e-11;
    const FACTOR: f64 = 2e-8;
    const STIFFNESS: f64 = 1e-9;
    /// Products of an eigenproblem, and what its other vectors take in products.
    const PRODUCTS: f64 = 100.0;
    let work = plan.work.filter(|_| plan.flexibilities == 0)?;
    let proof = MULTIPLICATION * work.operations + FACTOR * work.factor as f64;
    let eigenproblem = PRODUCTS * STIFFNESS * work.stiffness as f64;
    Some(plan.proofs as f64 * proof + plan.eigenproblems as f64 * eigenproblem)
}

/// How much larger a step a scheme stands than central differences, and what it pays for it.
pub fn step_and_cost(scheme: &ExplicitScheme) -> String {
    let ExplicitFacts { title, parameter, evaluations, formula, source, .. } = *scheme.facts();
    let longer = 0.5 * scheme.largest();
    let forces = if evaluations == 1 { "force" } else { "forces" };
    format!(
        "{title}, {parameter} = {}: Omega = {formula} = {:.4}, steps {longer:.4} times those of central differences with \
         {evaluations} {forces} each: {:.4} times the time a force buys ({source})",
        scheme.parameter(),
        scheme.largest(),
        longer / evaluations as f64,
    )
}

fn explain_bars(model: &Model, engine: EngineName, grid: &Grid) -> (String, String) {
    let left_out = left_out(model, engine, grid).join("; ");
    (bars(model), format!("{}\nleft out: {left_out}", method(model, engine)))
}

/// Bars in a few words.
fn bars(model: &Model) -> String {
    let scene = model.scene();
    let (elements, name, mass) = (scene.elements(), scene.name(), model.mass().name());
    format!("{name} ({elements} {}, {mass} mass)", if elements == 1 { "element" } else { "elements" })
}

/// How the limit of a scheme is found for bars.
fn explain_scheme(model: &Model, scheme: SchemeName) -> (String, String) {
    let method = match scheme {
        SchemeName::Park => {
            "multiplier -1 of the amplification matrix, about 10 pairs of eliminations of the pencil"
        }
        SchemeName::PredictorCorrector => {
            "dt^2 s' mu = 1 in closed form, of unlike contacts a lower bound; below the contact-free l_max signs of the secular equation"
        }
        other => other.facts().closed_limit,
    };
    (bars(model), method.to_owned())
}

/// How much of what size, and what proves it.
fn explain_mesh(model: &AnyModel, limit: &LimitOptions, grid: &Grid) -> Result<(String, String), Refusal> {
    let plan = model.plan(grid.len(), &limit.asking()?)?;
    let proof = match plan.prover {
        Some(Prover::Factorisation) => "by sparse Cholesky factorisations of all unknowns".to_owned(),
        Some(Prover::Patches { edge, total, different, largest }) => format!(
            "by Cholesky factorisations of {different} of {total} patches (the others are equal to them), {edge} elements along \
             an edge, at most {largest} unknowns"
        ),
        Some(Prover::Chance { probability, steps }) => {
            format!("by no proof: Lanczos of {steps} steps, wrong with a probability of {probability:e}")
        }
        None => "point by point".to_owned(),
    };
    let elements = plan.elements.map_or(String::new(), |n| format!("{n} elements, "));
    let mass = model.mass().map_or(String::new(), |mass| format!(", {} mass", mass.name()));
    let memory =
        plan.memory.map_or(String::new(), |bytes| format!(", about {} MB", bytes.div_ceil(1_000_000)));
    let flexibilities = match plan.flexibilities {
        0 => String::new(),
        some => format!(
            ", about {some} flexibilities of the contacts by conjugate gradients and residuals, {} columns each",
            2 * plan.contacts
        ),
    };
    let subject =
        format!("{} ({elements}{} unknowns, {} contacts{mass})", model.name(), plan.unknowns, plan.contacts);
    let method = format!(
        "{}, about {} eigenproblems of one function f(t) for all {} points, and {} bounds \
         {proof}{flexibilities}, to {:e} of a step{memory}\nleft out: an eigenproblem for each point; M_p in the eigenproblems; initial \
         velocities and gaps (every contact is closed)",
        plan.engine,
        plan.eigenproblems,
        plan.points,
        plan.proofs,
        plan.tolerance.unwrap_or(f64::EPSILON),
    );
    Ok((subject, method))
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
