//! One face for models of any kind: bars by their own engines, matrices and meshes by the convex curve.

mod asking;
mod curve;
mod governing;
mod largest;
mod mesh;
mod optimal;
mod park;
mod prover;
mod scene;
mod stepping;
mod transformed;

pub use asking::{Asking, LimitOf, Plan, Prover, Work};
pub use governing::{ContactShare, Governing};
pub use largest::{Largest, eigenvalue};
pub use mesh::MeshModel;
pub use scene::AnyScene;

use std::cell::OnceCell;

use super::{Curve, EngineName, Grid, MapPoint, Model, map};
use crate::damping::DampedLimit;
use crate::error::{Refusal, Result};
use crate::fem::{MassMatrix, pencil_bytes};
use crate::penalty::{PenaltyMass, Ratio, StiffnessPenalty};
use crate::pencil::Penalty;
use crate::spectrum::{Engine, Spectrum, StepLimit};

/// A model of bars, or of matrices or meshes.
///
/// ```
/// use bipenalty::penalty::PenaltyMass;
/// use bipenalty::stability::{AnyModel, AnyScene, Asking};
/// let text = r#"
/// name = "block"
/// dimension = 2
/// plane = "strain"
/// [[body]]
/// name = "block"
/// box = [2.0, 1.0]
/// cells = [4, 2]
/// element = "quad4"
/// youngs_modulus = 1.0
/// poissons_ratio = 0.3
/// density = 1.0
/// [[contact]]
/// surfaces = ["block.bottom", "wall"]
/// "#;
/// let model = AnyModel::new(&AnyScene::parse(text, "block.toml")?, None, PenaltyMass::Consistent)?;
/// let pure = model.critical_step(1e4, f64::INFINITY, &Asking::default())?.step?;
/// let optimal = model.critical_step(1e4, 1.0, &Asking::default())?.step?;
/// // In units of the contact-free step: r = 1 costs nothing.
/// assert!(pure.upper < 0.02 && optimal.lower > 0.999_999);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub enum AnyModel {
    /// Bars.
    Bars(Model),
    /// Matrices or meshes.
    Mesh(Box<MeshModel>),
}

impl AnyModel {
    /// The model of a scene with a mass matrix, by default lumped. Matrices are read, meshes assembled.
    ///
    /// # Errors
    /// A mass matrix for a scene of `[matrices]`, which has one; the diagonalised mass penalty for what is no row of bars;
    /// what reading and assembling refuse.
    pub fn new(scene: &AnyScene, mass: Option<MassMatrix>, form: PenaltyMass) -> Result<Self> {
        if form == PenaltyMass::Diagonalised && !matches!(scene, AnyScene::Bars(_)) {
            let value = format!("diagonalised with scene {}", scene.name());
            return Err(Refusal::new("penalty mass", value, "consistent, or a scene of [[bar]]").into());
        }
        match (scene, mass) {
            (AnyScene::Bars(scene), mass) => {
                Ok(Self::Bars(Model::new(scene.clone(), mass.unwrap_or(MassMatrix::LUMPED), form)))
            }
            (AnyScene::Matrices(scene), None) => {
                Ok(Self::Mesh(Box::new(MeshModel::of_matrices(&scene.name, scene.read()?)?)))
            }
            (AnyScene::Matrices(scene), Some(mass)) => {
                let value = format!("{} with scene {}", mass.name(), scene.name);
                Err(Refusal::new("mass", value, "none: a scene of [matrices] brings its mass").into())
            }
            (AnyScene::Mesh(scene), mass) => {
                let mass = mass.unwrap_or(MassMatrix::LUMPED);
                Ok(Self::Mesh(Box::new(MeshModel::of_mesh(scene, mass)?)))
            }
        }
    }

    /// The name of the scene.
    pub fn name(&self) -> &str {
        match self {
            Self::Bars(model) => model.scene().name(),
            Self::Mesh(model) => model.name(),
        }
    }

    /// The mass matrix; none where matrices bring their own.
    pub fn mass(&self) -> Option<MassMatrix> {
        match self {
            Self::Bars(model) => Some(model.mass()),
            Self::Mesh(model) => model.mass(),
        }
    }

    /// Elements of all bars or bodies, where they are known.
    pub fn elements(&self) -> Option<usize> {
        match self {
            Self::Bars(model) => Some(model.scene().elements()),
            Self::Mesh(model) => model.elements(),
        }
    }

    /// Number of contacts.
    pub fn contacts(&self) -> usize {
        match self {
            Self::Bars(model) => model.scales().len(),
            Self::Mesh(model) => model.pencil().contacts().len(),
        }
    }

    /// The smallest scale of the contacts, N/m: with beta_s every contact has at least the stiffness beta_s times this. `None`
    /// without contacts.
    pub fn smallest_scale(&self) -> Option<f64> {
        match self {
            Self::Bars(model) => model.scales().iter().map(|scale| scale.stiffness).reduce(f64::min),
            Self::Mesh(model) => {
                model.pencil().contacts().iter().map(|contact| contact.scale).reduce(f64::min)
            }
        }
    }

    /// omega_ref^2, rad^2/s^2, in which the ratio is measured: of the elements at contacts for bars; of the contact-free
    /// mesh as [`MeshModel::reference`] has it, or as given.
    ///
    /// # Errors
    /// As [`MeshModel::reference`].
    pub fn reference(&self) -> Result<f64, Refusal> {
        match self {
            Self::Bars(model) => Ok(model.reference_eigenvalue()),
            Self::Mesh(model) => model.reference(),
        }
    }

    /// dt in s of the `critical_courant` of this model.
    ///
    /// # Errors
    /// As [`MeshModel::reference`].
    pub fn time_step(&self, critical_courant: f64) -> Result<f64, Refusal> {
        match self {
            Self::Bars(model) => Ok(model.time_step(critical_courant)),
            Self::Mesh(model) => Ok(2.0 * critical_courant / model.reference()?.sqrt()),
        }
    }

    /// Refuses what does not apply to this model.
    ///
    /// # Errors
    /// What [`Asking::check`], [`Model::check_engine`] and [`Model::limit`] refuse; patches of bars; an engine of bars and
    /// limits of schemes that are not derived for meshes.
    pub fn check(&self, asking: &Asking) -> Result<(), Refusal> {
        asking.check()?;
        match self {
            Self::Mesh(model) => model.check(asking),
            Self::Bars(model) => {
                if let Some(patch) = asking.patch {
                    let value = format!("{patch} with scene {}", self.name());
                    return Err(Refusal::new("patch", value, "none: bars are proven as they are found"));
                }
                if matches!(asking.limit, LimitOf::Damped(_)) {
                    model.check_pencil()?;
                }
                match asking.limit.scheme() {
                    None => model.check_engine(asking.engine),
                    Some(scheme) if asking.engine != EngineName::Auto => {
                        let allowed = format!("auto with the limit of {}", scheme.facts().name);
                        Err(Refusal::new("engine", asking.engine.text(), allowed))
                    }
                    Some(_) => model.check_pencil(),
                }
            }
        }
    }

    /// Refuses a grid whose penalties f64 cannot hold.
    ///
    /// # Errors
    /// As [`Model::check_grid`].
    pub fn check_grid(&self, grid: &Grid) -> Result<(), Refusal> {
        match self {
            Self::Bars(model) => model.check_grid(grid),
            Self::Mesh(model) => model.check_grid(grid),
        }
    }

    /// What will be done for so many points.
    ///
    /// # Errors
    /// As [`AnyModel::check`].
    pub fn plan(&self, points: usize, asking: &Asking) -> Result<Plan, Refusal> {
        self.check(asking)?;
        match self {
            Self::Mesh(model) => model.plan(points, asking),
            Self::Bars(model) => {
                let needs_pencil = asking.limit.scheme().is_some() || asking.engine.needs_pencil();
                Ok(Plan {
                    unknowns: model.scene().elements() + model.scene().bars().len(),
                    contacts: model.scales().len(),
                    elements: Some(model.scene().elements()),
                    points,
                    tolerance: None,
                    engine: asking.engine.text(),
                    prover: None,
                    eigenproblems: points,
                    proofs: points,
                    flexibilities: 0,
                    work: None,
                    memory: needs_pencil.then(|| pencil_bytes(model.scene())),
                })
            }
        }
    }

    /// The limit over a grid, curve by curve; `done` is told of points as they are finished.
    ///
    /// # Errors
    /// As [`AnyModel::check`] and [`AnyModel::check_grid`]; a mass that is not definite, a factor that does not fit.
    pub fn map(
        &self,
        grid: &Grid,
        asking: &Asking,
        done: &(dyn Fn(usize) + Sync),
    ) -> Result<Vec<Curve>, Refusal> {
        self.check(asking)?;
        self.check_grid(grid)?;
        if let LimitOf::Explicit(scheme) = &asking.limit {
            return Ok(transformed::lengthened(self.map(grid, &asking.of_spectrum(), done)?, scheme));
        }
        match self {
            Self::Bars(model) => with_limit(model, asking, |limit| Ok(map(model, grid, limit, done))),
            Self::Mesh(model) => {
                let curves = model.map(grid, asking)?;
                done(grid.len());
                Ok(curves)
            }
        }
    }

    /// The limit at one point.
    ///
    /// # Errors
    /// As [`AnyModel::map`], and penalties that are none.
    pub fn critical_step(&self, beta_s: f64, ratio: f64, asking: &Asking) -> Result<MapPoint, Refusal> {
        let (beta_s, ratio) = (StiffnessPenalty::new(beta_s)?, Ratio::new(ratio)?);
        let grid = Grid { stiffness_penalties: vec![beta_s], ratios: vec![ratio] };
        let found = self.map(&grid, asking, &|_| ())?;
        // One ratio and one penalty make one curve of one point.
        let point = found.first().and_then(|curve| curve.points.first());
        point.copied().ok_or_else(|| Refusal::new("grid", "no point", "one"))
    }

    /// The limit without contact.
    ///
    /// # Errors
    /// As [`AnyModel::map`].
    pub fn contact_free(&self, asking: &Asking) -> Result<MapPoint, Refusal> {
        self.critical_step(0.0, f64::INFINITY, asking)
    }

    /// The penalty of all contacts, closed.
    ///
    /// # Errors
    /// As [`MeshModel::reference`].
    pub fn penalty(&self, beta_s: StiffnessPenalty, ratio: Ratio) -> Result<Penalty, Refusal> {
        match self {
            Self::Bars(model) => Ok(model.penalty(beta_s, ratio)),
            Self::Mesh(model) => Ok(Penalty {
                stiffness: beta_s.get(),
                rate: ratio.get() * model.reference()?,
                form: PenaltyMass::Consistent,
            }),
        }
    }
}

/// Hands on the limit of bars that is asked for.
///
/// # Errors
/// As [`Model::engine`] and [`Model::limit`], and what `use_it` refuses.
pub fn with_limit<R>(
    model: &Model,
    asking: &Asking,
    use_it: impl FnOnce(&dyn StepLimit) -> Result<R, Refusal>,
) -> Result<R, Refusal> {
    if let Some(scheme) = asking.limit.scheme() {
        let pencil = model.pencil();
        return use_it(&*model.limit(scheme, &pencil)?);
    }
    // Assembled where it is needed: it has the size of the mesh.
    let assembled = OnceCell::new();
    let pencil = || assembled.get_or_init(|| model.pencil());
    let engine: Box<dyn Engine> = match asking.engine {
        EngineName::Auto => Box::new(model.auto()),
        EngineName::ClosedForm => Box::new(model.closed_form()),
        other => model.engine(other, pencil())?,
    };
    match &asking.limit {
        LimitOf::Explicit(scheme) => use_it(&scheme.limit(engine)),
        LimitOf::Damped(damping) => use_it(&DampedLimit::new(pencil(), engine, *damping)),
        LimitOf::Spectrum | LimitOf::Scheme(_) => use_it(&Spectrum(engine)),
    }
}
