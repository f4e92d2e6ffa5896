//! M' of a pencil, and the springs of its contact nodes.

use crate::error::Refusal;
use crate::pencil::{Matrix, Pencil, Tridiagonal};
use crate::sparse::Csr;

/// A node without mass.
#[derive(Debug, Clone)]
pub(super) struct Massless {
    pub node: usize,
    /// z of its contact there.
    pub weight: f64,
    /// K_ii, N/m, and the rest of its row.
    pub stiffness: f64,
    pub springs: Vec<(usize, f64)>,
}

/// The massless nodes of every contact.
pub(super) fn massless(pencil: &Pencil) -> Result<Vec<Vec<Massless>>, Refusal> {
    let k = pencil.stiffness();
    let mut contact_of = vec![usize::MAX; pencil.size()];
    for (j, gap) in pencil.gaps().iter().enumerate() {
        for (node, _) in &gap.column.0 {
            if std::mem::replace(&mut contact_of[*node as usize], j) != usize::MAX {
                return Err(refusal(*node as usize, "in two contacts"));
            }
        }
    }
    let spring = |(node, z): &(u32, f64)| {
        let node = *node as usize;
        let springs: Vec<_> = k.row(node).filter(|(j, k)| *j != node && *k != 0.0).collect();
        if springs.is_empty() || springs.iter().any(|(_, k)| *k > 0.0) {
            return Err(refusal(node, "with no neighbour that its stiffness tells"));
        }
        if springs.iter().any(|(j, _)| contact_of[*j] != usize::MAX) {
            return Err(refusal(node, "beside another node in contact"));
        }
        Ok(Massless { node, weight: *z, stiffness: k.diagonal(node), springs })
    };
    pencil.gaps().iter().map(|gap| gap.column.0.iter().map(spring).collect()).collect()
}

fn refusal(node: usize, what: &str) -> Refusal {
    let allowed = "bars, each contact at nodes of its own with a node inside the body beside them";
    Refusal::new("mass redistribution", format!("unknown {node} {what}"), allowed)
}

/// The pencil with M' in place of M; massless nodes have 1 kg there, which nothing may use.
pub(super) fn redistributed(pencil: &Pencil, massless: &[Vec<Massless>]) -> Pencil {
    let (n, mass) = (pencil.size(), pencil.mass());
    let mut own: Vec<f64> = (0..n).map(|i| mass.diagonal(i)).collect();
    let mut removed = vec![false; n];
    for node in massless.iter().flatten() {
        removed[node.node] = true;
        // What the node has and shares: z'Mz of a translation keeps its value.
        let beside: f64 = mass.row(node.node).filter(|(j, _)| *j != node.node).map(|(_, m)| 2.0 * m).sum();
        let total = mass.diagonal(node.node) + beside;
        let stiffness: f64 = node.springs.iter().map(|(_, k)| k).sum();
        node.springs.iter().for_each(|(j, k)| own[*j] += total * k / stiffness);
    }
    (0..n).filter(|i| removed[*i]).for_each(|i| own[i] = 1.0);
    let kept = |i: usize, j: usize| !removed[i] && !removed[j];
    let mass = match mass {
        Matrix::Diagonal(_) => Matrix::Diagonal(own),
        Matrix::Chain(m) => {
            let off = m.off_diagonal.iter().enumerate();
            let off_diagonal = off.map(|(i, m)| if kept(i, i + 1) { *m } else { 0.0 }).collect();
            Matrix::Chain(Tridiagonal { diagonal: own, off_diagonal })
        }
        Matrix::Sparse(_) => {
            let beside = |i: usize| mass.row(i).filter(move |(j, _)| i != *j && kept(i, *j));
            let beside = (0..n).flat_map(|i| beside(i).map(move |(j, m)| (i as u32, j as u32, m)));
            let own = own.iter().enumerate().map(|(i, m)| (i as u32, i as u32, *m));
            Matrix::Sparse(Csr::from_triplets(n, n, &own.chain(beside).collect::<Vec<_>>()))
        }
    };
    pencil.with_mass(mass)
}
