//! M' of a pencil: which unknowns lose their mass, and which take it.

use crate::error::Refusal;
use crate::pencil::{Matrix, Pencil, Tridiagonal};
use crate::sparse::Csr;

/// The unknowns of the contacts, ascending.
pub(super) fn massless(pencil: &Pencil) -> Vec<usize> {
    let mut found: Vec<usize> =
        pencil.gaps().iter().flat_map(|gap| gap.column.0.iter().map(|(i, _)| *i as usize)).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// The pencil with M' in place of M; massless unknowns have 1 kg there, which nothing may use.
pub(super) fn redistributed(pencil: &Pencil, massless: &[usize]) -> Result<Pencil, Refusal> {
    let (n, mass) = (pencil.size(), pencil.mass());
    let mut removed = vec![false; n];
    massless.iter().for_each(|i| removed[*i] = true);
    let mut own: Vec<f64> = (0..n).map(|i| mass.diagonal(i)).collect();
    for i in massless {
        // What it has, what it shares with one that keeps its mass, twice, and half of what it shares with one that does not:
        // z'Mz of a translation z keeps its value.
        let beside = mass.row(*i).filter(|(j, _)| j != i);
        let beside: f64 = beside.map(|(j, m)| if removed[j] { m } else { 2.0 * m }).sum();
        let (total, takers) = (mass.diagonal(*i) + beside, takers(pencil, &removed, *i)?);
        // As consistent masses of elements of second order have it.
        if total <= 0.0 {
            let allowed = "a lumped mass, or elements of first order";
            return Err(Refusal::new(
                "mass redistribution",
                format!("unknown {i} with {total:e} kg"),
                allowed,
            ));
        }
        takers.iter().for_each(|j| own[*j] += total / takers.len() as f64);
    }
    massless.iter().for_each(|i| own[*i] = 1.0);
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

/// The nearest unknowns with mass that move in the direction of `start`: those of the nodes that share an element with its node, or
/// if all these are massless, with one of them.
fn takers(pencil: &Pencil, removed: &[bool], start: usize) -> Result<Vec<usize>, Refusal> {
    let (k, directions) = (pencil.stiffness(), pencil.directions());
    let refused = |i: usize, what: &str| {
        let allowed = "a mesh or bars, with a node inside the body for each node in contact";
        Refusal::new("mass redistribution", format!("unknown {i} {what}"), allowed)
    };
    let (mut seen, mut edge) = (vec![start], vec![start]);
    while !edge.is_empty() {
        let mut next = Vec::new();
        for i in edge {
            for (j, stiffness) in k.row(i).filter(|(j, stiffness)| *j != i && *stiffness != 0.0) {
                if directions.is_empty() && stiffness > 0.0 {
                    return Err(refused(i, "moves in a direction that is not known"));
                }
                let aside = !directions.is_empty() && directions[i] != directions[j];
                if !aside && !seen.contains(&j) {
                    seen.push(j);
                    next.push(j);
                }
            }
        }
        let inside: Vec<usize> = next.iter().copied().filter(|j| !removed[*j]).collect();
        if !inside.is_empty() {
            return Ok(inside);
        }
        edge = next;
    }
    Err(refused(start, "with no mass inside the body in its direction"))
}
