//! Two blocks of bilinear squares, pressed together, and dense eigenvalues beside them.

use bipenalty::convex::patches::{ElementMatrices, boxes};
use bipenalty::convex::{Elements, MeshPencil, Patches};
use bipenalty::pencil::Gap;
use bipenalty::sparse::SparseVector;
use faer::Side;

use crate::reduced::reduced;

/// Bilinear square of unit side and density, plane stress, nu = 0.3, 2 x 2 Gauss points, lumped.
fn square(youngs: f64) -> ElementMatrices {
    let nu: f64 = 0.3;
    let c = youngs / (1.0 - nu * nu);
    let d = [[c, nu * c, 0.0], [nu * c, c, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu) * c]];
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut k = vec![0.0; 64];
    let g = 1.0 / 3.0_f64.sqrt();
    for (x, y) in corners.map(|(x, y): (f64, f64)| (g * x, g * y)) {
        let b: Vec<[f64; 3]> = corners
            .iter()
            .flat_map(|(a, e)| {
                let (nx, ny) = (0.5 * a * (1.0 + e * y), 0.5 * e * (1.0 + a * x));
                [[nx, 0.0, ny], [0.0, ny, nx]]
            })
            .collect();
        for i in 0..8 {
            for j in 0..8 {
                let stress: Vec<f64> =
                    d.iter().map(|row| row.iter().zip(&b[j]).map(|(d, b)| d * b).sum()).collect();
                k[8 * i + j] += 0.25 * b[i].iter().zip(&stress).map(|(b, s)| b * s).sum::<f64>();
            }
        }
    }
    let mirrored: Vec<f64> = (0..64).map(|at| 0.5 * (k[at] + k[at % 8 * 8 + at / 8])).collect();
    let mass = (0..64).map(|at| if at % 9 == 0 { 0.25 } else { 0.0 }).collect();
    ElementMatrices { stiffness: mirrored, mass }
}

/// Two blocks of `width` x `height` squares each, one above the other, node to node in contact.
pub struct Blocks {
    pub elements: Elements,
    centres: Vec<[f64; 3]>,
    contacts: Vec<Gap>,
    unknowns: usize,
}

impl Blocks {
    pub fn new(width: usize, height: usize, youngs: [f64; 2]) -> Self {
        let nodes = (width + 1) * (height + 1);
        let node = |block: usize, x: usize, y: usize| (block * nodes + y * (width + 1) + x) as u32;
        let mut elements =
            Elements { shapes: youngs.iter().map(|e| square(*e)).collect(), elements: Vec::new() };
        if youngs[0] == youngs[1] {
            elements.shapes.truncate(1);
        }
        let mut centres = Vec::new();
        for block in 0..2 {
            for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
                let corners =
                    [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)].map(|(x, y)| node(block, x, y));
                let unknowns = corners.iter().flat_map(|i| [Some(2 * i), Some(2 * i + 1)]).collect();
                elements.elements.push((block.min(elements.shapes.len() - 1), unknowns));
                centres.push([x as f64 + 0.5, (block * height + y) as f64 + 0.5, 0.0]);
            }
        }
        let contacts = (0..=width)
            .map(|x| {
                let gap =
                    SparseVector(vec![(2 * node(0, x, height) + 1, 1.0), (2 * node(1, x, 0) + 1, -1.0)]);
                let soft = youngs[0].min(youngs[1]);
                Gap { column: gap, initial: 0.0, scale: soft * if x == 0 || x == width { 0.5 } else { 1.0 } }
            })
            .collect();
        Self { elements, centres, contacts, unknowns: 4 * nodes }
    }

    pub fn pencil(&self) -> MeshPencil {
        let (stiffness, mass) = self.elements.assemble(self.unknowns);
        MeshPencil::new(stiffness, mass, self.contacts.clone()).unwrap()
    }

    pub fn patches(&self, pencil: &MeshPencil, size: f64) -> Patches {
        Patches::new(pencil, &self.elements, &boxes(&self.centres, [size; 3]), 1 << 30).unwrap()
    }
}

/// l_max(a K + t P, M) by dense reduction.
pub fn dense_largest(pencil: &MeshPencil, a: f64, t: f64) -> f64 {
    *reduced(pencil, a, t).0.self_adjoint_eigenvalues(Side::Lower).unwrap().last().unwrap()
}
