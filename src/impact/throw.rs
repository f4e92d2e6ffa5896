//! Scenes of any kind as encounters.

use super::encounter::{of_unknowns, weight};
use super::{Encounter, Exact};
use crate::error::{Refusal, Result};
use crate::pencil::Gap;
use crate::spectrum::Uncertified;
use crate::stability::{AnyModel, AnyScene, Asking, MeshModel};

impl Encounter {
    /// The bodies of `scene` as they are thrown at each other; `model` is a model of this scene. Its critical step is a proven
    /// lower bound of 2/omega_max without contact. Without `[impact]` nothing pulls, and matrices are at rest.
    ///
    /// # Errors
    /// A contact-free limit that is not enclosed; what reading the files of `[impact]` refuses.
    pub fn of_scene(scene: &AnyScene, model: &AnyModel) -> Result<Self> {
        match (scene, model) {
            (AnyScene::Mesh(scene), AnyModel::Mesh(mesh)) => {
                let Some(elements) = mesh.mesh() else { return Err(stranger(model).into()) };
                let gravity = scene.impact.as_ref().map_or([0.0; 3], |impact| impact.gravity);
                let (pencil, step) = stepping(model, mesh)?;
                let velocity = of_unknowns(elements, |body| elements.bodies[body].velocity);
                let load = match gravity == [0.0; 3] {
                    true => Vec::new(),
                    false => weight(&pencil, &of_unknowns(elements, |_| gravity)),
                };
                Ok(Self::new(pencil, velocity, load, step)?)
            }
            (AnyScene::Matrices(scene), AnyModel::Mesh(mesh)) => {
                let rest = Self::at_rest(model, mesh)?;
                let Some(impact) = &scene.impact else { return Ok(rest) };
                let throw = impact.read(rest.pencil.size(), rest.pencil.gaps().len())?;
                let thrown = rest.with_velocity(throw.velocity)?.with_load(throw.load)?;
                Ok(thrown.with_gaps(&throw.gaps)?)
            }
            (AnyScene::Bars(_), AnyModel::Bars(bars)) => Ok(Self::of_bars(bars)?),
            _ => Err(stranger(model).into()),
        }
    }

    /// What a model without a scene is: bars as theirs has them thrown, matrices at rest with nothing that pulls.
    ///
    /// # Errors
    /// A contact-free limit that is not enclosed.
    pub fn of_model(model: &AnyModel) -> Result<Self> {
        match model {
            AnyModel::Bars(bars) => Ok(Self::of_bars(bars)?),
            AnyModel::Mesh(mesh) => Self::at_rest(model, mesh),
        }
    }

    fn at_rest(model: &AnyModel, mesh: &MeshModel) -> Result<Self> {
        let (pencil, step) = stepping(model, mesh)?;
        let rest = vec![0.0; pencil.size()];
        Ok(Self::new(pencil, rest, Vec::new(), step)?)
    }
}

fn stranger(model: &AnyModel) -> Refusal {
    Refusal::new("model", model.name(), "the model of the scene")
}

/// K, M and the contacts with their gaps, and the contact-free step, s.
fn stepping(model: &AnyModel, mesh: &MeshModel) -> Result<(crate::pencil::Pencil, f64)> {
    let uncertified = |error: Uncertified| {
        Refusal::new(format!("scene {}", model.name()), error, "scenes whose contact-free limit is enclosed")
    };
    let free = model.contact_free(&Asking::default())?.step.map_err(uncertified)?;
    let gaps: Vec<Gap> = mesh.pencil().contacts().to_vec();
    Ok((mesh.stepping_pencil()?.with_gaps(gaps), model.time_step(1.0)? * free.lower))
}

/// The simulated time of a scene, s.
///
/// # Errors
/// A scene without `[impact]`.
pub fn duration(scene: &AnyScene) -> Result<f64, Refusal> {
    let found = match scene {
        AnyScene::Bars(scene) => scene.impact().map(|impact| impact.duration),
        AnyScene::Matrices(scene) => scene.impact.as_ref().map(|impact| impact.duration),
        AnyScene::Mesh(scene) => scene.impact.as_ref().map(|impact| impact.duration),
    };
    let place = format!("scene {}, impact", scene.name());
    let allowed = "an [impact] table with a duration (s), which time stepping needs";
    found.ok_or_else(|| Refusal::new(place, "no [impact]", allowed))
}

/// The exact solution of a scene up to a time, s: of bars, and of boxes that move as bars
/// ([`MeshScene::as_bars`](crate::mesh::MeshScene::as_bars)); `None` where there is none.
pub fn exact(scene: &AnyScene, duration: f64) -> Option<Exact> {
    match scene {
        AnyScene::Bars(scene) => Exact::of(scene, duration),
        AnyScene::Mesh(scene) => Exact::of(&scene.as_bars()?, duration),
        AnyScene::Matrices(_) => None,
    }
}
