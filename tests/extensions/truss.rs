//! A pencil from matrices of one's own: a plane truss of six joints, x and y each, lumped mass, its right side before an
//! inclined wall, two joints of its lower chord against each other.

use bipenalty::error::Refusal;
use bipenalty::pencil::{Bounds, Gap, Matrix, Pencil};
use bipenalty::sparse::{Csr, SparseVector};

pub fn truss() -> Result<Pencil, Refusal> {
    let joints = [(0.0, 0.0), (1.0, 0.1), (2.0, 0.0), (0.1, 1.0), (1.0, 1.2), (2.1, 0.9)];
    let rods = [(0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5), (0, 4), (1, 3), (1, 5), (2, 4)];
    let (mut entries, mut mass) = (Vec::new(), vec![0.0; 12]);
    for (a, b) in rods {
        let ((xa, ya), (xb, yb)): ((f64, f64), (f64, f64)) = (joints[a], joints[b]);
        let (dx, dy) = (xb - xa, yb - ya);
        let length = dx.hypot(dy);
        let column = [(2 * a, -dx), (2 * a + 1, -dy), (2 * b, dx), (2 * b + 1, dy)];
        for (i, x) in column {
            mass[i] += 0.5 * length;
            entries.extend(column.map(|(j, y)| (i as u32, j as u32, x * y / length.powi(3))));
        }
    }
    let stiffness = Matrix::Sparse(Csr::from_triplets(12, 12, &entries));
    let gap = |column: Vec<(u32, f64)>| Gap { column: SparseVector(column), scale: 1.0, initial: 0.0 };
    let wall = |joint: u32| gap(vec![(2 * joint, 0.8), (2 * joint + 1, -0.6)]);
    let gaps = vec![wall(2), wall(5), gap(vec![(1, 0.5), (3, -1.0), (5, 0.5)])];
    let bounds = Bounds::of_lumped(&stiffness, &mass);
    Pencil::new(stiffness, Matrix::Diagonal(mass), gaps, bounds, bounds.stiffness)
}
