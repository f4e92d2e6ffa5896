//! The four families of shape functions, each for any dimension.

use super::{Coordinates, MOST_NODES, Shape};

const NONE: Shape = Shape { values: [0.0; MOST_NODES], gradients: [[0.0; 3]; MOST_NODES] };

/// 2^-d prod_k (1 + xi_k x_k), x the node.
pub(super) fn multilinear(dimension: usize, nodes: &[Coordinates], at: Coordinates) -> Shape {
    let mut shape = NONE;
    for (a, node) in nodes.iter().enumerate() {
        let factor = |k: usize| 0.5 * (1.0 + at[k] * node[k]);
        shape.values[a] = (0..dimension).map(factor).product();
        for i in 0..dimension {
            let others: f64 = (0..dimension).filter(|k| *k != i).map(factor).product();
            shape.gradients[a][i] = 0.5 * node[i] * others;
        }
    }
    shape
}

/// Corners 2^-d prod_k (1 + xi_k x_k) (sum_k xi_k x_k - (d - 1)); on an edge along e: 2^-(d-1) (1 - xi_e^2) prod_(k != e) (1 + xi_k x_k).
pub(super) fn serendipity(dimension: usize, nodes: &[Coordinates], at: Coordinates) -> Shape {
    let mut shape = multilinear(dimension, nodes, at);
    for (a, node) in nodes.iter().enumerate() {
        if let Some(edge) = (0..dimension).find(|k| node[*k] == 0.0) {
            // The factor of the edge is 1/2 in the multilinear product.
            let bubble = 1.0 - at[edge] * at[edge];
            let product = 2.0 * shape.values[a];
            shape.values[a] = bubble * product;
            (0..dimension).for_each(|i| shape.gradients[a][i] *= 2.0 * bubble);
            shape.gradients[a][edge] = -2.0 * at[edge] * product;
        } else {
            let product = shape.values[a];
            let sum = (0..dimension).map(|k| at[k] * node[k]).sum::<f64>() - (dimension as f64 - 1.0);
            shape.values[a] = product * sum;
            for i in 0..dimension {
                shape.gradients[a][i] = shape.gradients[a][i] * sum + product * node[i];
            }
        }
    }
    shape
}

/// Barycentric coordinates and their gradients: the first belongs to the origin.
fn barycentric(dimension: usize, at: Coordinates) -> Shape {
    let mut shape = NONE;
    shape.values[0] = 1.0 - at[..dimension].iter().sum::<f64>();
    for i in 0..dimension {
        shape.values[i + 1] = at[i];
        shape.gradients[0][i] = -1.0;
        shape.gradients[i + 1][i] = 1.0;
    }
    shape
}

/// L_a.
pub(super) fn linear_simplex(dimension: usize, at: Coordinates) -> Shape {
    barycentric(dimension, at)
}

/// Corners L_a (2 L_a - 1), edges 4 L_a L_b.
pub(super) fn quadratic_simplex(dimension: usize, edges: &[[usize; 2]], at: Coordinates) -> Shape {
    let (l, mut shape) = (barycentric(dimension, at), NONE);
    for a in 0..=dimension {
        shape.values[a] = l.values[a] * (2.0 * l.values[a] - 1.0);
        shape.gradients[a] = l.gradients[a].map(|g| g * (4.0 * l.values[a] - 1.0));
    }
    for (edge, &[a, b]) in edges.iter().enumerate() {
        let at = dimension + 1 + edge;
        shape.values[at] = 4.0 * l.values[a] * l.values[b];
        shape.gradients[at] = std::array::from_fn(|i| {
            4.0 * (l.gradients[a][i] * l.values[b] + l.values[a] * l.gradients[b][i])
        });
    }
    shape
}
