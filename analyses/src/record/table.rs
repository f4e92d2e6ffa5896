//! Records as a table of text, as they stand in a CSV file.

/// The rows of one CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of the file, without folder.
    pub file: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells, row by row, each as long as the header.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The table that `bytes`, hold.
    ///
    /// # Errors
    /// Bytes that are not CSV.
    pub fn of(file: impl Into<String>, bytes: &[u8]) -> Result<Self, csv::Error> {
        let mut reader = csv::Reader::from_reader(bytes);
        let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let header = cells(reader.headers()?);
        let rows = reader.records().map(|record| Ok(cells(&record?)));
        Ok(Self { file: file.into(), header, rows: rows.collect::<Result<_, csv::Error>>()? })
    }

    /// The cells of the column `name`; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<Vec<&str>> {
        let index = self.header.iter().position(|known| known == name)?;
        Some(self.rows.iter().map(|row| row[index].as_str()).collect())
    }

    /// The numbers of the column with this index; NaN where a cell is none.
    pub fn numbers(&self, index: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[index].parse().unwrap_or(f64::NAN)).collect()
    }
}
