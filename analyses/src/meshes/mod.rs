//! The studies of meshes: what contact costs them, what proves it, and what rules of thumb make of it.

mod hertz;
pub mod impacts;
mod plane;
mod rules;
mod scenes;
mod surface;

pub use hertz::Hertz;
pub use plane::{displaced, outlines, polygons};
pub use rules::Rules;
pub use scenes::{Blocks, disc};
pub use surface::{Direction, Spot, direction, spots};

use crate::error::{Error, Refusal, Result};
use crate::record::{MeshRow, Number};
use bipenalty::penalty::PenaltyMass;
use bipenalty::stability::{AnyModel, Asking, CriticalStep, Grid, Sweep};

/// Elements in the plane and in space.
pub const ELEMENTS: [[&str; 4]; 2] = [["tri3", "tri6", "quad4", "quad8"], ["tet4", "tet10", "hex8", "hex20"]];

/// Width of the enclosures, relative: below what patches lose where they lose least.
const WIDTH: f64 = 1e-9;

/// dt with over without contact of the Abaqus 6.6 user's manual, table 29.3.6-1, for five scales of its default penalty.
pub const MANUAL: [(f64, f64); 5] = [(1.0, 0.96), (10.0, 0.34), (1e2, 0.13), (1e3, 0.04), (1e4, 0.013)];

/// How finely a study is made.
#[derive(Debug, Clone, Copy)]
pub struct Fineness {
    /// Cells along an edge of a block in the plane.
    pub plane: usize,
    /// The same in space.
    pub space: usize,
    /// Points along an axis of beta_s.
    pub points: usize,
}

impl Fineness {
    /// For the figures.
    pub const FIGURES: Self = Self { plane: 32, space: 12, points: 61 };
    /// For a test.
    pub const QUICK: Self = Self { plane: 6, space: 2, points: 7 };
}

/// A mesh with its contact-free step.
struct Study {
    blocks: Blocks,
    model: AnyModel,
    unit: f64,
    free: f64,
}

impl Study {
    fn new(name: &str, element: &'static str, cells: [usize; 2]) -> Result<Self> {
        let blocks = Blocks { name: name.to_owned(), element, cells };
        let model = AnyModel::new(&blocks.scene()?, None, PenaltyMass::Consistent)?;
        let unit = model.time_step(1.0)?;
        let free = unit * certified(&model, model.contact_free(&Asking::default())?.step)?.lower;
        Ok(Self { blocks, model, unit, free })
    }

    /// The enclosed steps of all points, ratio by ratio.
    fn exact(
        &self,
        beta_s: &Sweep,
        ratios: &Sweep,
        patch: Option<usize>,
    ) -> Result<Vec<(f64, f64, CriticalStep)>> {
        let grid = Grid::new(beta_s, ratios)?;
        let tolerance = if patch.is_some() { None } else { Some(WIDTH) };
        let asking = Asking { tolerance, patch, ..Asking::default() };
        let mut found = Vec::new();
        for curve in self.model.map(&grid, &asking, &|_| ())? {
            for point in curve.points {
                let step = certified(&self.model, point.step)?;
                found.push((point.stiffness_penalty.get(), curve.ratio.get(), step));
            }
        }
        Ok(found)
    }

    /// The row of an estimate, by default of the step itself.
    fn row(
        &self,
        study: &'static str,
        (beta_s, ratio, exact): (f64, f64, CriticalStep),
        estimate: Option<(&'static str, f64)>,
        parameter: Option<f64>,
    ) -> MeshRow {
        let (lower, upper) = (exact.lower * self.unit, exact.upper * self.unit);
        let (name, step) = estimate.unwrap_or(("exact", lower));
        MeshRow {
            study,
            scene: self.blocks.name.clone(),
            element: self.blocks.element,
            unknowns: self.unknowns(),
            contacts: self.model.contacts(),
            parameter: parameter.map(Number),
            stiffness_penalty: Number(beta_s),
            ratio: Number(ratio),
            estimate: name,
            step: Number(step),
            step_lower: Number(lower),
            step_upper: Number(upper),
            error: Number(step / lower - 1.0),
            relative_step: Number(step / self.free),
            courant: Some(Number(Blocks::wave_speed() * step / self.blocks.cell())),
        }
    }

    fn unknowns(&self) -> usize {
        match &self.model {
            AnyModel::Mesh(mesh) => mesh.pencil().size(),
            AnyModel::Bars(_) => 0,
        }
    }
}

fn certified<E: std::fmt::Display>(model: &AnyModel, step: Result<CriticalStep, E>) -> Result<CriticalStep> {
    step.map_err(|error| Error::from(Refusal::new(model.name(), error, "points whose limit is enclosed")))
}

/// The models of the study of contact: two blocks that match and that do not, in the plane and in space, and the disc.
///
/// # Errors
/// As [`AnyModel::new`].
pub fn contact_models(fine: &Fineness) -> Result<Vec<AnyModel>> {
    let (n, k) = (fine.plane, fine.space);
    let blocks =
        [("quad4", [n, n]), ("quad4", [n, n * 17 / 24]), ("hex8", [k, k]), ("hex8", [k, (k * 5 / 8).max(1)])];
    let mut models = Vec::new();
    for (element, cells) in blocks {
        let matching = if cells[0] == cells[1] { "matching" } else { "unlike" };
        let blocks = Blocks { name: format!("{element}-{matching}"), element, cells };
        models.push(AnyModel::new(&blocks.scene()?, None, PenaltyMass::Consistent)?);
    }
    if let Some(path) = disc() {
        let scene = bipenalty::stability::AnyScene::load(&path.to_string_lossy())?;
        models.push(AnyModel::new(&scene, None, PenaltyMass::Consistent)?);
    }
    Ok(models)
}

/// What contact without a mass penalty costs meshes of every element.
///
/// # Errors
/// As [`AnyModel::map`].
pub fn elements(fine: &Fineness) -> Result<Vec<MeshRow>> {
    let (beta_s, pure) = (Sweep::log(1e-2, 1e3, fine.points)?, Sweep::list([f64::INFINITY]));
    let mut rows = Vec::new();
    for (kinds, cells) in ELEMENTS.iter().zip([fine.plane / 2, fine.space / 2]) {
        for element in kinds {
            let study = Study::new(element, element, [cells.max(1); 2])?;
            let found = study.exact(&beta_s, &pure, None)?;
            rows.extend(found.into_iter().map(|point| study.row("elements", point, None, None)));
        }
    }
    Ok(rows)
}

/// What contact costs where the cells of the two bodies are unlike.
///
/// # Errors
/// As [`AnyModel::map`].
pub fn sizes(fine: &Fineness) -> Result<Vec<MeshRow>> {
    let (beta_s, ratios) = (Sweep::list([1.0, 1e3]), Sweep::list([1.0, 2.0, 4.0, f64::INFINITY]));
    let n = fine.plane;
    let mut rows = Vec::new();
    for cells in [[2, 16], [2, 8], [4, 12], [4, 8], [6, 9], [8, 8], [9, 6], [8, 4], [12, 4], [8, 2], [16, 2]]
    {
        let cells = cells.map(|cells| (cells * n / 6).max(1));
        let study = Study::new("sizes", "quad4", cells)?;
        let ratio = study.blocks.size_ratio();
        let found = study.exact(&beta_s, &ratios, None)?;
        rows.extend(found.into_iter().map(|point| study.row("sizes", point, None, Some(ratio))));
    }
    Ok(rows)
}

/// What single elements, patches of them and the whole matrix prove.
///
/// # Errors
/// As [`AnyModel::map`].
pub fn bounds(fine: &Fineness) -> Result<Vec<MeshRow>> {
    let mut rows = Vec::new();
    for (element, cells) in [("quad4", fine.plane), ("hex8", fine.space)] {
        let study = Study::new(element, element, [cells; 2])?;
        let (beta_s, ratios) = (Sweep::list([0.0, 1.0, 10.0, 1e3]), Sweep::list([1.0, f64::INFINITY]));
        let exact = study.exact(&beta_s, &ratios, None)?;
        // Whole patches only: a remainder of few elements proves as little as they would for themselves.
        let edges = (1..cells).filter(|edge| cells / 2 % edge == 0);
        for edge in edges {
            let proven = study.exact(&beta_s, &ratios, Some(edge))?;
            for (exact, (.., proven)) in exact.iter().zip(proven) {
                let estimate = (if edge == 1 { "element" } else { "patches" }, proven.lower * study.unit);
                rows.push(study.row("bounds", *exact, Some(estimate), Some(edge as f64)));
            }
        }
        rows.extend(exact.into_iter().map(|point| study.row("bounds", point, None, None)));
    }
    Ok(rows)
}

/// What rules of thumb say beside the step.
///
/// # Errors
/// As [`AnyModel::map`].
pub fn rules(fine: &Fineness) -> Result<Vec<MeshRow>> {
    let (beta_s, ratios) = (Sweep::log(1e-2, 1e4, fine.points)?, Sweep::list([1.0, 4.0, f64::INFINITY]));
    let mut rows = Vec::new();
    for (name, element, cells) in [
        ("quad4-unlike", "quad4", [fine.plane, fine.plane * 17 / 24]),
        ("hex8-unlike", "hex8", [fine.space, (fine.space * 5 / 8).max(1)]),
    ] {
        let study = Study::new(name, element, cells)?;
        let AnyModel::Mesh(mesh) = &study.model else { continue };
        let rules = Rules::new(mesh, study.model.reference()?);
        let none = Sweep::list([0.0]);
        let single = study.exact(&none, &Sweep::list([f64::INFINITY]), Some(1))?;
        let Some(element) = single.first().map(|(.., step)| step.lower * study.unit) else { continue };
        for point in study.exact(&beta_s, &ratios, None)? {
            let (beta_s, ratio, _) = point;
            rows.push(study.row("rules", point, None, None));
            let estimates = [
                ("no contact", element),
                ("nodal", rules.nodal(beta_s, ratio)),
                ("oscillators", rules.oscillators(element, beta_s, ratio)),
            ];
            rows.extend(estimates.map(|estimate| study.row("rules", point, Some(estimate), None)));
        }
    }
    Ok(rows)
}

/// The five scales of a manual beside meshes whose first scale costs what it says there.
///
/// # Errors
/// As [`AnyModel::map`].
pub fn scales(fine: &Fineness) -> Result<Vec<MeshRow>> {
    let (n, k) = (fine.plane, fine.space);
    let scenes: [(&str, &'static str, [usize; 2]); 3] = [
        ("quad4-matching", "quad4", [n, n]),
        ("quad4-unlike", "quad4", [n, n * 17 / 24]),
        ("hex8-matching", "hex8", [k, k]),
    ];
    let mut rows = Vec::new();
    for (name, element, cells) in scenes {
        let study = Study::new(name, element, cells)?;
        let asking = Asking { tolerance: Some(WIDTH), ..Asking::default() };
        let first = study.model.largest_penalty(MANUAL[0].1 * study.free, f64::INFINITY, &asking)?;
        let Some(first) = first.filter(|first| first.value.is_finite()) else { continue };
        let scales = Sweep::log(1.0, 1e4, fine.points.max(5))?.values;
        let beta_s = Sweep::list(scales.iter().map(|scale| scale * first.value).collect::<Vec<_>>());
        let found = study.exact(&beta_s, &Sweep::list([1.0, f64::INFINITY]), None)?;
        let scales = scales.iter().cycle();
        rows.extend(
            found
                .into_iter()
                .zip(scales)
                .map(|(point, scale)| study.row("scales", point, None, Some(*scale))),
        );
    }
    Ok(rows)
}
