//! K and M on the free degrees of freedom, row by row from the mesh: no list of triplets is ever held.

use rayon::prelude::*;

use super::elasticity::{ElementMatrices, Material, Plane};
use super::element::Coordinates;
use super::topology::Mesh;
use crate::error::Refusal;
use crate::interrupt;
use crate::memory;
use crate::pencil::Matrix;
use crate::sparse::Csr;

/// What stands for a degree of freedom that a support removes.
pub const HELD: u32 = u32::MAX;

/// Nodes whose rows one task fills: neighbours share elements, which are then computed once.
const NODES: usize = 1024;

/// A body with its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name in the scene.
    pub name: String,
    /// Nodes, elements and surfaces.
    pub mesh: Mesh,
    /// What it is made of.
    pub material: Material,
    /// Initial velocity, m/s.
    pub velocity: Coordinates,
}

/// The elements of all bodies with their place among the free degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct Elements {
    /// 2 or 3.
    pub dimension: usize,
    /// `None` in space.
    pub plane: Option<Plane>,
    /// gamma of the mass matrix.
    pub gamma: f64,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The number of the first node and of the first element of each body, and of the end.
    pub first: Vec<(usize, usize)>,
    /// The free degree of freedom of `node * dimension + direction`, or [`HELD`].
    pub dofs: Vec<u32>,
}

/// Which matrix is assembled.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Stiffness,
    Mass,
}

impl Elements {
    /// Numbers the elements and nodes of `bodies` one after the other; every degree of freedom is free until [`Self::hold`].
    pub fn new(bodies: Vec<Body>, dimension: usize, plane: Option<Plane>, gamma: f64) -> Self {
        let mut first = vec![(0, 0)];
        for (i, body) in bodies.iter().enumerate() {
            first.push((first[i].0 + body.mesh.nodes.len(), first[i].1 + body.mesh.elements()));
        }
        let dofs = (0..(first[bodies.len()].0 * dimension) as u32).collect();
        Self { dimension, plane, gamma, bodies, first, dofs }
    }

    /// Removes degrees of freedom, given by `node * dimension + direction`, and numbers the others anew.
    pub fn hold(&mut self, held: &[usize]) {
        held.iter().for_each(|at| self.dofs[*at] = HELD);
        let free = self.dofs.iter_mut().filter(|dof| **dof != HELD);
        free.enumerate().for_each(|(number, dof)| *dof = number as u32);
    }

    /// Number of free degrees of freedom.
    pub fn unknowns(&self) -> usize {
        self.dofs.iter().filter(|dof| **dof != HELD).count()
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.first[self.bodies.len()].1
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The body of element `e`.
    pub fn body(&self, e: usize) -> usize {
        self.first.partition_point(|(_, first)| *first <= e) - 1
    }

    /// The nodes of element `e`, numbered over all bodies.
    pub fn nodes(&self, e: usize) -> Vec<u32> {
        let body = self.body(e);
        let (node, element) = self.first[body];
        self.bodies[body].mesh.element(e - element).iter().map(|local| local + node as u32).collect()
    }

    /// The free degrees of freedom of element `e`, node by node, [`HELD`] among them.
    pub fn dofs(&self, e: usize) -> Vec<u32> {
        let d = self.dimension;
        self.nodes(e)
            .iter()
            .flat_map(|node| (0..d).map(move |i| *node as usize * d + i))
            .map(|at| self.dofs[at])
            .collect()
    }

    /// The middle of the nodes of element `e`, m.
    pub fn centre(&self, e: usize) -> Coordinates {
        let body = self.body(e);
        let places = self.bodies[body].mesh.places(e - self.first[body].1);
        std::array::from_fn(|i| places.iter().map(|x| x[i]).sum::<f64>() / places.len() as f64)
    }

    /// The first element that is a translate of element `e`: they have the same matrices.
    pub fn alike(&self, e: usize) -> usize {
        let body = self.body(e);
        let first = self.first[body].1;
        self.bodies[body].mesh.congruent.map_or(e, |period| first + (e - first) % period)
    }

    /// K_e over the degrees of freedom of element `e`, N/m, and its mass between nodes, kg, the same in each direction:
    /// (1 - gamma) consistent + gamma lumped. Both by rows, held degrees of freedom included.
    ///
    /// # Errors
    /// A Jacobian determinant that is not positive, with the body and the number of the element.
    pub fn matrices(&self, e: usize) -> Result<(Vec<f64>, Vec<f64>), Refusal> {
        let body = self.body(e);
        let computed = self.local_matrices(body, e - self.first[body].1)?;
        let element = self.bodies[body].mesh.kind(e - self.first[body].1).element();
        let mass = computed.mass(element, self.gamma);
        Ok((computed.stiffness, mass))
    }

    fn local_matrices(&self, body: usize, e: usize) -> Result<ElementMatrices, Refusal> {
        let Body { name, mesh, material, .. } = &self.bodies[body];
        let e = mesh.congruent.map_or(e, |period| e % period);
        let places = mesh.places(e);
        ElementMatrices::new(mesh.kind(e).element(), &places, material, self.plane).map_err(|refusal| {
            let [x, y, z] = places[0];
            let place = format!("body {name}, element {} at ({x}, {y}, {z}), {}", e + 1, refusal.place);
            Refusal { place, ..refusal }
        })
    }

    /// K, N/m, whole and symmetric.
    ///
    /// # Errors
    /// A Jacobian determinant that is not positive.
    pub fn stiffness(&self) -> Result<Csr, Refusal> {
        self.assemble(Part::Stiffness)
    }

    /// M, kg; diagonal where gamma is 1.
    ///
    /// # Errors
    /// A Jacobian determinant that is not positive.
    pub fn mass(&self) -> Result<Matrix, Refusal> {
        if self.gamma < 1.0 {
            self.assemble(Part::Mass).map(Matrix::Sparse)
        } else {
            self.lumped().map(Matrix::Diagonal)
        }
    }

    fn lumped(&self) -> Result<Vec<f64>, Refusal> {
        let mut nodal = vec![0.0; self.first[self.bodies.len()].0];
        for (body, of) in self.bodies.iter().enumerate() {
            let nodal = &mut nodal[self.first[body].0..];
            let diagonals = |e: usize| self.lumped_masses(body, e);
            let distinct = of.mesh.congruent.unwrap_or(of.mesh.elements());
            let computed: Vec<Vec<f64>> =
                (0..distinct).into_par_iter().map(diagonals).collect::<Result<_, Refusal>>()?;
            for e in 0..of.mesh.elements() {
                let masses = &computed[e % distinct];
                of.mesh.element(e).iter().zip(masses).for_each(|(node, m)| nodal[*node as usize] += m);
            }
        }
        let d = self.dimension;
        let free = self.dofs.iter().enumerate().filter(|(_, dof)| **dof != HELD);
        Ok(free.map(|(at, _)| nodal[at / d]).collect())
    }

    /// The lumped mass of element `e` of a body at each of its nodes, kg.
    pub(super) fn lumped_masses(&self, body: usize, e: usize) -> Result<Vec<f64>, Refusal> {
        let mesh = &self.bodies[body].mesh;
        let mass = self.local_matrices(body, e)?.mass(mesh.kind(e).element(), 1.0);
        let n = mesh.element(e).len();
        Ok((0..n).map(|a| mass[a * n + a]).collect())
    }

    fn assemble(&self, part: Part) -> Result<Csr, Refusal> {
        let adjacency: Vec<Adjacency> = self.bodies.iter().map(|body| Adjacency::of(&body.mesh)).collect();
        let unknowns = self.unknowns();
        let mut starts = Vec::with_capacity(unknowns + 1);
        starts.push(0);
        for (body, adjacency) in adjacency.iter().enumerate() {
            let nodes = 0..self.bodies[body].mesh.nodes.len();
            let lengths: Vec<Vec<usize>> =
                nodes.into_par_iter().map(|node| self.row_lengths(adjacency, body, node, part)).collect();
            for length in lengths.into_iter().flatten() {
                starts.push(starts[starts.len() - 1] + length);
            }
        }
        let entries = starts[unknowns];
        let (mut indices, mut values) = (vec![0_u32; entries], vec![0.0; entries]);
        memory::prefer_large_pages(&indices);
        memory::prefer_large_pages(&values);
        let (mut indices_left, mut values_left) = (&mut indices[..], &mut values[..]);
        let (mut tasks, mut row) = (Vec::new(), 0);
        for (body, of) in self.bodies.iter().enumerate() {
            for first in (0..of.mesh.nodes.len()).step_by(NODES) {
                let nodes = first..(first + NODES).min(of.mesh.nodes.len());
                let at = |node: usize| (self.first[body].0 + node) * self.dimension;
                let rows =
                    self.dofs[at(nodes.start)..at(nodes.end)].iter().filter(|dof| **dof != HELD).count();
                let length = starts[row + rows] - starts[row];
                row += rows;
                let (index, rest) = indices_left.split_at_mut(length);
                indices_left = rest;
                let (value, rest) = values_left.split_at_mut(length);
                values_left = rest;
                tasks.push((body, nodes, index, value));
            }
        }
        let watch = interrupt::handed();
        tasks.into_par_iter().try_for_each(|(body, nodes, indices, values)| {
            watch.look();
            self.fill(&adjacency[body], body, nodes, part, indices, values)
        })?;
        Ok(Csr::from_parts(unknowns, starts, indices, values))
    }

    /// The free degree of freedom of a node of `body`.
    fn dof(&self, body: usize, node: u32, direction: usize) -> u32 {
        self.dofs[(self.first[body].0 + node as usize) * self.dimension + direction]
    }

    /// Number of entries of each row of `node`.
    fn row_lengths(&self, adjacency: &Adjacency, body: usize, node: usize, part: Part) -> Vec<usize> {
        let d = self.dimension;
        let neighbours = adjacency.neighbours(&self.bodies[body].mesh, node);
        let count = |i: usize| neighbours.iter().filter(|near| self.dof(body, **near, i) != HELD).count();
        let counts: Vec<usize> = (0..d).map(count).collect();
        let free = (0..d).filter(|i| self.dof(body, node as u32, *i) != HELD);
        free.map(|i| if part == Part::Stiffness { counts.iter().sum() } else { counts[i] }).collect()
    }

    /// Fills the rows of `nodes`.
    fn fill(
        &self,
        adjacency: &Adjacency,
        body: usize,
        nodes: std::ops::Range<usize>,
        part: Part,
        indices: &mut [u32],
        values: &mut [f64],
    ) -> Result<(), Refusal> {
        let (d, mesh) = (self.dimension, &self.bodies[body].mesh);
        let (touched, matrices) = self.touched(adjacency, body, nodes.clone(), part)?;
        let mut at = 0;
        for node in nodes {
            let near = adjacency.neighbours(mesh, node);
            let width = near.len() * d;
            let mut rows = vec![0.0; d * width];
            for e in adjacency.elements(node) {
                let own = mesh.element(*e as usize);
                let e = mesh.congruent.map_or(*e as usize, |period| *e as usize % period) as u32;
                // Every element of these nodes is among the touched, sorted ones.
                let matrix = &matrices[touched.partition_point(|known| *known < e)];
                for (a, _) in own.iter().enumerate().filter(|(_, own)| **own as usize == node) {
                    for (b, other) in own.iter().enumerate() {
                        let column = near.partition_point(|known| known < other) * d;
                        add_block(part, (matrix, own.len(), d), (a, b), &mut rows, (column, width));
                    }
                }
            }
            for i in (0..d).filter(|i| self.dof(body, node as u32, *i) != HELD) {
                for (column, other) in near.iter().enumerate() {
                    for j in 0..d {
                        let dof = self.dof(body, *other, j);
                        if dof != HELD && (part == Part::Stiffness || i == j) {
                            indices[at] = dof;
                            values[at] = rows[i * width + column * d + j];
                            at += 1;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// The distinct elements at some nodes, ascending, and the matrix of each.
    fn touched(
        &self,
        adjacency: &Adjacency,
        body: usize,
        nodes: std::ops::Range<usize>,
        part: Part,
    ) -> Result<(Vec<u32>, Vec<Vec<f64>>), Refusal> {
        let mesh = &self.bodies[body].mesh;
        let mut touched: Vec<u32> = match mesh.congruent {
            Some(period) => (0..period as u32).collect(),
            None => nodes.flat_map(|node| adjacency.elements(node)).copied().collect(),
        };
        touched.sort_unstable();
        touched.dedup();
        let matrix = |e: &u32| {
            let computed = self.local_matrices(body, *e as usize)?;
            Ok(match part {
                Part::Stiffness => computed.stiffness,
                Part::Mass => computed.mass(mesh.kind(*e as usize).element(), self.gamma),
            })
        };
        let matrices = touched.iter().map(matrix).collect::<Result<_, Refusal>>()?;
        Ok((touched, matrices))
    }
}

/// Adds the block of local nodes (a, b) of an element matrix with `n` nodes to the rows of a node.
fn add_block(
    part: Part,
    (matrix, n, d): (&[f64], usize, usize),
    (a, b): (usize, usize),
    rows: &mut [f64],
    (column, width): (usize, usize),
) {
    for i in 0..d {
        let row = &mut rows[i * width + column..][..d];
        match part {
            Part::Stiffness => {
                let block = &matrix[(a * d + i) * n * d + b * d..][..d];
                row.iter_mut().zip(block).for_each(|(sum, entry)| *sum += entry);
            }
            Part::Mass => row[i] += matrix[a * n + b],
        }
    }
}

/// The elements of each node.
struct Adjacency {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Adjacency {
    fn of(mesh: &Mesh) -> Self {
        let mut starts = vec![0_u32; mesh.nodes.len() + 1];
        mesh.connectivity.iter().for_each(|node| starts[*node as usize + 1] += 1);
        (0..mesh.nodes.len()).for_each(|node| starts[node + 1] += starts[node]);
        let (mut next, mut elements) = (starts.clone(), vec![0; mesh.connectivity.len()]);
        for e in 0..mesh.elements() {
            for node in mesh.element(e) {
                elements[next[*node as usize] as usize] = e as u32;
                next[*node as usize] += 1;
            }
        }
        Self { starts, elements }
    }

    fn elements(&self, node: usize) -> &[u32] {
        &self.elements[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// The nodes that share an element with `node`, itself included, ascending.
    fn neighbours(&self, mesh: &Mesh, node: usize) -> Vec<u32> {
        let elements = self.elements(node).iter();
        let mut near: Vec<u32> = elements.flat_map(|e| mesh.element(*e as usize)).copied().collect();
        near.sort_unstable();
        near.dedup();
        near
    }
}
