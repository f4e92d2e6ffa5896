//! Matrices and meshes as models of the convex curve.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::asking::{Asking, LimitOf, Plan, Work};
use crate::convex::{self, Curve, Flexibilities, MeshPencil, Options, Start};
use crate::error::{Refusal, Result};
use crate::fem::MassMatrix;
use crate::matrices::{Matrices, Reference};
use crate::memory;
use crate::mesh::{Elements, MeshScene, Place};
use crate::pencil::{Gap, Matrix};
use crate::schemes::{Park, SchemeName};
use crate::sparse::{Csr, SparseVector};
use crate::stability::{EngineName, Grid, model};

/// What a scene of meshes knows beside its matrices.
#[derive(Debug)]
pub(super) struct Meshed {
    pub elements: Elements,
    pub places: Vec<Place>,
}

/// Matrices or meshes with their contacts.
///
/// What is asked narrows what is known: a later answer may have a narrower enclosure than the same question asked
/// first, and both hold.
#[derive(Debug)]
pub struct MeshModel {
    name: String,
    mass: Option<MassMatrix>,
    pencil: MeshPencil,
    given: Option<f64>,
    pub(super) meshed: Option<Meshed>,
    known: Mutex<Known>,
    /// The flexibilities of the last scheme that was asked for.
    pub(super) flexibilities: Mutex<Option<(Park, Flexibilities)>>,
}

/// What the prover of a curve depends on.
type Wanted = (Option<usize>, Option<u64>, Option<u64>);

/// What was computed so far.
#[derive(Debug, Default)]
struct Known {
    start: Option<Start>,
    /// The curve of the last prover that was asked for.
    curve: Option<(Wanted, Curve)>,
}

impl MeshModel {
    /// The model of K (N/m), M (kg), gaps, their scales w (N/m) and omega_ref^2 (rad^2/s^2), by default that of the
    /// contact-free matrices.
    ///
    /// # Errors
    /// As [`MeshPencil::new`]; scales that are not one for each gap; a reference that is not positive and finite.
    pub fn from_matrices(
        stiffness: Matrix,
        mass: Matrix,
        gaps: Vec<SparseVector>,
        scales: &[f64],
        reference: Option<f64>,
    ) -> Result<Self, Refusal> {
        if gaps.len() != scales.len() {
            let allowed = format!("{}, one for each gap", gaps.len());
            return Err(Refusal::new("scales", format!("{} values", scales.len()), allowed));
        }
        if let Some(reference) = reference.filter(|l| !(*l > 0.0 && l.is_finite())) {
            return Err(Refusal::new("reference", reference, "a positive finite number (rad^2/s^2)"));
        }
        let gap = |(column, scale): (SparseVector, &f64)| Gap { column, scale: *scale, initial: 0.0 };
        let contacts = gaps.into_iter().zip(scales).map(gap).collect();
        Ok(Self::of("matrices", None, MeshPencil::new(stiffness, mass, contacts)?, reference, None))
    }

    pub(super) fn of_matrices(name: &str, matrices: Matrices) -> Result<Self> {
        let reference = match matrices.reference {
            Reference::Mesh => None,
            Reference::OmegaSquared(l) => Some(l),
        };
        let stiffness = Matrix::Sparse(matrices.stiffness);
        let model =
            Self::from_matrices(stiffness, matrices.mass, matrices.gaps, &matrices.scales, reference)?;
        Ok(Self { name: name.to_owned(), ..model })
    }

    pub(super) fn of_mesh(scene: &MeshScene, mass: MassMatrix) -> Result<Self> {
        let assembled = scene.assemble(mass)?;
        let contacts = assembled.gaps();
        let places = assembled.contacts.into_iter().map(|contact| contact.place).collect();
        let pencil = MeshPencil::new(Matrix::Sparse(assembled.stiffness), assembled.mass, contacts)?;
        let meshed = Meshed { elements: assembled.elements, places };
        Ok(Self::of(&scene.name, Some(mass), pencil, None, Some(meshed)))
    }

    fn of(
        name: &str,
        mass: Option<MassMatrix>,
        pencil: MeshPencil,
        given: Option<f64>,
        meshed: Option<Meshed>,
    ) -> Self {
        Self {
            name: name.to_owned(),
            mass,
            pencil,
            given,
            meshed,
            known: Mutex::default(),
            flexibilities: Mutex::default(),
        }
    }

    /// The name of the scene.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The mass matrix of a mesh.
    pub fn mass(&self) -> Option<MassMatrix> {
        self.mass
    }

    /// K, M and the contacts.
    pub fn pencil(&self) -> &MeshPencil {
        &self.pencil
    }

    /// K, N/m, and M, kg, as sparse matrices; the gaps; their scales, N/m.
    pub fn matrices(&self) -> (&Matrix, &Matrix, &[Gap]) {
        (self.pencil.stiffness(), self.pencil.mass(), self.pencil.contacts())
    }

    /// Number of elements, where there is a mesh.
    pub fn elements(&self) -> Option<usize> {
        self.meshed.as_ref().map(|meshed| meshed.elements.len())
    }

    /// Where each contact is, where there is a mesh.
    pub fn places(&self) -> Option<&[Place]> {
        self.meshed.as_ref().map(|meshed| &*meshed.places)
    }

    /// The mesh of a scene of `[[body]]`.
    pub fn mesh(&self) -> Option<&Elements> {
        self.meshed.as_ref().map(|meshed| &meshed.elements)
    }

    /// omega_ref^2, rad^2/s^2: as given, or l_max(K, M) as computed, a lower bound of it. The same number whatever else is
    /// asked. Where the whole matrix is factorised, each enclosure is wide enough for the rest, some 1e-11, so that it holds
    /// for l_max(K, M) itself. Enclosures hold for the number alone where more than half of their width would be left: by patches, which
    /// prove it only as closely as they are large, and where two modes are nearer to each other than a vector tells, some 1e-9.
    ///
    /// # Errors
    /// A mass that is not positive definite; a factor of it that does not fit into memory; a stiffness that resists nothing.
    pub fn reference(&self) -> Result<f64, Refusal> {
        if let Some(reference) = self.given {
            return Ok(reference);
        }
        let mesh = self.start(&mut self.known(), &Asking::default())?.mesh();
        if mesh > 0.0 && mesh.is_finite() {
            return Ok(mesh);
        }
        let value = format!("l_max(K, M) = {mesh:e} rad^2/s^2");
        Err(Refusal::new(
            format!("scene {}, reference", self.name),
            value,
            "a stiffness that resists, or a number",
        ))
    }

    /// How far the reference of a mesh may lie above the number, relative.
    pub(super) fn reference_error(&self, curve: &Curve) -> f64 {
        if self.given.is_some() { 0.0 } else { curve.mesh_error() }
    }

    /// The same where a width has room for it; else enclosures hold for the number, as those by patches do. Half of it widens l, and half
    /// of it C_r.
    pub(super) fn counted_error(&self, curve: &Curve, room: f64) -> f64 {
        Some(self.reference_error(curve)).filter(|error| *error <= room).unwrap_or(0.0)
    }

    /// Refuses what does not apply.
    ///
    /// # Errors
    /// See [`AnyModel::check`](super::AnyModel::check).
    pub(super) fn check(&self, asking: &Asking) -> Result<(), Refusal> {
        if asking.engine != EngineName::Auto {
            let value = format!("{} with scene {}", asking.engine.text(), self.name);
            return Err(Refusal::new(
                "engine",
                value,
                "auto: matrices and meshes have one engine, the convex curve",
            ));
        }
        if let (Some(patch), None) = (asking.patch, &self.meshed) {
            let value = format!("{patch} with scene {}", self.name);
            return Err(Refusal::new(
                "patch",
                value,
                "none, or a scene of [[body]]: patches are made of elements",
            ));
        }
        let Some(scheme) = asking.limit.scheme() else { return Ok(()) };
        let name = scheme.facts().name;
        if scheme.as_park().is_some() {
            return self.check_park();
        }
        if name == SchemeName::PredictorCorrector.name() {
            return Ok(());
        }
        let value = format!("{name} with scene {}", self.name);
        let allowed = "spectrum, central-difference, predictor-corrector or park; or a scene of [[bar]]";
        Err(Refusal::new("limit", value, allowed))
    }

    pub(super) fn check_grid(&self, grid: &Grid) -> Result<(), Refusal> {
        let scales = || self.pencil.contacts().iter().map(|contact| contact.scale);
        let ends = [scales().reduce(f64::min), scales().reduce(f64::max)];
        model::check_grid(&ends.into_iter().flatten().collect::<Vec<_>>(), self.reference()?, grid)
    }

    /// Bytes that one factor may take.
    pub(super) fn allowed(asking: &Asking) -> usize {
        usize::try_from(asking.memory.unwrap_or_else(memory::available)).unwrap_or(usize::MAX)
    }

    /// Hands on the curve with the prover that is asked for.
    pub(super) fn with_curve<R>(
        &self,
        asking: &Asking,
        use_it: impl FnOnce(&mut Curve) -> Result<R, Refusal>,
    ) -> Result<R, Refusal> {
        let mut known = self.known();
        let wanted = (asking.patch, asking.memory, asking.tolerance.map(f64::to_bits));
        // The width matters to evidence by chance alone.
        let same = |(was, curve): &(Wanted, Curve)| {
            let chance = matches!(curve.prover(), convex::Prover::Chance(_));
            (was.0, was.1) == (wanted.0, wanted.1) && (!chance || was.2 == wanted.2)
        };
        let mut curve = match known.curve.take().filter(same) {
            Some((_, curve)) => curve,
            None => {
                let start = self.start(&mut known, asking)?.clone();
                Curve::begin(start, self.prover(asking)?.0, Self::options(asking))?
            }
        };
        // A curve that was interrupted is not kept.
        let used = use_it(&mut curve);
        known.curve = Some((wanted, curve));
        used
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        // What is known after a panic is as good as before: it is proven point by point.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn start<'a>(&self, known: &'a mut Known, asking: &Asking) -> Result<&'a Start, Refusal> {
        let start = match known.start.take() {
            Some(start) => start,
            None => Start::new(&self.pencil, &Self::options(asking))?,
        };
        Ok(known.start.insert(start))
    }

    fn options(asking: &Asking) -> Options {
        Options { memory: Self::allowed(asking), ..Options::default() }
    }

    pub(super) fn plan(&self, points: usize, asking: &Asking) -> Result<Plan, Refusal> {
        let (prover, named) = self.prover(asking)?;
        let contacts = self.pencil.contacts().len();
        let width = asking.width(points);
        // A map takes as many proofs as chords between proven points need, which is as 1/sqrt(width): 10, 24, 69 and 231 on
        // two blocks for 1e-2 to 1e-5; vectors err by the fourth power of their distance.
        let several = |one: f64| if contacts == 0 { 1 } else { (one as usize + 2).min(2 * points + 2) };
        let scheme = matches!(&asking.limit, LimitOf::Scheme(_)) && asking.limit.scheme().is_some();
        let (eigenproblems, proofs) =
            if scheme { (2, 2) } else { (several(4.0 - 1.5 * width.log10()), several(0.75 / width.sqrt())) };
        // Chords between flexibilities err as those between proofs do; a point takes some ten.
        let park = asking.limit.scheme().is_some_and(|scheme| scheme.as_park().is_some());
        let flexibilities = if park { ((2.5 / width.sqrt()) as usize).min(12 * points) } else { 0 };
        Ok(Plan {
            unknowns: self.pencil.size(),
            contacts,
            elements: self.elements(),
            points,
            tolerance: Some(width),
            engine: super::curve::engine(&prover),
            work: match (&prover, self.pencil.stiffness()) {
                (convex::Prover::Whole(whole), Matrix::Sparse(k)) => Some(Work {
                    operations: whole.operations(),
                    factor: whole.memory() / size_of::<f64>(),
                    stiffness: k.len(),
                }),
                _ => None,
            },
            memory: Some(self.bytes(&prover)),
            prover: Some(named),
            eigenproblems,
            proofs,
            flexibilities,
        })
    }

    /// The matrices by rows, as many vectors as a search holds, the pattern of K, M and P together, and the factor.
    fn bytes(&self, prover: &convex::Prover) -> u64 {
        let stored = |matrix: &Matrix| match matrix {
            Matrix::Sparse(a) => csr_bytes(a),
            Matrix::Chain(_) | Matrix::Diagonal(_) => 16 * matrix.size(),
        };
        let matrices = stored(self.pencil.stiffness()) + stored(self.pencil.mass());
        let vectors = 8 * self.pencil.size() * 2 * Options::default().basis;
        (matrices + vectors + prover.memory()) as u64
    }
}

fn csr_bytes(matrix: &Csr) -> usize {
    12 * matrix.len() + 8 * matrix.rows()
}
