//! Lines of constant value on a grid with logarithmic axes (marching squares).

use std::collections::BTreeMap;

use super::model::DataPoint;

/// An edge of the grid: its lower left node (i, j), and whether it goes up.
type Edge = (usize, usize, bool);

/// The lines on which `values[j * x.len() + i]` at `(x[i], y[j])`, positive, pass `level`; between nodes the
/// logarithms are linear. Cells with a value that is not finite have no line.
pub fn isolines(x: &[f64], y: &[f64], values: &[f64], level: f64) -> Vec<Vec<DataPoint>> {
    let height = |i: usize, j: usize| values[j * x.len() + i].ln() - level.ln();
    let mut segments: Vec<[Edge; 2]> = Vec::new();
    for j in 0..y.len().saturating_sub(1) {
        for i in 0..x.len().saturating_sub(1) {
            let corners = [height(i, j), height(i + 1, j), height(i + 1, j + 1), height(i, j + 1)];
            if corners.iter().all(|corner| corner.is_finite()) {
                segments.extend(cell(
                    corners,
                    [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)],
                ));
            }
        }
    }
    let point = |(i, j, up): Edge| {
        let (k, l) = if up { (i, j + 1) } else { (i + 1, j) };
        let (a, b) = (height(i, j), height(k, l));
        let share = a / (a - b);
        let between = |from: f64, to: f64| if from == to { from } else { from * (to / from).powf(share) };
        (between(x[i], x[k]), between(y[j], y[l]))
    };
    chains(&segments).into_iter().map(|chain| chain.into_iter().map(point).collect()).collect()
}

/// The segments in one cell with corners and edges in turn.
fn cell(corners: [f64; 4], edges: [Edge; 4]) -> Vec<[Edge; 2]> {
    let crossed: Vec<Edge> =
        (0..4).filter(|k| (corners[*k] < 0.0) != (corners[(k + 1) % 4] < 0.0)).map(|k| edges[k]).collect();
    match crossed[..] {
        [a, b] => vec![[a, b]],
        // A saddle: the mean of the corners tells which of them hang together.
        [a, b, c, d] if (corners[0] < 0.0) == (corners.iter().sum::<f64>() < 0.0) => vec![[a, b], [c, d]],
        [a, b, c, d] => vec![[d, a], [b, c]],
        _ => Vec::new(),
    }
}

/// Segments joined end to end.
fn chains(segments: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut at: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
    for (index, ends) in segments.iter().enumerate() {
        ends.iter().for_each(|end| at.entry(*end).or_default().push(index));
    }
    let mut used = vec![false; segments.len()];
    // Open chains from their ends first, then what is left: closed ones.
    let open = at.iter().filter(|(_, around)| around.len() == 1).map(|(edge, _)| *edge);
    let starts: Vec<Edge> = open.chain(segments.iter().map(|[from, _]| *from)).collect();
    let mut chains = Vec::new();
    for start in starts {
        let mut chain = vec![start];
        let mut end = start;
        while let Some(next) = at[&end].iter().copied().find(|index| !used[*index]) {
            used[next] = true;
            let [from, to] = segments[next];
            end = if from == end { to } else { from };
            chain.push(end);
        }
        if chain.len() > 1 {
            chains.push(chain);
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_a_power_law_is_exact() {
        // v = x^2 / y is linear in logarithms, so interpolation is exact: v = 4 where y = x^2 / 4.
        let x: Vec<f64> = (0..9).map(|i| 2_f64.powi(i)).collect();
        let y: Vec<f64> = (0..7).map(|j| 3_f64.powi(j)).collect();
        let values: Vec<f64> = y.iter().flat_map(|y| x.iter().map(move |x| x * x / y)).collect();
        let lines = isolines(&x, &y, &values, 4.0);
        assert_eq!(lines.len(), 1);
        for (x, y) in &lines[0] {
            // A handful of roundings of logarithms of size 10 and of a power.
            assert!((x * x / 4.0 / y - 1.0).abs() < 64.0 * f64::EPSILON, "({x}, {y})");
        }
        let ends = [lines[0][0], lines[0][lines[0].len() - 1]];
        assert!(
            ends.iter().any(|end| end.1 == 1.0) && ends.iter().any(|end| end.1 == 729.0 || end.0 == 256.0)
        );
    }

    #[test]
    fn a_hill_has_a_closed_line_and_a_gap_none() {
        let axis: Vec<f64> = (0..5).map(|i| 10_f64.powi(i)).collect();
        let mut values = vec![1.0; 25];
        values[12] = 100.0;
        let lines = isolines(&axis, &axis, &values, 10.0);
        assert_eq!((lines.len(), lines[0].len()), (1, 5));
        assert_eq!(lines[0][0], lines[0][4]);
        values[12] = f64::NAN;
        assert!(isolines(&axis, &axis, &values, 10.0).is_empty());
    }
}
