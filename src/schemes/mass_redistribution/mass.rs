//! M' of a pencil, and the unknowns that have none.

use crate::error::Refusal;
use crate::pencil::{Heirs, Matrix, Pencil, Tridiagonal};
use crate::sparse::{Csr, SparseVector};

/// The unknowns without mass and who takes it over: as the mesh tells, or the matrices.
pub(super) fn heirs(pencil: &Pencil) -> Result<Heirs, Refusal> {
    let heirs = pencil.heirs().cloned().map_or_else(|| told_by_springs(pencil), Ok)?;
    match heirs.0.iter().find(|(_, shares)| shares.0.is_empty()) {
        Some((unknown, _)) => Err(refusal(*unknown, "with no node beside it that carries no gap")),
        None => Ok(heirs),
    }
}

/// Matrices of one direction: every unknown is a node, and its springs are the negative entries of its row. The mass goes
/// along them, in proportion to their stiffness.
fn told_by_springs(pencil: &Pencil) -> Result<Heirs, Refusal> {
    let k = pencil.stiffness();
    let mut touched: Vec<u32> = pencil.gaps().iter().flat_map(|gap| &gap.column.0).map(|(i, _)| *i).collect();
    touched.sort_unstable();
    touched.dedup();
    let of = |unknown: &u32| {
        let i = *unknown as usize;
        let springs = || k.row(i).filter(move |(j, k)| *j != i && *k != 0.0);
        if springs().any(|(_, k)| k > 0.0) {
            return Err(refusal(*unknown, "whose row does not tell its neighbours"));
        }
        let free = springs().filter(|(j, _)| touched.binary_search(&(*j as u32)).is_err());
        let free: Vec<(u32, f64)> = free.map(|(j, k)| (j as u32, k)).collect();
        let sum: f64 = free.iter().map(|(_, k)| k).sum();
        Ok((*unknown, SparseVector(free.into_iter().map(|(j, k)| (j, k / sum)).collect())))
    };
    touched.iter().map(of).collect::<Result<_, _>>().map(Heirs)
}

fn refusal(unknown: u32, what: &str) -> Refusal {
    let allowed = "scenes of [[body]], or matrices of one direction, K_ij <= 0 in the rows of contacts; beside each node that \
                   carries a gap one that carries none";
    Refusal::new("mass redistribution", format!("unknown {unknown} {what}"), allowed)
}

/// The pencil with M' in place of M; massless unknowns have 1 kg there, which nothing may use.
pub(super) fn redistributed(pencil: &Pencil, heirs: &Heirs) -> Result<Pencil, Refusal> {
    let (n, mass) = (pencil.size(), pencil.mass());
    let mut removed = vec![false; n];
    heirs.0.iter().for_each(|(i, _)| removed[*i as usize] = true);
    let mut gained = vec![0.0; n];
    for (unknown, shares) in &heirs.0 {
        let i = *unknown as usize;
        // What the node has and shares: 1'M 1 keeps its value.
        let part = |(j, m): (usize, f64)| if removed[j] { m } else { 2.0 * m };
        let total: f64 = mass.row(i).map(part).sum();
        shares.0.iter().for_each(|(j, share)| gained[*j as usize] += share * total);
    }
    if let Some(j) = (0..n).find(|j| gained[*j] < 0.0) {
        let value = format!("unknown {j} would lose {:e} kg", -gained[j]);
        let allowed = "lumped mass, or elements whose consistent mass leaves what they lend not negative";
        return Err(Refusal::new("mass redistribution", value, allowed));
    }
    let own: Vec<f64> = (0..n).map(|i| if removed[i] { 1.0 } else { mass.diagonal(i) + gained[i] }).collect();
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
    Ok(pencil.with_mass(mass))
}
