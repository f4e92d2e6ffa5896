//! The pictures of a mesh: a run is stepped again to a few instants that its rows tell, so that no states are held meanwhile.

use rayon::prelude::*;

use super::impacts::STOP;
use super::{FinishedPassage, Output, PlannedPassage};
use crate::charts::fields::{Instant, Reference, stresses, surfaces};
use crate::error::{Error, Refusal, Result};
use crate::meshes::{Direction, Hertz, Spot, direction, displaced, outlines, polygons, spots};
use crate::record::{ElementRow, Number, PassageRow, SurfaceRow};
use bipenalty::impact::Observer;
use bipenalty::mesh::{Elements, Place, von_mises};
use bipenalty::pencil::Gap;
use bipenalty::schemes::Motion;
use bipenalty::stability::AnyModel;

/// Panels of a picture.
const MOST: usize = 6;

/// Refuses pictures of what has no mesh, and more instants than panels.
///
/// # Errors
/// Names the scene, or the times.
pub fn check_fields(model: &AnyModel, instants: &[f64], wanted: bool) -> Result<(), Refusal> {
    let has_mesh = matches!(model, AnyModel::Mesh(mesh) if mesh.mesh().is_some());
    if wanted && !has_mesh {
        let value = format!("given with scene {}", model.name());
        return Err(Refusal::new("--fields", value, "a scene of [[body]], which has a mesh"));
    }
    let allowed = if has_mesh { MOST } else { 1 };
    if instants.len() > allowed {
        let value = format!("{} times with scene {}", instants.len(), model.name());
        return Err(Refusal::new("--stress-at", value, format!("at most {allowed}")));
    }
    Ok(())
}

/// Refuses instants beyond the run.
///
/// # Errors
/// Names the first of them.
pub fn check_instants(planned: &PlannedPassage, instants: &[f64]) -> Result<(), Refusal> {
    let end = planned.passage.steps() as f64 * planned.passage.time_step();
    match instants.iter().find(|time| !(0.0..=end).contains(*time)) {
        Some(time) => Err(Refusal::new("--stress-at", time, format!("a time (s) from 0 to {end:e}"))),
        None => Ok(()),
    }
}

/// Draws stress, pressure and gap of the runs that came to their end, at the instants `at` (s), or at the largest contact force and
/// halfway to it and from it; `every` as in the rows. The number of files.
///
/// # Errors
/// What stepping refuses, and what the system says of a file.
pub fn draw_fields(finished: &[FinishedPassage], every: u64, at: &[f64], output: &Output) -> Result<usize> {
    if output.to_stdout() {
        return Ok(0);
    }
    let whole = finished.par_iter().filter(|run| run.ending.is_finished());
    whole.map(|run| draw(run, every, at, output)).sum()
}

fn draw(run: &FinishedPassage, every: u64, at: &[f64], output: &Output) -> Result<usize> {
    let AnyModel::Mesh(model) = &*run.planned.model else { return Ok(0) };
    let Some((elements, places)) = model.mesh().zip(model.places()) else { return Ok(0) };
    let gaps = run.planned.passage.encounter().pencil().gaps();
    let chosen = chosen(&run.rows, at);
    let mut pictures = Pictures::new(elements, places, gaps);
    let (mut row, mut failure) = (0, None);
    let watched = Observer { stop: &STOP, report: &mut |_, _| () };
    run.planned.passage.stream(every, Some(watched), |time, motion| {
        if chosen.contains(&row) && failure.is_none() {
            failure = pictures.add(time, motion).err();
        }
        row += 1;
    })?;
    failure.map_or(Ok(()), |refusal| Err(Error::from(refusal)))?;
    pictures.write(run, output)
}

/// The rows that are drawn, ascending: those next to the instants asked for; else that of the largest force and those halfway to
/// it from the first contact, and from it to the last. A run without contact is taken as one with contact throughout.
fn chosen(rows: &[PassageRow], at: &[f64]) -> Vec<usize> {
    let last = rows.len().saturating_sub(1);
    let next = |time: &f64| {
        let before = rows.partition_point(|row| row.time.0 < *time).min(last);
        let earlier = before.saturating_sub(1);
        let off = |i: usize| rows.get(i).map_or(f64::INFINITY, |row| (row.time.0 - time).abs());
        if off(earlier) < off(before) { earlier } else { before }
    };
    let touches = |row: &PassageRow| row.contact_force.0 > 0.0;
    let start = rows.iter().position(touches).unwrap_or(0);
    let end = rows.iter().rposition(touches).unwrap_or(last);
    let larger =
        |best: usize, i: usize| if rows[i].contact_force.0 > rows[best].contact_force.0 { i } else { best };
    let peak = if rows.iter().any(touches) { (start..=end).fold(start, larger) } else { last / 2 };
    let mut chosen: Vec<usize> = match at {
        [] => vec![usize::midpoint(start, peak), peak, usize::midpoint(peak, end)],
        times => times.iter().map(next).collect(),
    };
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// What displacements are multiplied by: as many times as make the largest a twentieth of the bodies, of 1, 2 and 5 times a power of
/// ten, at least 1. Surfaces that do not touch at first would be drawn inside each other: they stay at 1.
fn magnification(elements: &Elements, gaps: &[Gap], displacements: &[Vec<f64>]) -> f64 {
    const SHARE: f64 = 0.05;
    let largest = displacements.iter().flatten().fold(0.0_f64, |most, u| most.max(u.abs()));
    if gaps.iter().any(|gap| gap.initial != 0.0) || largest == 0.0 {
        return 1.0;
    }
    let nodes = || elements.bodies.iter().flat_map(|body| &body.mesh.nodes);
    let extent = |i: usize| {
        let (low, high) = nodes()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x[i]), high.max(x[i])));
        high - low
    };
    let free = SHARE * extent(0).max(extent(1)) / largest;
    let power = 10_f64.powf(free.log10().floor());
    let steps = [1.0, 2.0, 5.0].map(|step| step * power);
    steps.into_iter().filter(|step| *step <= free).fold(1.0, f64::max)
}

/// What is kept of the instants.
struct Pictures<'a> {
    elements: &'a Elements,
    places: &'a [Place],
    gaps: &'a [Gap],
    spots: Vec<Spot>,
    direction: Direction,
    times: Vec<f64>,
    displacements: Vec<Vec<f64>>,
    /// Of each instant.
    shown: Vec<Vec<f64>>,
    fields: Vec<ElementRow>,
    contacts: Vec<SurfaceRow>,
}

impl<'a> Pictures<'a> {
    fn new(elements: &'a Elements, places: &'a [Place], gaps: &'a [Gap]) -> Self {
        Self {
            elements,
            places,
            gaps,
            spots: spots(elements, places, gaps),
            direction: direction(elements, places, gaps),
            times: Vec::new(),
            displacements: Vec::new(),
            shown: Vec::new(),
            fields: Vec::new(),
            contacts: Vec::new(),
        }
    }

    fn add(&mut self, time: f64, motion: &dyn Motion) -> Result<(), Refusal> {
        let state = motion.state();
        self.times.push(time);
        if self.elements.dimension == 2 {
            let stresses = self.elements.stresses(&state.displacement)?;
            let shown: Vec<f64> = stresses.iter().map(|stress| self.shown(stress)).collect();
            let row = |(e, (stress, shown)): (usize, (&[f64; 6], &f64))| self.field(time, e, stress, *shown);
            let rows: Vec<ElementRow> = stresses.iter().zip(&shown).enumerate().map(row).collect();
            self.fields.extend(rows);
            self.shown.push(shown);
            self.displacements.push(state.displacement.clone());
        }
        let start = self.contacts.len();
        for (j, (place, spot)) in self.places.iter().zip(&self.spots).enumerate() {
            let force = state.force[j];
            self.contacts.push(SurfaceRow {
                time: Number(time),
                surface: place.surfaces.join(" on "),
                contact: j + 1,
                position: Number(spot.position),
                area: Number(spot.area),
                contact_force: Number(force),
                // Corners of six-node triangles have a share of rounding, those of eight-node faces a negative one.
                pressure: (spot.area > f64::EPSILON * self.largest_area()).then(|| Number(force / spot.area)),
                gap: Number(state.gap[j]),
            });
        }
        // Along each surface.
        let order = |a: &SurfaceRow, b: &SurfaceRow| {
            (&a.surface, a.position.0).partial_cmp(&(&b.surface, b.position.0))
        };
        self.contacts[start..].sort_by(|a, b| order(a, b).unwrap_or(std::cmp::Ordering::Equal));
        Ok(())
    }

    fn largest_area(&self) -> f64 {
        self.spots.iter().fold(0.0, |most, spot| spot.area.max(most))
    }

    fn shown(&self, stress: &[f64; 6]) -> f64 {
        let [xx, yy, _, xy, ..] = stress;
        match self.direction {
            Direction::Normal([x, y]) => x * x * xx + y * y * yy + 2.0 * x * y * xy,
            Direction::None => von_mises(stress),
        }
    }

    fn field(&self, time: f64, e: usize, stress: &[f64; 6], shown: f64) -> ElementRow {
        let [x, y, _] = self.elements.centre(e);
        let [xx, yy, zz, xy, ..] = *stress;
        ElementRow {
            time: Number(time),
            body: self.elements.bodies[self.elements.body(e)].name.clone(),
            element: e + 1,
            x: Number(x),
            y: Number(y),
            stress_xx: Number(xx),
            stress_yy: Number(yy),
            stress_zz: Number(zz),
            stress_xy: Number(xy),
            von_mises: Number(von_mises(stress)),
            shown: Number(shown),
        }
    }

    fn write(self, run: &FinishedPassage, output: &Output) -> Result<usize> {
        let (stem, summary) = (run.planned.stem(), Some([run.row.clone()]));
        let mut files = 0;
        if !self.shown.is_empty() {
            let factor = magnification(self.elements, self.gaps, &self.displacements);
            let instant = |((time, u), stress): ((&f64, &Vec<f64>), &Vec<f64>)| {
                let places = displaced(self.elements, u, factor);
                let elements = polygons(self.elements, &places);
                let outlines = outlines(self.elements, &places);
                Instant { time: *time, elements, stress: stress.clone(), outlines }
            };
            let states = self.times.iter().zip(&self.displacements).zip(&self.shown);
            let figure = stresses(&states.map(instant).collect::<Vec<_>>(), self.direction, factor);
            let name = format!("{stem}-stress");
            files += output.write_rows(&name, &self.fields)?.len();
            files +=
                output.write_figure_of(&name, &figure, std::slice::from_ref(&name), summary.clone())?.len();
        }
        let name = format!("{stem}-pressure");
        files += output.write_rows(&name, &self.contacts)?.len();
        let figure = surfaces(&self.contacts, self.elements.dimension, &name, self.hertz().as_ref());
        files += output.write_figure_of(&name, &figure, std::slice::from_ref(&name), summary)?.len();
        Ok(files)
    }

    /// Hertz' pressure under the largest force of the instants.
    fn hertz(&self) -> Option<Reference> {
        const POINTS: i32 = 100;
        let hertz = Hertz::of(self.elements, self.places, self.gaps)?;
        let force = |time: f64| {
            self.contacts.iter().filter(|row| row.time.0 == time).map(|row| row.contact_force.0).sum::<f64>()
        };
        let time = self.times.iter().copied().max_by(|a, b| force(*a).total_cmp(&force(*b)))?;
        let (a, p0) = Some(force(time)).filter(|force| *force > 0.0).map(|force| hertz.under(force))?;
        let (middle, _) = self
            .spots
            .iter()
            .zip(self.gaps)
            .map(|(spot, gap)| (spot.position, gap.initial))
            .reduce(|best, next| if next.1 > best.1 { next } else { best })?;
        let (low, high) = self.spots.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), spot| {
            (low.min(spot.position), high.max(spot.position))
        });
        // By the angle, so that the steep ends have points enough.
        let point = |i: i32| {
            let (sin, cos) = (std::f64::consts::PI * (f64::from(i) / f64::from(POINTS) - 0.5)).sin_cos();
            (middle + a * sin, p0 * cos)
        };
        let points = (0..=POINTS).map(point).filter(|point| (low..=high).contains(&point.0)).collect();
        Some(Reference { points, time })
    }
}
