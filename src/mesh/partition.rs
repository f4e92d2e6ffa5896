//! Elements in patches of a given size: blocks of cells of a box, and of other meshes halves of halves along the longest
//! side (recursive coordinate bisection; Berger, Bokhari, IEEE Trans. Comput. 36, 1987).

use std::collections::HashMap;

use super::assembly::Elements;
use super::element::Coordinates;

impl Elements {
    /// The number of the patch of each element, ascending from 0 without a gap; a patch holds the elements of about `edge`
    /// cells along each direction, of one body.
    pub fn patches(&self, edge: usize) -> Vec<usize> {
        let mut patch = vec![0; self.len()];
        let mut next = 0;
        for body in 0..self.bodies.len() {
            let elements = self.first[body].1..self.first[body + 1].1;
            let centres: Vec<Coordinates> = elements.clone().map(|e| self.centre(e)).collect();
            let own = &mut patch[elements];
            let first = next;
            next += match self.bodies[body].mesh.congruent {
                Some(period) => blocks(&centres, self.cell(body, period), edge, own),
                None => {
                    let mut all: Vec<usize> = (0..centres.len()).collect();
                    let mut count = 0;
                    halve(&centres, &mut all, self.most_elements(body, edge), &mut count, own);
                    count
                }
            };
            own.iter_mut().for_each(|p| *p += first);
        }
        patch
    }

    /// The lower corner of a box and the edges of its cells: what the first `period` elements fill.
    fn cell(&self, body: usize, period: usize) -> [Coordinates; 2] {
        let mesh = &self.bodies[body].mesh;
        let places: Vec<Coordinates> =
            (0..period.min(mesh.elements())).flat_map(|e| mesh.places(e)).collect();
        let end =
            |i: usize, pick: fn(f64, f64) -> f64, from: f64| places.iter().map(|x| x[i]).fold(from, pick);
        let low = std::array::from_fn(|i| end(i, f64::min, f64::INFINITY));
        [low, std::array::from_fn(|i| end(i, f64::max, f64::NEG_INFINITY) - low[i])]
    }

    /// Elements of a patch of `edge` cells: a cell is a square or a cube, or the two triangles or six tetrahedra that fill one.
    fn most_elements(&self, body: usize, edge: usize) -> usize {
        let mesh = &self.bodies[body].mesh;
        let simplex = mesh.elements() > 0 && mesh.kind(0).element().is_simplex();
        let cell = if !simplex {
            1
        } else if self.dimension == 2 {
            2
        } else {
            6
        };
        cell * edge.saturating_pow(self.dimension as u32)
    }
}

/// The block of each centre, numbered in the order of their first elements; how many there are.
fn blocks(centres: &[Coordinates], [low, size]: [Coordinates; 2], edge: usize, patch: &mut [usize]) -> usize {
    let mut numbers: HashMap<[usize; 3], usize> = HashMap::new();
    // Centres lie inside of cells, far from the next one; in the plane the third size is 0.
    let cell = |centre: &Coordinates, i: usize| {
        if size[i] > 0.0 { ((centre[i] - low[i]) / size[i]).max(0.0) as usize } else { 0 }
    };
    // Pieces that differ by a cell at most: one of a single cell would be as high as an element.
    let cells = [0, 1, 2].map(|i| centres.iter().map(|centre| cell(centre, i) + 1).max().unwrap_or(1));
    let pieces = cells.map(|n| ((n + edge / 2) / edge).max(1));
    for (centre, patch) in centres.iter().zip(patch) {
        let next = numbers.len();
        *patch = *numbers.entry([0, 1, 2].map(|i| cell(centre, i) * pieces[i] / cells[i])).or_insert(next);
    }
    numbers.len()
}

/// Numbers `elements` by halves until one holds at most `most`.
fn halve(
    centres: &[Coordinates],
    elements: &mut [usize],
    most: usize,
    count: &mut usize,
    patch: &mut [usize],
) {
    if elements.len() <= most.max(1) {
        elements.iter().for_each(|e| patch[*e] = *count);
        *count += usize::from(!elements.is_empty());
        return;
    }
    let extent = |i: usize| {
        let along = || elements.iter().map(|e| centres[*e][i]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let extents = [extent(0), extent(1), extent(2)];
    let axis = (0..3).fold(0, |best, i| if extents[i] > extents[best] { i } else { best });
    let middle = elements.len() / 2;
    // By place, and by number where places are the same, so that the halves do not depend on chance.
    elements.select_nth_unstable_by(middle, |a, b| {
        centres[*a][axis].total_cmp(&centres[*b][axis]).then(a.cmp(b))
    });
    let (left, right) = elements.split_at_mut(middle);
    halve(centres, left, most, count, patch);
    halve(centres, right, most, count, patch);
}

#[cfg(test)]
mod tests {
    use super::super::MeshScene;
    use crate::fem::MassMatrix;

    fn sizes(element: &str, edge: usize) -> Vec<usize> {
        let text = format!(
            "name = \"b\"\ndimension = 2\nplane = \"strain\"\n[[body]]\nname = \"a\"\nbox = [7.0, 4.0]\ncells = [7, 4]\n\
             element = \"{element}\"\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\ndensity = 1.0\n"
        );
        let mut elements = MeshScene::parse(&text, "b")
            .and_then(|scene| scene.assemble(MassMatrix::LUMPED))
            .map(|a| a.elements)
            .unwrap();
        let count = |patch: Vec<usize>| {
            let mut sizes = vec![0; patch.iter().max().unwrap() + 1];
            patch.iter().for_each(|p| sizes[*p] += 1);
            sizes
        };
        let blocks = count(elements.patches(edge));
        elements.bodies[0].mesh.congruent = None;
        let halves = count(elements.patches(edge));
        assert!(halves.iter().all(|n| (1..=blocks[0]).contains(n)), "{halves:?}");
        assert_eq!(halves.iter().sum::<usize>(), elements.len());
        blocks
    }

    #[test]
    fn blocks_of_cells_and_halves_of_halves() {
        assert_eq!(sizes("quad4", 2), [4, 4, 4, 2, 4, 4, 4, 2]);
        assert_eq!(sizes("tri3", 4), [32, 24]);
        assert_eq!(sizes("quad8", 100), [28]);
    }
}
