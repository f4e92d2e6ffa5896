//! A scene of meshes: bodies, contacts and supports, and what they are assembled to.

use std::path::PathBuf;

use super::assembly::{Body, Elements, HELD};
use super::contact::{self, NodeContact, Surface};
use super::elasticity::{Material, Plane};
use super::element::Coordinates;
use super::structured::Cuboid;
use super::{file, gmsh};
use crate::error::{Refusal, Result};
use crate::fem::MassMatrix;
use crate::memory;
use crate::pencil::{Gap, Matrix};
use crate::sparse::{Csr, SparseVector, gap_scale};

/// A scene of `[[body]]`, `[[contact]]` and `[[hold]]`, checked but not yet meshed.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshScene {
    /// Its name.
    pub name: String,
    /// 2 or 3.
    pub dimension: usize,
    /// `None` in space.
    pub plane: Option<Plane>,
    pub(super) bodies: Vec<BodySource>,
    pub(super) contacts: Vec<(SurfaceName, Opponent)>,
    pub(super) holds: Vec<(SurfaceName, Vec<usize>)>,
    /// `[impact]`, if the scene has one.
    pub impact: Option<MeshImpact>,
}

/// What time stepping needs beside the velocities of the bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshImpact {
    /// Simulated time T, s.
    pub duration: f64,
    /// Distances that are added to those of the meshes, m, one for each `[[contact]]`.
    pub gaps: Vec<f64>,
    /// Body force per mass in x, y and z, m/s^2.
    pub gravity: Coordinates,
}

/// A body before its mesh is made or read.
#[derive(Debug, Clone, PartialEq)]
pub struct BodySource {
    /// Its name.
    pub name: String,
    pub(super) mesh: MeshSource,
    pub(super) material: Material,
    pub(super) velocity: Coordinates,
    /// File, line and key of its cells or of its mesh file.
    pub(super) place: String,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum MeshSource {
    Box(Cuboid),
    Gmsh(PathBuf),
}

/// A surface of a body, as `lower.top`, and the place in the file that names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SurfaceName {
    /// The body.
    pub body: usize,
    /// The surface of its mesh.
    pub surface: String,
    pub(super) written: String,
    pub(super) place: String,
}

/// What the nodes of a surface touch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Opponent {
    /// A rigid wall at the surface.
    Wall,
    /// The faces of another surface.
    Surface(SurfaceName),
}

/// Where a contact is, for reports.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// The node of the first surface, numbered over all bodies.
    pub node: usize,
    /// Where it is, m.
    pub coordinates: Coordinates,
    /// 2 or 3 of them count.
    pub dimension: usize,
    /// The body of the node, and what it touches: a body or `wall`.
    pub bodies: [String; 2],
    /// The surfaces as the scene names them.
    pub surfaces: [String; 2],
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let coordinates: Vec<String> =
            self.coordinates[..self.dimension].iter().map(ToString::to_string).collect();
        let [first, second] = &self.bodies;
        write!(f, "at ({}), between {first} and {second}", coordinates.join(", "))
    }
}

/// One contact: gap = z'u + g0, positive in penetration.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceContact {
    /// z on the free degrees of freedom.
    pub column: SparseVector,
    /// w, N/m: what beta_s multiplies.
    pub scale: f64,
    /// g0, m; negative where the contact is open.
    pub initial_gap: f64,
    /// Where it is.
    pub place: Place,
}

/// The matrices of a scene on its free degrees of freedom, with its contacts and elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Assembled {
    /// K, N/m, whole and symmetric.
    pub stiffness: Csr,
    /// M, kg.
    pub mass: Matrix,
    /// The contacts in the order of the scene, each surface by ascending nodes. A contact whose degrees of freedom are all
    /// held is left out: nothing there can move.
    pub contacts: Vec<SurfaceContact>,
    /// The elements, for patches and for reports.
    pub elements: Elements,
}

impl Assembled {
    /// The contacts as the gaps of a pencil.
    pub fn gaps(&self) -> Vec<Gap> {
        let gap =
            |c: &SurfaceContact| Gap { column: c.column.clone(), scale: c.scale, initial: c.initial_gap };
        self.contacts.iter().map(gap).collect()
    }
}

impl MeshScene {
    /// Reads a scene from TOML; `path` is what messages call it, and its folder is where mesh files are looked for.
    ///
    /// # Errors
    /// TOML that cannot be read, keys that are not known, values that mean nothing: each with its line.
    pub fn parse(text: &str, path: &str) -> Result<Self> {
        file::parse(text, path)
    }

    /// Unknowns of the scene's boxes, supports not counted; `None` beyond what can be counted.
    pub fn box_unknowns(&self) -> Option<usize> {
        let boxes = self.bodies.iter().filter_map(|body| match &body.mesh {
            MeshSource::Box(cuboid) => Some(cuboid.node_count()),
            MeshSource::Gmsh(_) => None,
        });
        boxes.into_iter().try_fold(0_usize, |all, nodes| all.checked_add(nodes?.checked_mul(self.dimension)?))
    }

    /// The bodies with their meshes.
    fn meshed(&self) -> Result<Vec<Body>> {
        let body = |source: &BodySource| {
            let mesh = match &source.mesh {
                MeshSource::Box(cuboid) => cuboid.mesh(),
                MeshSource::Gmsh(path) => gmsh::read(path, self.dimension)?,
            };
            Ok(Body { name: source.name.clone(), mesh, material: source.material, velocity: source.velocity })
        };
        self.bodies.iter().map(body).collect()
    }

    /// Meshes the bodies and assembles K, M and the gaps.
    ///
    /// # Errors
    /// More unknowns than memory holds, a mesh file that cannot be read, a Jacobian determinant that is not positive, a
    /// surface that the mesh does not have or that is empty, surfaces of a contact that do not meet, supports that leave
    /// nothing to move.
    pub fn assemble(&self, mass: MassMatrix) -> Result<Assembled> {
        self.fits_into_memory()?;
        let mut elements = Elements::new(self.meshed()?, self.dimension, self.plane, mass.gamma());
        let mut held = Vec::new();
        for (name, directions) in &self.holds {
            let surface = surface(&elements, name)?;
            let first = elements.first[name.body].0;
            for node in surface.mesh.nodes_of(surface.faces) {
                held.extend(directions.iter().map(|i| (first + node as usize) * self.dimension + i));
            }
        }
        elements.hold(&held);
        if elements.unknowns() == 0 {
            let place = format!("scene {}", self.name);
            return Err(
                Refusal::new(place, "supports on every node", "at least one free degree of freedom").into()
            );
        }
        let (stiffness, mass) = elements
            .stiffness()
            .and_then(|stiffness| Ok((stiffness, elements.mass()?)))
            .map_err(|refusal| self.in_file(refusal))?;
        let body_of = body_of_unknowns(&elements);
        let mut contacts = Vec::new();
        for (at, (first, second)) in self.contacts.iter().enumerate() {
            let mut found = self.contacts_between(&elements, first, second, &stiffness, &body_of)?;
            let distance = self.impact.as_ref().map_or(0.0, |impact| impact.gaps[at]);
            found.iter_mut().for_each(|contact| contact.initial_gap -= distance);
            contacts.extend(found);
        }
        Ok(Assembled { stiffness, mass, contacts, elements })
    }

    /// What the elements refuse, by the line of the body that it names.
    fn in_file(&self, refusal: Refusal) -> Refusal {
        let of = |body: &&BodySource| refusal.place.starts_with(&format!("body {},", body.name));
        match self.bodies.iter().find(of) {
            Some(body) => Refusal { place: format!("{}, {}", body.place, refusal.place), ..refusal },
            None => refusal,
        }
    }

    fn contacts_between(
        &self,
        elements: &Elements,
        first: &SurfaceName,
        second: &Opponent,
        stiffness: &Csr,
        body_of: &[u32],
    ) -> Result<Vec<SurfaceContact>> {
        let (own, other) = match second {
            Opponent::Wall => (first, first),
            Opponent::Surface(second) => (first, second),
        };
        let found = match second {
            Opponent::Wall => contact::with_wall(&surface(elements, own)?),
            Opponent::Surface(second) => {
                contact::between(&surface(elements, own)?, &surface(elements, second)?)
            }
        };
        let bodies = [own.body, other.body];
        let mut contacts = Vec::new();
        for node_contact in found {
            let column = column(elements, bodies, &node_contact);
            let Some(scale) = gap_scale(stiffness, &column, |dof| body_of[dof as usize] as usize) else {
                continue;
            };
            let place = place(elements, own, second, node_contact.node);
            contacts.push(SurfaceContact { column, scale, initial_gap: node_contact.initial, place });
        }
        if contacts.is_empty() {
            let value = match second {
                Opponent::Wall => format!("{} and wall", own.written),
                Opponent::Surface(second) => format!("{} and {}", own.written, second.written),
            };
            let allowed = "surfaces that meet: a node of the first, free to move, must project onto a face of the second that looks at it";
            return Err(Refusal::new(&own.place, value, allowed).into());
        }
        Ok(contacts)
    }

    /// Refuses, before anything is built, boxes whose matrices need more memory than the machine has.
    fn fits_into_memory(&self) -> Result<()> {
        let largest = |body: &&BodySource| match &body.mesh {
            MeshSource::Box(cuboid) => cuboid.node_count().unwrap_or(usize::MAX),
            MeshSource::Gmsh(_) => 0,
        };
        let Some(BodySource { place, .. }) = self.bodies.iter().max_by_key(largest) else { return Ok(()) };
        let needed = self.box_unknowns().and_then(|n| Some((n, self.bytes()?)));
        let limit = memory::available();
        match needed {
            Some((unknowns, bytes)) if unknowns < HELD as usize && bytes <= limit => Ok(()),
            Some((unknowns, bytes)) => {
                let value = format!("a scene of {unknowns} unknowns, about {} MB of matrices,", bytes >> 20);
                let allowed = format!("what fits into {} MB of memory and {HELD} unknowns", limit >> 20);
                Err(Refusal::new(place, value, allowed).into())
            }
            None => {
                Err(Refusal::new(place, "a number of cells that cannot be counted", "fewer cells").into())
            }
        }
    }

    /// K of the boxes by rows: 12 bytes an entry, and as many neighbours for each node as an inner corner has.
    fn bytes(&self) -> Option<u64> {
        self.bodies.iter().try_fold(0_u64, |all, body| {
            let MeshSource::Box(cuboid) = &body.mesh else { return Some(all) };
            let order = cuboid.kind.element().order() as u32;
            // Corner rows of second order are wider, those of edges narrower: the mean is near (2p + 1)^d at most.
            let neighbours = (2 * u64::from(order) + 1).pow(self.dimension as u32);
            let d = self.dimension as u64;
            all.checked_add((cuboid.node_count()? as u64).checked_mul(12 * d * d * neighbours)?)
        })
    }
}

/// The faces of a surface.
fn surface<'a>(elements: &'a Elements, name: &SurfaceName) -> Result<Surface<'a>> {
    let mesh = &elements.bodies[name.body].mesh;
    let known = || mesh.surfaces.iter().filter(|(_, faces)| !faces.is_empty()).map(|(name, _)| name.as_str());
    let body = &elements.bodies[name.body].name;
    let allowed = || format!("one of the surfaces of {body}: {}", known().collect::<Vec<_>>().join(", "));
    match mesh.surfaces.get(&name.surface) {
        Some(faces) if !faces.is_empty() => Ok(Surface { mesh, faces }),
        Some(_) => {
            let value = format!("{}, a surface without faces", name.written);
            Err(Refusal::new(&name.place, value, allowed()).into())
        }
        None => Err(Refusal::new(&name.place, format!("{:?}", name.written), allowed()).into()),
    }
}

/// The body of each free degree of freedom.
fn body_of_unknowns(elements: &Elements) -> Vec<u32> {
    let mut body_of = Vec::with_capacity(elements.unknowns());
    for (body, ends) in elements.first.windows(2).enumerate() {
        let dofs = &elements.dofs[ends[0].0 * elements.dimension..ends[1].0 * elements.dimension];
        body_of.extend(dofs.iter().filter(|dof| **dof != HELD).map(|_| body as u32));
    }
    body_of
}

/// z on the free degrees of freedom; entries of a node that occurs twice add up.
fn column(elements: &Elements, bodies: [usize; 2], contact: &NodeContact) -> SparseVector {
    let d = elements.dimension;
    let mut entries: Vec<(u32, f64)> = Vec::new();
    for (side, node, weight) in &contact.weights {
        let node = elements.first[bodies[*side]].0 + *node as usize;
        for (i, entry) in weight.iter().enumerate().take(d) {
            let dof = elements.dofs[node * d + i];
            if dof == HELD || *entry == 0.0 {
                continue;
            }
            match entries.iter_mut().find(|(known, _)| *known == dof) {
                Some((_, sum)) => *sum += entry,
                None => entries.push((dof, *entry)),
            }
        }
    }
    entries.retain(|(_, entry)| *entry != 0.0);
    entries.sort_by_key(|(dof, _)| *dof);
    SparseVector(entries)
}

fn place(elements: &Elements, own: &SurfaceName, second: &Opponent, node: u32) -> Place {
    let name = |surface: &SurfaceName| elements.bodies[surface.body].name.clone();
    let (body, surface) = match second {
        Opponent::Wall => ("wall".to_owned(), "wall".to_owned()),
        Opponent::Surface(second) => (name(second), second.written.clone()),
    };
    Place {
        node: elements.first[own.body].0 + node as usize,
        coordinates: elements.bodies[own.body].mesh.nodes[node as usize],
        dimension: elements.dimension,
        bodies: [name(own), body],
        surfaces: [own.written.clone(), surface],
    }
}
