//! Recordings out, as log files that other programs open: MCAP and Parquet.
//!
//! Both are made from the recording as CSV, so that all three hold the same numbers and the same header.

#[cfg(feature = "logs")]
mod columns;
#[cfg(feature = "logs")]
mod mcap;
#[cfg(feature = "logs")]
mod parquet;

use std::io::{self, BufReader, Read, Write};
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
    /// What `csv` and `out` report; `InvalidData` where a row has no number in a column; `Unsupported` for log files in
    /// a build without them.
    pub fn write(self, csv: impl Read, out: &mut impl Write) -> io::Result<()> {
        let csv = BufReader::new(csv);
        match self {
            Self::Csv => io::copy(&mut { csv }, out).map(|_| ()),
            #[cfg(feature = "logs")]
            Self::Mcap => mcap::write(&columns::Columns::read(csv)?, out),
            #[cfg(feature = "logs")]
            Self::Parquet => parquet::write(&columns::Columns::read(csv)?, out),
            #[cfg(not(feature = "logs"))]
            Self::Mcap | Self::Parquet => Err(io::ErrorKind::Unsupported.into()),
        }
    }
}

#[cfg(test)]
mod tests;
