//! Errors from one run, times from others: how a measurement is made.

use rayon::prelude::*;

use super::{
    Clock, Eigenproblem, ExactEigenvalue, ExactEigenvalues, Family, Forecast, ImpactErrors, Impactproblem,
    Measurement, Method, Status,
};
use bipenalty::error::{Refusal, Result};

/// Measures `methods` on the problem `name` with each of `sizes`, in ascending order; calls `done` after each.
///
/// # Errors
/// What [`Eigenproblem::new`] and [`ExactEigenvalues::of`] refuse.
pub fn measure_eigenvalues(
    name: &'static str,
    sizes: &[usize],
    methods: &[Method],
    exact: &ExactEigenvalues,
    clock: &Clock,
    done: &dyn Fn(),
) -> Result<Vec<Measurement>, Refusal> {
    let mut forecasts: Vec<Forecast> = methods.iter().map(|method| Forecast::new(method.order())).collect();
    let mut measurements = Vec::new();
    for elements in sizes {
        let (problem, exact) = (Eigenproblem::new(name, *elements)?, exact.of(name, *elements)?);
        for (method, forecast) in methods.iter().zip(&mut forecasts) {
            measurements.push(measure_eigenvalue(&problem, *method, exact, clock, forecast));
            done();
        }
    }
    Ok(measurements)
}

fn measure_eigenvalue(
    problem: &Eigenproblem,
    method: Method,
    exact: ExactEigenvalue,
    clock: &Clock,
    forecast: &mut Forecast,
) -> Measurement {
    let blank = |status| {
        Measurement::without_value(Family::Eigenvalue, problem.name, &method.name(), problem.elements, status)
    };
    let expected = forecast.seconds(problem.elements);
    if expected > clock.limit {
        return blank(too_long(expected, clock));
    }
    let call = match method.call(problem) {
        Ok(call) => call,
        Err(why) => return blank(Status::Failed(why)),
    };
    let error = match call() {
        Ok(l) => exact.step_error(l),
        Err(why) => return blank(Status::Failed(why)),
    };
    let status = match method.claim() {
        Some(claim) if error.is_nan() || error.abs() > claim => {
            Status::Wrong(format!("the method claims at most {claim:e}"))
        }
        _ => Status::Done,
    };
    // The value keeps the compiler from leaving out the call.
    let seconds = clock.smallest(|| drop(std::hint::black_box(call())));
    forecast.note(problem.elements, seconds);
    Measurement {
        error: Some(error),
        seconds: Some(seconds),
        evaluations: method.evaluations(problem),
        ..blank(status)
    }
}

fn too_long(expected: f64, clock: &Clock) -> Status {
    Status::TimedOut(format!("about {expected:.0e} s; more than {} s", clock.limit))
}

/// Measures the impacts, one measurement a quantity: the errors in parallel, the times one after another on an idle
/// machine. Calls `done` twice for each.
///
/// # Errors
/// As [`Impactproblem::errors`].
pub fn measure_impacts(
    problems: &[Impactproblem],
    clock: &Clock,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Measurement>> {
    let errors = |problem: &Impactproblem| {
        let errors = problem.errors();
        done();
        errors
    };
    let errors: Vec<_> = problems.par_iter().map(errors).collect::<Result<_>>()?;
    let mut measurements = Vec::new();
    for (problem, errors) in problems.iter().zip(errors) {
        measurements.extend(measure_impact(problem, errors, clock));
        done();
    }
    Ok(measurements)
}

fn measure_impact(
    problem: &Impactproblem,
    errors: Result<ImpactErrors, String>,
    clock: &Clock,
) -> Vec<Measurement> {
    let evaluations = Some(problem.evaluations());
    let without = |status: Status| {
        let blank = |quantity: &str| Measurement { evaluations, ..problem.blank(quantity, status.clone()) };
        ImpactErrors::NAMES.map(blank).to_vec()
    };
    let errors = match errors {
        Ok(errors) => errors,
        Err(why) => return without(Status::Failed(why)),
    };
    // The same steps as those of the run that gave the errors: nothing is left to refuse.
    let seconds = clock.smallest(|| drop(problem.step_through()));
    let measured = |(quantity, error): (&str, f64)| Measurement {
        error: Some(error),
        seconds: Some(seconds),
        evaluations,
        ..problem.blank(quantity, Status::Done)
    };
    errors.named().map(measured).to_vec()
}
