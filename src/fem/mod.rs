//! Linear two-node bar elements: element matrices, the family of mass matrices, assembly into a [`Pencil`].
//!
//! ```text
//! K_e = EA/h [ 1 -1 ; -1 1 ]      M_e = rho h A/6 [ 2+g 1-g ; 1-g 2+g ]      g = gamma in [0, 1]
//! ```
//! The free element has the squared frequency omega_e^2 = 12/(1+2g) (c0/h)^2 (paper, (26) and (27)).
//!
//! ```
//! use bipenalty::fem::MassMatrix;
//! use bipenalty::scene::load;
//! let (scene, mass) = (load("signorini")?, MassMatrix::LUMPED);
//! // h = 0.1 m, c0 = 100 m/s: omega_e = 2 c0/h = 2000 rad/s.
//! assert!((mass.element_eigenvalue(&scene.bars()[0]).sqrt() - 2000.0).abs() < 1e-9);
//! # Ok::<(), bipenalty::error::Error>(())
//! ```

mod elements;

pub use elements::{FiniteElement, assemble_elements};

use crate::error::Refusal;
use crate::pencil::{Bounds, Gap, Matrix, Pencil, Scale, Tridiagonal};
use crate::scene::{Bar, ContactSite, End, Scene};
use crate::sparse::SparseVector;

/// The mass matrix of the family gamma in [0, 1]: 0 consistent, 1/2 averaged, 1 lumped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MassMatrix(f64);

impl MassMatrix {
    /// gamma = 0.
    pub const CONSISTENT: Self = Self(0.0);
    /// gamma = 1/2.
    pub const AVERAGED: Self = Self(0.5);
    /// gamma = 1, diagonal.
    pub const LUMPED: Self = Self(1.0);

    /// The mass matrix of this gamma.
    ///
    /// # Errors
    /// Refuses a gamma outside [0, 1], where the element mass could lose its meaning or its sign.
    pub fn new(gamma: f64) -> Result<Self, Refusal> {
        if (0.0..=1.0).contains(&gamma) {
            Ok(Self(gamma.abs()))
        } else {
            Err(Refusal::new("gamma", gamma, "a number in [0, 1]"))
        }
    }

    /// gamma, dimensionless.
    pub fn gamma(self) -> f64 {
        self.0
    }

    /// Whether the matrix is diagonal, so that no solve is needed.
    pub fn is_lumped(self) -> bool {
        self.0 == 1.0
    }

    /// What the user calls it: `lumped`, `averaged`, `consistent`, or the number gamma.
    pub fn name(self) -> String {
        match self.0 {
            0.0 => "consistent".to_owned(),
            0.5 => "averaged".to_owned(),
            1.0 => "lumped".to_owned(),
            gamma => gamma.to_string(),
        }
    }

    /// 12/(1+2 gamma): the squared frequency of the free element in units of (c0/h)^2.
    pub fn element_factor(self) -> f64 {
        12.0 / (1.0 + 2.0 * self.0)
    }

    /// (2 + gamma)/6 and (1 - gamma)/6: diagonal and off-diagonal entry of the element mass, in units of rho h A.
    pub fn entries(self) -> (f64, f64) {
        ((2.0 + self.0) / 6.0, (1.0 - self.0) / 6.0)
    }

    /// omega_e^2 of the free element of `bar`, rad^2/s^2.
    pub fn element_eigenvalue(self, bar: &Bar) -> f64 {
        self.element_factor() * (bar.element_stiffness() / bar.element_mass())
    }
}

/// The contact-free pencil of a scene, with the gap of each of its contacts.
///
/// The nodes run from left to right, bar after bar; a fixed end has no node.
pub fn assemble(scene: &Scene, mass: MassMatrix) -> Pencil {
    assemble_up_to(usize::MAX, scene, mass)
}

/// The pencil of the same scene with at most four elements of the same length in a bar: it has every entry of the
/// whole one, and the same bound of the stiffness.
pub fn assemble_shortened(scene: &Scene, mass: MassMatrix) -> Pencil {
    assemble_up_to(4, scene, mass)
}

/// Bytes of the assembled pencil: four vectors of nodes, of which those of several bars grow by doubling.
pub fn pencil_bytes(scene: &Scene) -> u64 {
    2 * 4 * 8 * (scene.elements() + scene.bars().len()) as u64
}

fn assemble_up_to(most_elements: usize, scene: &Scene, mass: MassMatrix) -> Pencil {
    let mut stiffness = Tridiagonal::default();
    let mut inertia = Tridiagonal::default();
    let last = scene.bars().len() - 1;
    let mut bar_ends = Vec::with_capacity(last + 1);
    for (i, bar) in scene.bars().iter().enumerate() {
        let fixed = (i == 0 && scene.left() == End::Fixed, i == last && scene.right() == End::Fixed);
        let nodes = bar.elements.min(most_elements) + 1;
        append_bar(&mut stiffness, nodes, bar.element_stiffness(), (1.0, -1.0), fixed);
        append_bar(&mut inertia, nodes, bar.element_mass(), mass.entries(), fixed);
        bar_ends.push(stiffness.diagonal.len() - 1);
    }
    let distances = scene.impact().map_or(&[][..], |impact| &impact.gaps);
    let gaps = scene.contact_sites().into_iter().enumerate().map(|(j, site)| Gap {
        column: SparseVector(match site {
            ContactSite::LeftWall => vec![(0, -1.0)],
            ContactSite::Between(bar) => vec![(bar_ends[bar] as u32, 1.0), (bar_ends[bar] as u32 + 1, -1.0)],
            ContactSite::RightWall => vec![(bar_ends[last] as u32, 1.0)],
        }),
        scale: contact_scale(scene, site).stiffness,
        initial: -distances.get(j).copied().unwrap_or(0.0),
    });
    // An element obeys |K_e| <= l_e M_e with its eigenvalue l_e, worst for alternating displacements, and
    // |M_e| <= 3/(1+2g) M_e; a sum of them obeys the largest of the bounds.
    let largest = scene.bars().iter().map(|bar| mass.element_eigenvalue(bar)).fold(0.0, f64::max);
    let bounds = Bounds { stiffness: largest, mass: 3.0 / (1.0 + 2.0 * mass.gamma()) };
    let (stiffness, inertia) = (Matrix::Chain(stiffness), Matrix::Chain(inertia));
    Pencil::of_elements(stiffness, inertia, gaps.collect(), bounds, reference_eigenvalue(scene, mass))
}

/// The bars that touch at `site`.
pub fn touching_bars(scene: &Scene, site: ContactSite) -> &[Bar] {
    let bars = scene.bars();
    match site {
        ContactSite::LeftWall => &bars[..1],
        ContactSite::Between(left) => &bars[left..left + 2],
        ContactSite::RightWall => &bars[bars.len() - 1..],
    }
}

/// The scale w of a contact: the smaller EA/h of the touching elements, N/m.
pub fn contact_scale(scene: &Scene, site: ContactSite) -> Scale {
    let touching = touching_bars(scene, site);
    let stiffness = touching.iter().map(Bar::element_stiffness).fold(f64::INFINITY, f64::min);
    Scale { stiffness, pair: touching.len() == 2 }
}

/// The scales of the contacts of `scene` from left to right.
pub fn contact_scales(scene: &Scene) -> Vec<Scale> {
    scene.contact_sites().into_iter().map(|site| contact_scale(scene, site)).collect()
}

/// The reference element of the Courant number C_r = c0 dt/h and of the penalty ratio: of all elements that touch a
/// contact, the one of the highest frequency, the leftmost on a tie. Without a contact, of all elements.
pub fn reference_bar(scene: &Scene, mass: MassMatrix) -> &Bar {
    let sites = scene.contact_sites();
    let touching = sites.iter().flat_map(|site| touching_bars(scene, *site));
    let candidates: Vec<&Bar> =
        if sites.is_empty() { scene.bars().iter().collect() } else { touching.collect() };
    let higher = |best: &'_ Bar, bar: &'_ Bar| mass.element_eigenvalue(bar) > mass.element_eigenvalue(best);
    candidates.iter().skip(1).fold(candidates[0], |best, bar| if higher(best, bar) { bar } else { best })
}

/// omega^2 of the reference element, rad^2/s^2: the one number in which the ratio of the penalty mass is measured.
pub fn reference_eigenvalue(scene: &Scene, mass: MassMatrix) -> f64 {
    mass.element_eigenvalue(reference_bar(scene, mass))
}

/// Appends the assembled matrix of one bar of `nodes`; `entries` are the diagonal and off-diagonal entry of its element
/// matrix in units of `unit`, `fixed` says which ends have no node.
fn append_bar(matrix: &mut Tridiagonal, nodes: usize, unit: f64, entries: (f64, f64), fixed: (bool, bool)) {
    let (end, inner, off) = (entries.0 * unit, 2.0 * (entries.0 * unit), entries.1 * unit);
    let range = usize::from(fixed.0)..nodes - usize::from(fixed.1);
    if !matrix.diagonal.is_empty() {
        matrix.off_diagonal.push(0.0);
    }
    matrix.off_diagonal.extend(std::iter::repeat_n(off, range.len() - 1));
    matrix.diagonal.extend(range.map(|node| if node == 0 || node + 1 == nodes { end } else { inner }));
}
