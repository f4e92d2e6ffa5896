//! A model, and what is asked of it.

use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use bipenalty::error::Refusal;
use bipenalty::fem::MassMatrix;
use bipenalty::matrices::{Matrices, Reference};
use bipenalty::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use bipenalty::pencil::Matrix;
use bipenalty::schemes::Onset;
use bipenalty::spectrum::{Engine as _, Evidence, Step};
use bipenalty::stability::{
    AnyModel, AnyScene, Asking, Auto, ContactShare, CriticalStep, EngineName, Grid, MapPoint, MeshModel,
    Sweep,
};
use bipenalty::verify::PenaltyPoint;
use numpy::{IntoPyArray as _, PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{MassOrRows, Parts, Rows, fingerprint, parts};
use crate::asked::{Asked, SchemeAsked};
use crate::map::Map;
use crate::stepped::{SteppedTuple, stepped};
use crate::work::{Watch, long};
use crate::{failed, impact, refused, uncertified};

/// Points of bars with no more elements are found where they are asked: even by bisection they take less than the time
/// between two looks for Ctrl-C.
const QUICK: usize = 50_000;

/// A model as the Python package holds it.
#[pyclass(frozen, module = "bipenalty._bipenalty")]
pub struct Core {
    model: Arc<AnyModel>,
    /// The engine `auto` of bars.
    auto: Option<Auto>,
    /// Of matrices that are shared with arrays.
    fingerprint: Option<u64>,
    /// That the model was made of, if it was.
    scene: Option<AnyScene>,
    /// As many as computations that use the model, and one.
    users: Arc<()>,
    /// The process that asked last.
    process: AtomicU32,
}

/// A model in use by a computation, which may go on when nobody waits for it any more.
pub struct InUse {
    model: Arc<AnyModel>,
    _user: Arc<()>,
}

impl Deref for InUse {
    type Target = AnyModel;

    fn deref(&self) -> &AnyModel {
        &self.model
    }
}

/// A step and its enclosure, s; the same as Courant numbers; omega_max, rad/s; evidence; engine.
type StepTuple = ([f64; 3], [f64; 3], f64, String, &'static str);

/// Part in the contacts; contacts, bodies and elements with their parts; mode.
type GovernsTuple<'py> = (
    f64,
    Vec<(usize, f64, Option<String>)>,
    Vec<(String, f64)>,
    Vec<(usize, f64)>,
    Bound<'py, PyArray1<f64>>,
);

impl Core {
    fn new(model: AnyModel) -> Self {
        let auto = match &model {
            AnyModel::Bars(model) => Some(model.auto()),
            AnyModel::Mesh(_) => None,
        };
        let (users, process) = (Arc::new(()), AtomicU32::new(std::process::id()));
        Self { model: Arc::new(model), auto, fingerprint: None, scene: None, users, process }
    }

    /// The model, whose shared arrays are what they were. Called with the interpreter's lock: one thread at a time.
    ///
    /// # Errors
    /// Arrays that were changed; a process that was forked while a computation used the model, which it would wait for.
    fn model(&self) -> PyResult<InUse> {
        let here = std::process::id();
        if self.process.load(Ordering::Relaxed) != here {
            if Arc::strong_count(&self.users) > 1 {
                let value = "asked in a process that was forked while a thread of its parent used the model";
                let allowed =
                    "a model that is made in this process, or the start methods spawn and forkserver";
                return Err(refused(Refusal::new("model", value, allowed)));
            }
            self.process.store(here, Ordering::Relaxed);
        }
        if let (Some(seen), AnyModel::Mesh(model)) = (self.fingerprint, &*self.model)
            && fingerprint(&[model.pencil().stiffness(), model.pencil().mass()]) != seen
        {
            let allowed = "entries as they were when the model was made: make a new model, or give it a copy";
            return Err(refused(Refusal::new("stiffness, mass", "an array that was changed", allowed)));
        }
        Ok(InUse { model: Arc::clone(&self.model), _user: Arc::clone(&self.users) })
    }

    /// The point of bars that costs a microsecond.
    fn quick(&self, beta_s: f64, ratio: f64, asking: &Asking) -> PyResult<Option<MapPoint>> {
        let (AnyModel::Bars(model), Some(auto)) = (&*self.model, &self.auto) else { return Ok(None) };
        let usual = asking.limit.is_spectrum() && asking.engine == EngineName::Auto;
        if !usual || model.scene().elements() > QUICK {
            return Ok(None);
        }
        let stiffness_penalty = StiffnessPenalty::new(beta_s).map_err(refused)?;
        let ratio = Ratio::new(ratio).map_err(refused)?;
        self.model.check(asking).map_err(refused)?;
        model.check(stiffness_penalty, ratio).map_err(refused)?;
        let (found, engine) = auto.enclose_by(&model.penalty(stiffness_penalty, ratio), None);
        let step = found.map(|l| model.critical_step_of(Step::proven(l)));
        Ok(Some(MapPoint { stiffness_penalty, step, engine }))
    }
}

/// What stands behind a step, in a word.
pub fn evidence(step: &CriticalStep) -> String {
    match step.evidence {
        Evidence::Proven => "proven".to_owned(),
        Evidence::LowerBound => "lower bound".to_owned(),
        Evidence::Probability(probability) => format!("{probability:e}"),
    }
}

/// dt of a point and its bounds, s, rounded outwards; NaN where nothing is certified.
///
/// # Errors
/// As [`AnyModel::time_step`].
pub fn seconds(model: &AnyModel, point: &MapPoint) -> Result<[f64; 3], Refusal> {
    let Ok(step) = point.step else { return Ok([f64::NAN; 3]) };
    let of = |courant: f64| model.time_step(courant);
    // A root and a quotient more than in C_r.
    let margin = 2.0 * f64::EPSILON;
    Ok([of(step.critical_courant)?, of(step.lower)? * (1.0 - margin), of(step.upper)? * (1.0 + margin)])
}

#[pymethods]
impl Core {
    /// The model of a scene: a built-in name, a path, or TOML called `path`.
    #[staticmethod]
    #[pyo3(signature = (scene, text, mass, elements, diagonalised))]
    fn from_scene(
        py: Python<'_>,
        scene: String,
        text: Option<String>,
        mass: Option<f64>,
        elements: Option<usize>,
        diagonalised: bool,
    ) -> PyResult<Self> {
        let mass = mass.map(MassMatrix::new).transpose().map_err(refused)?;
        let form = if diagonalised { PenaltyMass::Diagonalised } else { PenaltyMass::Consistent };
        let model = long(py, 1, None, move |_| {
            let scene = match text {
                Some(text) => AnyScene::parse(&text, &scene)?,
                None => AnyScene::load(&scene)?,
            };
            let scene = elements.map_or(Ok(scene.clone()), |elements| scene.with_elements(elements))?;
            let model = AnyModel::new(&scene, mass, form)?;
            Ok((model, scene))
        })?;
        let (model, scene) = model.map_err(failed)?;
        Ok(Self { scene: Some(scene), ..Self::new(model) })
    }

    /// The model of matrices that are in memory; a reference of None is that of the mesh.
    #[staticmethod]
    #[pyo3(signature = (stiffness, mass, gaps, scales, reference))]
    fn from_matrices(
        py: Python<'_>,
        stiffness: Rows<'_>,
        mass: MassOrRows<'_>,
        gaps: Rows<'_>,
        scales: Option<Vec<f64>>,
        reference: Option<f64>,
    ) -> PyResult<Self> {
        let stiffness = stiffness.matrix("stiffness")?;
        let gaps = gaps.gaps(stiffness.rows())?;
        let mass = match mass {
            MassOrRows::Diagonal(diagonal) => Matrix::Diagonal(diagonal.as_array().to_vec()),
            MassOrRows::Rows(rows) => rows.mass()?,
        };
        let model = long(py, 1, None, move |_| {
            let reference = reference.map_or(Reference::Mesh, Reference::OmegaSquared);
            let m = Matrices::new(stiffness, mass, gaps, scales, reference)?;
            let given = match m.reference {
                Reference::Mesh => None,
                Reference::OmegaSquared(l) => Some(l),
            };
            let model =
                MeshModel::from_matrices(Matrix::Sparse(m.stiffness), m.mass, m.gaps, &m.scales, given)?;
            let seal = fingerprint(&[model.pencil().stiffness(), model.pencil().mass()]);
            Ok((model, seal))
        })?;
        let (model, seal) = model.map_err(refused)?;
        Ok(Self { fingerprint: Some(seal), ..Self::new(AnyModel::Mesh(Box::new(model))) })
    }

    /// Name, mass matrix and gamma, elements, unknowns, contacts.
    fn facts(&self) -> (String, Option<(String, f64)>, Option<usize>, usize, usize) {
        let model = &*self.model;
        let unknowns = match model {
            AnyModel::Bars(model) => bipenalty::impact::Mesh::new(model.scene()).nodes(),
            AnyModel::Mesh(model) => model.pencil().size(),
        };
        let mass = model.mass().map(|mass| (mass.name(), mass.gamma()));
        (model.name().to_owned(), mass, model.elements(), unknowns, model.contacts())
    }

    /// The smallest scale of the contacts, N/m.
    fn smallest_scale(&self) -> Option<f64> {
        self.model.smallest_scale()
    }

    /// omega_ref^2, rad^2/s^2.
    fn reference(&self, py: Python<'_>) -> PyResult<f64> {
        let model = self.model()?;
        long(py, 1, None, move |_| model.reference())?.map_err(refused)
    }

    fn critical_step(&self, py: Python<'_>, beta_s: f64, ratio: f64, asked: Asked) -> PyResult<StepTuple> {
        let asking = asked.asking()?;
        let (point, seconds) = match self.quick(beta_s, ratio, &asking)? {
            Some(point) => (point, seconds(&self.model, &point).map_err(refused)?),
            None => {
                let model = self.model()?;
                let find = move |_: &Watch| {
                    let point = model.critical_step(beta_s, ratio, &asking)?;
                    Ok((point, seconds(&model, &point)?))
                };
                long(py, 1, None, find)?.map_err(refused)?
            }
        };
        let step = point.step.map_err(uncertified)?;
        let courant = [step.critical_courant, step.lower, step.upper];
        Ok((seconds, courant, step.omega_max, evidence(&step), point.engine))
    }

    fn map(
        &self,
        py: Python<'_>,
        beta_s: PyReadonlyArray1<'_, f64>,
        ratio: PyReadonlyArray1<'_, f64>,
        asked: Asked,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Map> {
        let asking = asked.asking()?;
        let axis = |values: &PyReadonlyArray1<'_, f64>| Sweep::list(values.as_array().to_vec());
        let grid = Grid::new(&axis(&beta_s), &axis(&ratio)).map_err(refused)?;
        grid.require_memory(Map::BYTES_PER_POINT).map_err(refused)?;
        let model = self.model()?;
        let (points, shape) = (grid.len(), [grid.ratios.len(), grid.stiffness_penalties.len()]);
        let find = move |watch: &Watch| {
            let begun = Instant::now();
            let curves = model.map(&grid, &asking, &|more| watch.add(more));
            (curves, begun.elapsed().as_secs_f64())
        };
        let (curves, seconds) = long(py, points, progress, find)?;
        Ok(Map::new(Arc::clone(&self.model), curves.map_err(refused)?, shape, seconds))
    }

    /// (value, lower, upper), or None where no ratio costs a step.
    fn optimal_ratio(&self, py: Python<'_>, beta_s: f64, asked: Asked) -> PyResult<Option<[f64; 3]>> {
        let (asking, model) = (asked.asking()?, self.model()?);
        let found = long(py, 1, None, move |_| model.optimal_ratio(beta_s, &asking))?.map_err(failed)?;
        Ok(found.map(|found| [found.value, found.lower, found.upper]))
    }

    /// The largest beta_s that `time_step`, s, stands with a ratio: (value, lower, upper); None where it is beyond the
    /// contact-free limit.
    fn largest_penalty(
        &self,
        py: Python<'_>,
        time_step: f64,
        ratio: f64,
        asked: Asked,
    ) -> PyResult<Option<[f64; 3]>> {
        let (asking, model) = (asked.asking()?, self.model()?);
        let find = move |_: &Watch| model.largest_penalty(time_step, ratio, &asking);
        Ok(long(py, 1, None, find)?.map_err(failed)?.map(|found| [found.value, found.lower, found.upper]))
    }

    /// The largest ratio that `time_step`, s, stands with a beta_s, as [`Core::largest_penalty`].
    fn largest_ratio(
        &self,
        py: Python<'_>,
        time_step: f64,
        beta_s: f64,
        asked: Asked,
    ) -> PyResult<Option<[f64; 3]>> {
        let (asking, model) = (asked.asking()?, self.model()?);
        let find = move |_: &Watch| model.largest_ratio(time_step, beta_s, &asking);
        Ok(long(py, 1, None, find)?.map_err(failed)?.map(|found| [found.value, found.lower, found.upper]))
    }

    /// Who governs the step of the spectrum: the part of the contacts in the elastic energy, the contacts with their parts
    /// and places, the bodies and the elements with theirs, and the mode.
    fn governs<'py>(
        &self,
        py: Python<'py>,
        beta_s: f64,
        ratio: f64,
        asked: Asked,
    ) -> PyResult<GovernsTuple<'py>> {
        let (asking, model) = (asked.asking()?, self.model()?);
        let find = move |_: &Watch| model.governs(beta_s, ratio, &asking);
        let found = long(py, 1, None, find)?.map_err(failed)?;
        let contact = |contact: ContactShare| {
            (contact.contact, contact.share, contact.place.map(|place| place.to_string()))
        };
        let contacts = found.contacts.into_iter().map(contact).collect();
        let mode = found.mode.into_pyarray(py);
        Ok((found.contact_energy, contacts, found.bodies, found.elements, mode))
    }

    /// (predicted, stable_at, unstable_at) s, steps, growth, agrees; `asked` is the limit of the scheme that steps.
    #[pyo3(signature = (beta_s, ratio, scheme, asked))]
    fn verify(
        &self,
        py: Python<'_>,
        beta_s: f64,
        ratio: f64,
        scheme: SchemeAsked,
        asked: Asked,
    ) -> PyResult<SteppedTuple> {
        let (model, scheme) = (self.model()?, scheme.scheme()?);
        let Asking { limit, tolerance, .. } = asked.asking()?;
        // As verify-limits has them: trials of some 1e4 and 1e6 steps.
        let usual = if scheme.facts().onset == Onset::SquareRoot { 1e-6 } else { 1e-4 };
        let tolerance = tolerance.unwrap_or(usual);
        let stiffness_penalty = StiffnessPenalty::new(beta_s).map_err(refused)?;
        let point = PenaltyPoint { stiffness_penalty, ratio: Ratio::new(ratio).map_err(refused)? };
        long(py, 1, None, move |_| stepped(&model, &scheme, limit, point, tolerance))?.map_err(failed)
    }

    /// The arrays and numbers of a run by name.
    #[pyo3(signature = (scheme, pace, start, progress))]
    fn impact<'py>(
        &self,
        py: Python<'py>,
        scheme: SchemeAsked,
        pace: impact::Pace,
        start: impact::AtStart<'py>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let thrown = (self.model()?, self.scene.clone());
        impact::run(py, thrown, scheme.scheme()?, (pace, start), progress)
    }

    /// Points (beta_s, r) where C_r takes a value: n x 2.
    fn contour<'py>(
        &self,
        py: Python<'py>,
        courant: f64,
        beta_s: (f64, f64),
        ratio: (f64, f64),
        asked: Asked,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (asking, model) = (asked.asking()?, self.model()?);
        let find = move |_: &Watch| model.contour(courant, beta_s, ratio, &asking);
        let points = long(py, 1, None, find)?.map_err(refused)?;
        let flat: Vec<f64> = points.iter().flat_map(|(b, r)| [*b, *r]).collect();
        flat.into_pyarray(py).reshape([points.len(), 2])
    }

    /// K, M and Z as (starts, columns, values, shape) of their rows, and w, N/m.
    fn matrices<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        match &*self.model()? {
            AnyModel::Bars(model) => {
                model.check_pencil().map_err(refused)?;
                let pencil = model.pencil();
                Ok(parts(py, pencil.stiffness(), pencil.mass(), pencil.gaps()))
            }
            AnyModel::Mesh(model) => {
                let (stiffness, mass, gaps) = model.matrices();
                Ok(parts(py, stiffness, mass, gaps))
            }
        }
    }
}
