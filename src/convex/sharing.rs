//! Which patch takes which element and contact, and what share of it.

use std::collections::HashMap;

use super::patches::{Elements, Group};
use crate::error::Refusal;
use crate::pencil::Gap;

/// Patches that contacts join become one up to this multiple of the elements of the largest patch: two blocks that face each
/// other, with room for a third where they do not match.
pub const JOINED: usize = 3;

/// The elements at each unknown.
struct Touching {
    starts: Vec<usize>,
    elements: Vec<u32>,
}

impl Touching {
    fn new(elements: &Elements, n: usize) -> Self {
        let mut starts = vec![0_usize; n + 1];
        let unknowns = || {
            let with = |(e, (_, unknowns)): (usize, &(usize, Vec<Option<u32>>))| {
                unknowns.iter().flatten().map(move |i| (e as u32, *i as usize)).collect::<Vec<_>>()
            };
            elements.elements.iter().enumerate().flat_map(with)
        };
        unknowns().for_each(|(_, i)| starts[i + 1] += 1);
        (0..n).for_each(|i| starts[i + 1] += starts[i]);
        let (mut next, mut list) = (starts.clone(), vec![0; starts[n]]);
        for (e, i) in unknowns() {
            list[next[i]] = e;
            next[i] += 1;
        }
        Self { starts, elements: list }
    }

    fn at(&self, i: u32) -> &[u32] {
        &self.elements[self.starts[i as usize]..self.starts[i as usize + 1]]
    }
}

/// The patches of each element, the first its own.
struct Shares {
    own: Vec<usize>,
    /// Further patches of the few elements that have some.
    further: HashMap<u32, Vec<usize>>,
}

impl Shares {
    fn of(&self, e: u32) -> impl Iterator<Item = usize> + '_ {
        let further = self.further.get(&e).into_iter().flatten().copied();
        std::iter::once(self.own[e as usize]).chain(further)
    }

    fn share(&self, e: u32) -> f64 {
        1.0 / self.of(e).count() as f64
    }

    /// The patches at an unknown, ascending.
    fn at(&self, touching: &Touching, i: u32) -> Vec<usize> {
        let mut found: Vec<usize> = touching.at(i).iter().flat_map(|e| self.of(*e)).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// The unknowns of a contact.
fn unknowns(contact: &Gap) -> impl Iterator<Item = u32> + '_ {
    contact.column.0.iter().filter(|(_, z)| *z != 0.0).map(|(i, _)| *i)
}

/// The patches that hold all unknowns of a contact.
fn common(contact: &Gap, touching: &Touching, shares: &Shares) -> Vec<usize> {
    let mut at = unknowns(contact).map(|i| shares.at(touching, i));
    let first = at.next().unwrap_or_default();
    at.fold(first, |kept, next| kept.into_iter().filter(|p| next.contains(p)).collect())
}

/// Shares out the elements of a mesh of n unknowns, and its contacts, among the patches that `patch` numbers.
///
/// # Errors
/// An unknown without an element.
pub fn groups(
    contacts: &[Gap],
    n: usize,
    elements: &Elements,
    patch: &[usize],
) -> Result<Vec<Group>, Refusal> {
    let touching = Touching::new(elements, n);
    if let Some(i) = (0..n).find(|i| touching.at(*i as u32).is_empty()) {
        let value = format!("none at unknown {}", i + 1);
        return Err(Refusal::new("elements", value, "an element at every unknown"));
    }
    let mut shares = Shares { own: patch.to_vec(), further: HashMap::new() };
    join(contacts, &touching, &mut shares);
    for contact in contacts {
        if common(contact, &touching, &shares).is_empty() {
            reach_out(contact, elements, &touching, &mut shares);
        }
    }
    let count = shares.own.iter().max().map_or(0, |most| most + 1);
    let mut groups: Vec<Group> = vec![(Vec::new(), Vec::new()); count];
    for e in 0..elements.elements.len() as u32 {
        let share = shares.share(e);
        shares.of(e).for_each(|p| groups[p].0.push((e as usize, share)));
    }
    for contact in contacts {
        share_out(contact, elements, &touching, &shares, &mut groups);
    }
    groups.retain(|(members, _)| !members.is_empty());
    Ok(groups)
}

/// Makes patches one that many contacts join, pair by pair, the pair of most contacts first.
fn join(contacts: &[Gap], touching: &Touching, shares: &mut Shares) {
    let mut pairs: HashMap<(usize, usize), usize> = HashMap::new();
    for contact in contacts {
        if !common(contact, touching, shares).is_empty() {
            continue;
        }
        let mut met: Vec<usize> = unknowns(contact).flat_map(|i| shares.at(touching, i)).collect();
        met.sort_unstable();
        met.dedup();
        for (k, p) in met.iter().enumerate() {
            met[k + 1..].iter().for_each(|q| *pairs.entry((*p, *q)).or_default() += 1);
        }
    }
    let mut order: Vec<_> = pairs.into_iter().collect();
    order.sort_unstable_by(|(a, n), (b, m)| m.cmp(n).then(a.cmp(b)));
    let count = shares.own.iter().max().map_or(0, |most| most + 1);
    let mut sizes = vec![0_usize; count];
    shares.own.iter().for_each(|p| sizes[*p] += 1);
    let most = JOINED * sizes.iter().max().copied().unwrap_or(0);
    let mut parent: Vec<usize> = (0..count).collect();
    for ((p, q), _) in order {
        let (a, b) = (root(&parent, p), root(&parent, q));
        if a != b && sizes[a] + sizes[b] <= most {
            let (low, high) = (a.min(b), a.max(b));
            parent[high] = low;
            sizes[low] += sizes[high];
        }
    }
    shares.own.iter_mut().for_each(|p| *p = root(&parent, *p));
}

fn root(parent: &[usize], mut p: usize) -> usize {
    while parent[p] != p {
        p = parent[p];
    }
    p
}

/// Gives the patch that holds most of a contact a share of an element at each unknown that it does not hold.
fn reach_out(contact: &Gap, elements: &Elements, touching: &Touching, shares: &mut Shares) {
    let mut counts: HashMap<usize, usize> = HashMap::new();
    unknowns(contact).flat_map(|i| shares.at(touching, i)).for_each(|p| *counts.entry(p).or_default() += 1);
    let Some((home, _)) = counts.into_iter().max_by(|(a, n), (b, m)| n.cmp(m).then(b.cmp(a))) else { return };
    let own: Vec<u32> = unknowns(contact).collect();
    for i in &own {
        if shares.at(touching, *i).contains(&home) {
            continue;
        }
        let held = |e: &&u32| {
            let of = &elements.elements[**e as usize].1;
            own.iter().filter(|i| of.contains(&Some(**i))).count()
        };
        // The first of those that hold most: the same in every run.
        if let Some(e) = touching.at(*i).iter().rev().max_by_key(held) {
            shares.further.entry(*e).or_default().push(home);
        }
    }
}

/// Gives a contact to the patches that hold it, by the stiffness z'K_p z of their elements.
fn share_out(contact: &Gap, elements: &Elements, touching: &Touching, shares: &Shares, groups: &mut [Group]) {
    let holders = common(contact, touching, shares);
    let mut weights = vec![if holders.len() == 1 { 1.0 } else { 0.0 }; holders.len()];
    if holders.len() > 1 {
        let mut near: Vec<u32> = unknowns(contact).flat_map(|i| touching.at(i)).copied().collect();
        near.sort_unstable();
        near.dedup();
        for e in near {
            let stiffness = shares.share(e) * stiffness_of(contact, elements, e as usize);
            for p in shares.of(e) {
                if let Some(at) = holders.iter().position(|holder| *holder == p) {
                    weights[at] += stiffness;
                }
            }
        }
        weights.iter_mut().for_each(|weight| *weight = weight.max(0.0));
    }
    let sum: f64 = weights.iter().sum();
    for (p, weight) in holders.iter().zip(&weights) {
        let share = if sum > 0.0 { weight / sum } else { 1.0 / holders.len() as f64 };
        if share > 0.0 {
            groups[*p].1.push(Gap { scale: share * contact.scale, ..contact.clone() });
        }
    }
}

/// z'K_e z.
fn stiffness_of(contact: &Gap, elements: &Elements, e: usize) -> f64 {
    let entry = |i: u32| contact.column.0.iter().find(|(at, _)| *at == i).map_or(0.0, |(_, z)| *z);
    let (shape, unknowns) = &elements.elements[e];
    let z: Vec<f64> = unknowns.iter().map(|i| i.map_or(0.0, entry)).collect();
    let k = &elements.shapes[*shape].stiffness;
    let row = |i: usize| -> f64 { z.iter().zip(&k[i * z.len()..]).map(|(z, k)| k * z).sum() };
    (0..z.len()).filter(|i| z[*i] != 0.0).map(|i| z[i] * row(i)).sum::<f64>()
}
