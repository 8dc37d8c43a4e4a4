//! Recordings out, as log files that other programs open: MCAP and Parquet.
//!
//! Both are made from the recording as CSV, so that all three hold the same numbers and the same header.

mod mcap;
mod parquet;

use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

/// The form of a recording's file. Its name's ending tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Container {
    /// CSV.
    #[default]
    Csv,
    /// MCAP, one message in JSON for each row.
    Mcap,
    /// Parquet.
    Parquet,
}

impl Container {
    /// The form that a file's name asks for: CSV, unless it ends in `.mcap` or `.parquet`.
    pub fn of(path: &Path) -> Self {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        [Self::Mcap, Self::Parquet]
            .into_iter()
            .find(|own| ending.eq_ignore_ascii_case(own.ending()))
            .unwrap_or_default()
    }

    /// The ending of its files.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Mcap => "mcap",
            Self::Parquet => "parquet",
        }
    }

    /// Writes a recording, given as CSV, in this form.
    ///
    /// # Errors
    /// What `csv` and `out` report; `InvalidData` where a row has no number in a column.
    pub fn write(self, csv: impl Read, out: &mut impl Write) -> io::Result<()> {
        let csv = BufReader::new(csv);
        match self {
            Self::Csv => io::copy(&mut { csv }, out).map(|_| ()),
            Self::Mcap => mcap::write(&Columns::read(csv)?, out),
            Self::Parquet => parquet::write(&Columns::read(csv)?, out),
        }
    }
}

/// The program that writes the files, by which it knows them again.
fn library() -> String {
    format!("breakaway {}", env!("CARGO_PKG_VERSION"))
}

/// A recording as columns of numbers.
#[derive(Debug, Default, PartialEq)]
struct Columns {
    /// Key and value of each line of the header.
    header: Vec<(String, String)>,
    /// Name of each column, with its unit where that fits into a name: `t_s`, `u_V`, `x_rad`.
    names: Vec<String>,
    /// The columns, of equal length. An empty field is NaN.
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads a recording that breakaway wrote. Columns of words (`mode`) are left out.
    fn read(csv: impl BufRead) -> io::Result<Self> {
        let mut columns = Self::default();
        let mut of_numbers = Vec::new();
        for line in csv.lines() {
            let line = line?;
            if let Some(comment) = line.strip_prefix('#') {
                if let Some((key, value)) = comment.split_once(':').filter(|_| columns.names.is_empty()) {
                    columns.header.push((key.trim().to_owned(), value.trim().to_owned()));
                }
                continue;
            }
            let fields: Vec<&str> = line.split(',').collect();
            if columns.names.is_empty() {
                of_numbers = (0..fields.len()).filter(|i| fields[*i] != WORDS).collect();
                columns.names = of_numbers.iter().map(|i| columns.with_unit(fields[*i])).collect();
                columns.values = vec![Vec::new(); of_numbers.len()];
                continue;
            }
            for (i, values) in of_numbers.iter().zip(&mut columns.values) {
                let field = fields.get(*i).copied().unwrap_or_default();
                let number = if field.is_empty() { Ok(f64::NAN) } else { field.parse() };
                values.push(number.map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "a field is no number"))?);
            }
        }
        Ok(columns)
    }

    /// A column's name with the unit that the header gives it.
    fn with_unit(&self, column: &str) -> String {
        let units = self.header.iter().find(|(key, _)| key == "units").map_or("", |(_, list)| list.as_str());
        let of = |pair: &str| {
            let (name, unit) = pair.split_once('=')?;
            (name.trim() == column).then(|| unit.trim().to_owned())
        };
        let unit = units.split(',').find_map(of).or_else(|| (column == "t").then(|| "s".to_owned()));
        let fits = |unit: &String| !unit.is_empty() && unit.chars().all(|c| c.is_ascii_alphanumeric());
        let unit = unit.filter(fits).filter(|unit| !column.ends_with(&format!("_{unit}")));
        unit.map_or_else(|| column.to_owned(), |unit| format!("{column}_{unit}"))
    }

    fn rows(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }
}

/// The column of a capture that holds words: the board's mode.
const WORDS: &str = "mode";

#[cfg(test)]
mod tests;
