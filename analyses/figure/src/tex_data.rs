//! Where the points of a figure stand in the records: its TeX source reads them there.

use super::model::DataPoint;
use super::table::Table;

/// The tables of a figure as numbers.
pub(super) struct Columns<'a> {
    table: &'a Table,
    numbers: Vec<Vec<f64>>,
}

/// A block of rows of a table whose columns hold given numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Block {
    pub(super) file: String,
    /// Names of the columns.
    pub(super) columns: Vec<String>,
    /// First and last row, counted from 0 below the header.
    pub(super) rows: (usize, usize),
}

impl<'a> Columns<'a> {
    pub(super) fn of(table: &'a Table) -> Self {
        Self { table, numbers: (0..table.header.len()).map(|index| table.numbers(index)).collect() }
    }

    /// Every pair of columns that holds exactly these points in consecutive rows, the first block of each.
    pub(super) fn blocks(&self, points: &[DataPoint]) -> Vec<Block> {
        let (xs, ys): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let mut found: Vec<Block> = Vec::new();
        for start in 0..(self.table.rows.len() + 1).saturating_sub(points.len()) {
            for x in self.matching(start, &xs) {
                for y in self.matching(start, &ys) {
                    let block = self.block(start, points.len(), &[x, y]);
                    if !found.iter().any(|other| other.columns == block.columns) {
                        found.push(block);
                    }
                }
            }
        }
        found
    }

    /// The columns that hold `wanted` from row `start` on.
    fn matching<'s>(&'s self, start: usize, wanted: &'s [f64]) -> impl Iterator<Item = usize> + 's {
        let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
        (0..self.numbers.len()).filter(move |column| {
            let cells = self.numbers[*column][start..].iter().zip(wanted);
            cells.clone().count() == wanted.len() && cells.into_iter().all(|(a, b)| same(*a, *b))
        })
    }

    fn block(&self, start: usize, length: usize, columns: &[usize]) -> Block {
        Block {
            file: self.table.file.clone(),
            columns: columns.iter().map(|column| self.table.header[*column].clone()).collect(),
            rows: (start, start + length.max(1) - 1),
        }
    }
}
