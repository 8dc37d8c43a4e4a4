//! The numbers of a figure as columns of a table.

use std::rc::Rc;

use crate::file::TABLE_MARK;

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, with the unit in brackets.
    pub header: String,
    /// Its cells.
    pub cells: Cells,
}

/// What stands in a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Numbers; what is not finite becomes an empty cell.
    Numbers(Rc<[f64]>),
    /// Words.
    Words(Vec<String>),
}

impl Column {
    /// Numbers of a (quantity, unit); `label` says of which curve, and is empty where there is one.
    pub fn new(named: (&str, &str), label: &str, values: &[f64]) -> Self {
        let (quantity, unit) = named;
        let curve = if label.is_empty() { String::new() } else { format!(": {label}") };
        let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        Self { header: format!("{quantity}{curve}{unit}"), cells: Cells::Numbers(values.into()) }
    }

    /// Words.
    pub fn words<'a>(header: &str, words: impl Iterator<Item = &'a str>) -> Self {
        Self { header: header.to_owned(), cells: Cells::Words(words.map(str::to_owned).collect()) }
    }

    /// The three columns of points (x, mean, standard error); axes are named by (quantity, unit).
    pub fn of_points(x: (&str, &str), y: (&str, &str), label: &str, points: &[[f64; 3]]) -> [Self; 3] {
        let part = |i: usize| points.iter().map(|point| point[i]).collect::<Vec<_>>();
        let error = format!("standard error of {}", y.0);
        [Self::new(x, label, &part(0)), Self::new(y, label, &part(1)), Self::new((&error, y.1), label, &part(2))]
    }

    fn len(&self) -> usize {
        match &self.cells {
            Cells::Numbers(values) => values.len(),
            Cells::Words(words) => words.len(),
        }
    }

    /// A cell; empty below the end of a short column.
    fn cell(&self, row: usize) -> String {
        match &self.cells {
            Cells::Numbers(values) => {
                values.get(row).filter(|value| value.is_finite()).map_or_else(String::new, f64::to_string)
            }
            Cells::Words(words) => words.get(row).map_or_else(String::new, |word| field(word)),
        }
    }
}

/// A field of CSV, quoted where it must be.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// The table of a figure.
pub fn csv(title: &str, columns: &[Column]) -> String {
    let title: String = title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let mut out = format!("{TABLE_MARK}{title}\n");
    let mut line = |cells: Vec<String>| {
        out.push_str(&cells.join(","));
        out.push('\n');
    };
    line(columns.iter().map(|column| field(&column.header)).collect());
    for row in 0..columns.iter().map(Column::len).max().unwrap_or(0) {
        line(columns.iter().map(|column| column.cell(row)).collect());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_units_quotes_what_it_must_and_leaves_cells_empty() {
        let columns = [
            Column::words("effects added", ["base, \"so\"", "+ x"].into_iter()),
            Column::new(("error", "rad"), "held out", &[0.1, f64::NAN, 2e-9]),
            Column::new(("share", ""), "", &[1.0]),
        ];
        let text = csv("A\nb", &columns);
        let rows = "effects added,error: held out (rad),share\n\"base, \"\"so\"\"\",0.1,1\n+ x,,\n,0.000000002,\n";
        assert_eq!(text, format!("{TABLE_MARK}A b\n{rows}"));
    }
}
