//! A model, and what is asked of it at one point.

use std::sync::{Arc, OnceLock};

use bipenalty::fem::MassMatrix;
use bipenalty::impact::Run;
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Pencil;
use bipenalty::scene::{MAX_ELEMENTS, load};
use bipenalty::schemes::SchemeName;
use bipenalty::spectrum::{Engine as _, Evidence, Spectrum, Step, StepLimit, Uncertified};
use bipenalty::stability::{
    Auto, CriticalStep, EngineName, Expectation, Grid, Model, check_has_contact, optimal_ratio,
    optimal_scheme_ratio,
};
use bipenalty::verify::{Point, Predictor, confirm};
use numpy::{PyReadonlyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::map::Map;
use crate::work::{Watch, long};
use crate::{failed, impact, refused, uncertified};

/// Points of a model with no more elements are found where they are asked: even by bisection they take less than the
/// time between two looks for Ctrl-C.
const QUICK: usize = 50_000;

/// A model as the Python package holds it.
#[pyclass(frozen, module = "bipenalty._bipenalty")]
pub struct Core(Arc<Inner>);

struct Inner {
    model: Model,
    auto: Auto,
    pencil: OnceLock<Pencil>,
}

/// Whose limit, and what finds it.
#[derive(Clone, Copy)]
pub struct Asked {
    pub name: &'static str,
    scheme: Option<SchemeName>,
    theta: f64,
    engine: EngineName,
}

impl Asked {
    fn new(limit: &str, theta: Option<f64>, engine: &str) -> PyResult<Self> {
        let place = |word: &str| {
            let names = SchemeName::ALL.map(SchemeName::name).join(", ");
            refused(bipenalty::error::Refusal::new(
                "limit",
                format!("{word:?}"),
                format!("spectrum, {names}"),
            ))
        };
        let scheme = match limit {
            "spectrum" => None,
            name => Some(name.parse::<SchemeName>().map_err(|_| place(name))?),
        };
        let name = scheme.map_or("spectrum", SchemeName::name);
        // Central differences have the limit of the spectrum.
        let scheme = scheme.filter(|scheme| *scheme != SchemeName::CentralDifference);
        if let Some(theta) = theta.filter(|_| scheme != Some(SchemeName::Park)) {
            let allowed = format!("none with the limit {name}, or limit = \"park\"");
            return Err(refused(bipenalty::error::Refusal::new("theta", theta, allowed)));
        }
        let engine = engine.parse().map_err(refused)?;
        Ok(Self { name, scheme, theta: theta.unwrap_or(0.5), engine })
    }

    fn is_quick(self, model: &Model) -> bool {
        self.scheme.is_none() && self.engine == EngineName::Auto && model.scene().elements() <= QUICK
    }
}

impl Inner {
    fn pencil(&self) -> &Pencil {
        self.pencil.get_or_init(|| self.model.pencil())
    }

    /// Refuses what the model has no such limit or engine for.
    fn check(&self, asked: Asked) -> PyResult<()> {
        match asked.scheme {
            None => self.model.check_engine(asked.engine).map_err(refused),
            Some(_) if asked.engine != EngineName::Auto => {
                let allowed = format!("auto with the limit {}", asked.name);
                Err(refused(bipenalty::error::Refusal::new("engine", asked.engine.text(), allowed)))
            }
            Some(_) => self.model.check_pencil().map_err(refused),
        }
    }

    /// Hands on the limit that is asked for.
    fn with_limit<R>(&self, asked: Asked, use_it: impl FnOnce(&dyn StepLimit) -> R) -> PyResult<R> {
        let find = || match (asked.scheme, asked.engine) {
            (Some(scheme), _) => self.model.limit(&*scheme.with_theta(asked.theta)?, self.pencil()),
            (None, EngineName::Auto) => Ok(Box::new(Spectrum(Box::new(self.model.auto()))) as _),
            (None, EngineName::ClosedForm) => Ok(Box::new(Spectrum(Box::new(self.model.closed_form()))) as _),
            (None, engine) => Ok(Box::new(Spectrum(self.model.engine(engine, self.pencil())?)) as _),
        };
        find().map(|limit: Box<dyn StepLimit + '_>| use_it(&*limit)).map_err(refused)
    }
}

/// A step and its enclosure, s; the same as Courant numbers; omega_max, rad/s; evidence; engine.
type StepTuple = ([f64; 3], [f64; 3], f64, &'static str, &'static str);

/// Seconds of a Courant number and its bounds, rounded outwards.
pub fn seconds(model: &Model, step: &CriticalStep) -> [f64; 3] {
    // A root and a quotient more than in C_r.
    let margin = 2.0 * f64::EPSILON;
    [
        model.time_step(step.critical_courant),
        model.time_step(step.lower) * (1.0 - margin),
        model.time_step(step.upper) * (1.0 + margin),
    ]
}

pub fn evidence(step: &CriticalStep) -> &'static str {
    match step.evidence {
        Evidence::LowerBound => "lower bound",
        Evidence::Proven | Evidence::Probability(_) => "proven",
    }
}

#[pymethods]
impl Core {
    /// The model of bars: a built-in name or a path.
    #[staticmethod]
    #[pyo3(signature = (scene, mass, elements, diagonalised))]
    fn from_scene(scene: &str, mass: f64, elements: Option<usize>, diagonalised: bool) -> PyResult<Self> {
        let scene = load(scene).map_err(failed)?;
        let scene = match elements {
            Some(elements) if elements <= MAX_ELEMENTS => scene.with_elements(elements).map_err(refused)?,
            Some(elements) => {
                let allowed = format!("an integer from 1 to {MAX_ELEMENTS}");
                return Err(refused(bipenalty::error::Refusal::new("elements", elements, allowed)));
            }
            None => scene,
        };
        let form = if diagonalised { PenaltyMass::Diagonalised } else { PenaltyMass::Consistent };
        let model = Model::new(scene, MassMatrix::new(mass).map_err(refused)?, form);
        let auto = model.auto();
        Ok(Self(Arc::new(Inner { model, auto, pencil: OnceLock::new() })))
    }

    /// Name, mass matrix, elements, unknowns, contacts, omega_ref^2.
    fn facts(&self) -> (String, String, usize, usize, usize, f64) {
        let model = &self.0.model;
        let (scene, contacts) = (model.scene(), model.scales().len());
        let fixed =
            [scene.left(), scene.right()].iter().filter(|end| **end == bipenalty::scene::End::Fixed).count();
        let unknowns = scene.elements() + scene.bars().len() - fixed;
        (
            scene.name().to_owned(),
            model.mass().name(),
            scene.elements(),
            unknowns,
            contacts,
            model.reference_eigenvalue(),
        )
    }

    #[pyo3(signature = (beta_s, ratio, limit, theta, engine))]
    fn critical_step(
        &self,
        py: Python<'_>,
        beta_s: f64,
        ratio: f64,
        limit: &str,
        theta: Option<f64>,
        engine: &str,
    ) -> PyResult<StepTuple> {
        let asked = Asked::new(limit, theta, engine)?;
        let (beta_s, ratio) =
            (StiffnessPenalty::new(beta_s).map_err(refused)?, Ratio::new(ratio).map_err(refused)?);
        let model = &self.0.model;
        model.check(beta_s, ratio).map_err(refused)?;
        self.0.check(asked)?;
        let (found, engine) = if asked.is_quick(model) {
            let (found, engine) = self.0.auto.enclose_by(&model.penalty(beta_s, ratio), None);
            (found.map(Step::proven), engine)
        } else {
            let inner = Arc::clone(&self.0);
            long(py, 1, None, move |_| {
                let penalty = inner.model.penalty(beta_s, ratio);
                inner.with_limit(asked, |limit| limit.enclose_by(&penalty, None))
            })??
        };
        let step = model.critical_step_of(found.map_err(uncertified)?);
        let courant = [step.critical_courant, step.lower, step.upper];
        Ok((seconds(model, &step), courant, step.omega_max, evidence(&step), engine))
    }

    #[pyo3(signature = (beta_s, ratio, limit, theta, engine, progress))]
    #[expect(clippy::too_many_arguments, reason = "the keywords of a Python method")]
    fn map(
        &self,
        py: Python<'_>,
        beta_s: PyReadonlyArray1<'_, f64>,
        ratio: PyReadonlyArray1<'_, f64>,
        limit: &str,
        theta: Option<f64>,
        engine: &str,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Map> {
        let asked = Asked::new(limit, theta, engine)?;
        let axis =
            |values: &PyReadonlyArray1<'_, f64>| bipenalty::stability::Axis::list(values.as_array().to_vec());
        let grid = Grid::new(&axis(&beta_s), &axis(&ratio)).map_err(refused)?;
        self.0.model.check_grid(&grid).map_err(refused)?;
        self.0.check(asked)?;
        grid.require_memory(Map::BYTES_PER_POINT).map_err(refused)?;
        let inner = Arc::clone(&self.0);
        let (points, shape) = (grid.len(), (grid.ratios.len(), grid.stiffness_penalties.len()));
        let curves = long(py, points, progress, move |watch: &Watch| {
            let done = |more| watch.add(more);
            inner.with_limit(asked, |limit| bipenalty::stability::map(&inner.model, &grid, limit, &done))
        })??;
        Ok(Map::new(self.0.model.clone(), curves, shape))
    }

    /// (value, lower, upper), or None where no ratio costs a step.
    #[pyo3(signature = (beta_s, limit, theta))]
    fn optimal_ratio(
        &self,
        py: Python<'_>,
        beta_s: f64,
        limit: &str,
        theta: Option<f64>,
    ) -> PyResult<Option<[f64; 3]>> {
        let asked = Asked::new(limit, theta, "auto")?;
        let beta_s = StiffnessPenalty::new(beta_s).map_err(refused)?;
        check_has_contact(&self.0.model).map_err(refused)?;
        self.0.model.check(beta_s, Ratio::OPTIMAL).map_err(refused)?;
        self.0.check(asked)?;
        let inner = Arc::clone(&self.0);
        let found = long(py, 1, None, move |_| {
            let search = |limit: &dyn StepLimit| -> Result<_, Uncertified> {
                match asked.scheme {
                    Some(_) => optimal_scheme_ratio(&inner.model, limit, beta_s),
                    None => {
                        let expected = Expectation::of(&inner.model, limit)?;
                        optimal_ratio(&inner.model, limit, &expected, beta_s)
                    }
                }
            };
            inner.with_limit(asked, search)
        })??;
        Ok(found.map_err(uncertified)?.map(|found| [found.value, found.lower, found.upper]))
    }

    /// (predicted, stable_at, unstable_at) s, (stable_at, unstable_at) Courant numbers, steps, growth, agrees.
    #[pyo3(signature = (beta_s, ratio, scheme, theta, tolerance))]
    #[expect(clippy::type_complexity, reason = "named in Python")]
    fn verify(
        &self,
        py: Python<'_>,
        beta_s: f64,
        ratio: f64,
        scheme: &str,
        theta: Option<f64>,
        tolerance: f64,
    ) -> PyResult<([f64; 3], [f64; 3], u64, f64, Option<bool>)> {
        let name: SchemeName = scheme.parse().map_err(refused)?;
        let stiffness_penalty = StiffnessPenalty::new(beta_s).map_err(refused)?;
        let point = Point { stiffness_penalty, ratio: Ratio::new(ratio).map_err(refused)? };
        let inner = Arc::clone(&self.0);
        let scheme = name.with_theta(theta.unwrap_or(0.5)).map_err(refused)?;
        let found = long(py, 1, None, move |_| {
            let predictor = Predictor::new(&inner.model, inner.pencil(), &*scheme)?;
            let predicted = predictor.at(point, tolerance)?;
            confirm(&inner.model, &*scheme, point, tolerance, Some(predicted))
        })?
        .map_err(refused)?;
        let predicted = found.predicted.as_ref().map_or(f64::NAN, |predicted| predicted.courant);
        let courants = [predicted, found.found.stable_at, found.found.unstable_at];
        let seconds = courants.map(|courant| self.0.model.time_step(courant));
        Ok((seconds, courants, found.found.steps, found.found.growth, found.agrees))
    }

    /// The arrays and numbers of a run by name.
    #[pyo3(signature = (scheme, theta, beta_s, ratio, relative_courant, duration, every, progress))]
    #[expect(clippy::too_many_arguments, reason = "the keywords of a Python method")]
    fn impact<'py>(
        &self,
        py: Python<'py>,
        scheme: &str,
        theta: Option<f64>,
        beta_s: f64,
        ratio: f64,
        relative_courant: f64,
        duration: Option<f64>,
        every: u64,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let scheme: SchemeName = scheme.parse().map_err(refused)?;
        let beta_s = StiffnessPenalty::new(beta_s).map_err(refused)?;
        let ratio = Ratio::new(ratio).map_err(refused)?;
        let run = || {
            let scheme = scheme.with_theta(theta.unwrap_or(0.5))?;
            let run = Run::new(self.0.model.clone(), scheme, beta_s, ratio)?;
            let run = run.with_relative_courant(relative_courant)?;
            duration.map_or(Ok(run.clone()), |duration| run.with_duration(duration))
        };
        impact::run(py, run().map_err(refused)?, every, progress)
    }

    /// Points (beta_s, r) where C_r takes a value: n x 2.
    fn contour<'py>(
        &self,
        py: Python<'py>,
        courant: f64,
        beta_s: (f64, f64),
        ratio: (f64, f64),
        limit: &str,
        theta: Option<f64>,
    ) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
        let asked = Asked::new(limit, theta, "auto")?;
        let points = match asked.scheme {
            None => bipenalty::stability::contour(&self.0.model, courant, beta_s, ratio).map_err(refused)?,
            Some(_) => self.0.with_limit(asked, |limit| {
                bipenalty::stability::scheme_contour(&self.0.model, limit, courant, beta_s, ratio)
            })?,
        };
        let flat: Vec<[f64; 2]> = points.into_iter().map(|(b, r)| [b, r]).collect();
        let array = flat.concat().to_pyarray(py);
        use numpy::PyArrayMethods as _;
        array.reshape([flat.len(), 2]).map_err(|e| PyValueError::new_err(e.to_string()))
    }
}
