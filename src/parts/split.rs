//! A scene cut into parts of about as many elements each.

use super::elements;
use super::share::Share;
use crate::convex::patches::Group;
use crate::convex::sharing::groups;
use crate::error::{Refusal, Result};
use crate::fem::MassMatrix;
use crate::mesh::{self, MeshScene};

/// Cuts a scene into `parts`, out of patches with about `edge` elements along an edge; and how many elements it has.
///
/// # Errors
/// What [`MeshScene::assemble`] refuses; fewer patches than parts.
pub fn split(scene: &MeshScene, mass: MassMatrix, parts: usize, edge: usize) -> Result<(Vec<Share>, usize)> {
    let assembled = scene.assemble(mass)?;
    let (elements, n) = (elements(&assembled.elements)?, assembled.stiffness.rows());
    let patch = assembled.elements.patches(edge.max(1));
    let patches = groups(&assembled.gaps(), n, &elements, &patch)?;
    if parts == 0 || patches.len() < parts {
        let value = format!("{parts} of scene {}", scene.name);
        let allowed = format!("1 to {}, one patch of elements each", patches.len());
        return Err(Refusal::new("parts", value, allowed).into());
    }
    let centres: Vec<[f64; 3]> = patches.iter().map(|group| centre(&assembled.elements, group)).collect();
    let mut chosen: Vec<Vec<&Group>> = Vec::new();
    bisect((0..patches.len()).collect(), parts, &patches, &centres, &mut |members| {
        chosen.push(members.iter().map(|p| &patches[*p]).collect());
    });
    let shares = chosen.iter().map(|chosen| Share::of(&elements, chosen)).collect();
    Ok((shares, assembled.elements.len()))
}

fn centre(mesh: &mesh::Elements, group: &Group) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (e, _) in &group.0 {
        let centre = mesh.centre(*e);
        (0..3).for_each(|axis| sum[axis] += centre[axis] / group.0.len() as f64);
    }
    sum
}

/// Halves the patches across their longest side until each of `parts` has its own; at least one patch each.
fn bisect(
    mut members: Vec<usize>,
    parts: usize,
    patches: &[Group],
    centres: &[[f64; 3]],
    take: &mut impl FnMut(&[usize]),
) {
    if parts == 1 {
        return take(&members);
    }
    let side = |axis: usize| {
        let places = || members.iter().map(|p| centres[*p][axis]);
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    };
    let axis = (0..3).max_by(|a, b| side(*a).total_cmp(&side(*b))).unwrap_or(0);
    members.sort_by(|p, q| centres[*p][axis].total_cmp(&centres[*q][axis]).then(p.cmp(q)));
    let (left, weight) = (parts / 2, |p: &usize| patches[*p].0.len());
    let goal = members.iter().map(weight).sum::<usize>() * left / parts;
    let mut sum = 0;
    let lighter = members.iter().take_while(|p| {
        sum += weight(p);
        sum <= goal
    });
    let cut = lighter.count().clamp(left, members.len() - (parts - left));
    let right = members.split_off(cut);
    bisect(members, left, patches, centres, take);
    bisect(right, parts - left, patches, centres, take);
}
