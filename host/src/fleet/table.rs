//! The table over all machines: CSV for other tools, text for a terminal.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::Context;

use super::row::Row;
use crate::file::write_whole;
use crate::report::text::number;

/// The CSV's columns.
pub const COLUMNS: [&str; 12] = [
    "machine",
    "verdict",
    "effects",
    "tied",
    "shrink",
    "noise_factor",
    "noise_floor",
    "b",
    "c",
    "f1",
    "seconds",
    "reason",
];

/// Writes the table as CSV, whole. Effects are separated by `+`; what is not known is empty.
///
/// # Errors
/// A file that cannot be written.
pub fn write_csv(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    write_whole(path, |out| {
        let mut csv = csv::Writer::from_writer(out);
        csv.write_record(COLUMNS)?;
        for row in rows {
            let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
            csv.write_record([
                row.machine.clone(),
                row.verdict.clone().unwrap_or_default(),
                row.effects.join("+"),
                row.tied.join("+"),
                number(row.shrink),
                number(row.noise_factor),
                number(row.noise_floor),
                number(row.base[0]),
                number(row.base[1]),
                number(row.base[2]),
                number(row.seconds),
                row.reason.clone().unwrap_or_default(),
            ])?;
        }
        csv.flush()
    })
    .with_context(|| format!("cannot write {}", path.display()))
}

/// The table for a terminal.
pub fn in_words(rows: &[Row]) -> String {
    let mut cells = vec![["machine", "verdict", "what is missing", "shrink", "× noise", "s"].map(str::to_owned)];
    for row in rows.iter().filter(|row| row.reason.is_none()) {
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| number(value, 3));
        cells.push([
            row.machine.clone(),
            row.verdict.clone().unwrap_or_default().replace('_', " "),
            row.missing(),
            number(row.shrink),
            number(row.noise_factor),
            number(row.seconds) + if row.skipped { " (kept)" } else { "" },
        ]);
    }
    let wide = |column: usize| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(wide);
    let mut text = String::new();
    // Writing to a String cannot fail.
    for row in cells.iter().filter(|_| cells.len() > 1) {
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(text, "{cell:<width$}  ");
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    for row in rows {
        if let Some(reason) = &row.reason {
            let _ = writeln!(text, "{}: failed: {reason}", row.machine);
        }
    }
    text
}
