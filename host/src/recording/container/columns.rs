//! A recording as columns of numbers, from its CSV.

use std::io::{self, BufRead};

/// The program that writes the files, by which it knows them again.
pub(super) fn library() -> String {
    format!("breakaway {}", env!("CARGO_PKG_VERSION"))
}

/// A recording as columns of numbers.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Columns {
    /// Key and value of each line of the header.
    pub(super) header: Vec<(String, String)>,
    /// Name of each column, with its unit where that fits into a name: `t_s`, `u_V`, `x_rad`.
    pub(super) names: Vec<String>,
    /// The columns, of equal length. An empty field is NaN.
    pub(super) values: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads a recording that breakaway wrote. Columns of words (`mode`) are left out.
    pub(super) fn read(csv: impl BufRead) -> io::Result<Self> {
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

    pub(super) fn rows(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }
}

/// The column of a capture that holds words: the board's mode.
const WORDS: &str = "mode";
