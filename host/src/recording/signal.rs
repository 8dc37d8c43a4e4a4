//! One column of a recording, for what needs no drive.

use std::io::Read;
use std::path::Path;

use super::error::{ClockError, Place, RecordingError};
use super::formats::Log;
use super::options::ReadOptions;
use super::quality::Warning;
use super::table::{Table, Wanted};
use super::{MIN_ROWS, Source, file_stem, timing, units};
use crate::file::shown;

/// One signal over time. `t` increases strictly, all numbers are finite, the signal is not constant, and there are at least [`MIN_ROWS`].
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Name of the recording.
    pub name: String,
    /// Name of the column.
    pub column: String,
    /// Unit of the column, where it is known.
    pub unit: Option<String>,
    /// Time, s.
    pub t: Vec<f64>,
    /// The signal.
    pub y: Vec<f64>,
    /// Rows at which a new piece begins because samples before it are missing.
    pub gaps: Vec<usize>,
}

impl Signal {
    /// Reads column `column` (the position if `None`) of the file at `path`.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column.
    pub fn read(path: &Path, column: Option<&str>, options: &ReadOptions) -> Result<Self, RecordingError> {
        Self::read_from(&shown(path), Source::open(path)?, column, options)
    }

    /// Reads from `input`; `file` is its name in messages.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column; [`ClockError::TimeDecreases`] if the clock starts anew. Any rate is
    /// taken: a reference may have a row for every few seconds.
    pub fn read_from(
        file: &str,
        input: impl Read,
        column: Option<&str>,
        options: &ReadOptions,
    ) -> Result<Self, RecordingError> {
        let (signal, found) = Self::read_any(file, input, column, options, |_| Ok(()))?;
        for warning in found {
            if let Warning::ClockRestarts { lines, stamps_s: (before, after) } = warning {
                let place =
                    Place { file: file.to_owned(), line: lines.first(), column: options.time_column().to_owned() };
                return Err(ClockError::TimeDecreases { place, before, after, times: lines.count() }.into());
            }
        }
        Ok(signal)
    }

    /// Reads from `input`, and tells what was mended. Where the clock starts anew, the longest part is taken.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column.
    pub fn read_mended(
        file: &str,
        input: impl Read,
        column: Option<&str>,
        options: &ReadOptions,
    ) -> Result<(Self, Vec<Warning>), RecordingError> {
        Self::read_any(file, input, column, options, |table| table.check(file))
    }

    /// Takes the position from a log whose channels were read already, and tells what was mended; `file` is its name in
    /// messages. Where the clock starts anew, the longest part is taken.
    ///
    /// # Errors
    /// [`RecordingError`], as of [`Signal::read_mended`].
    pub fn from_log(file: &str, log: &Log, options: &ReadOptions) -> Result<(Self, Vec<Warning>), RecordingError> {
        let wanted = wanted(None, options);
        let name = wanted.name.to_owned();
        let table = Table::of_log(file, log, options, &[wanted])?;
        table.check(file)?;
        Self::of_table(file, name, table)
    }

    fn read_any(
        file: &str,
        input: impl Read,
        column: Option<&str>,
        options: &ReadOptions,
        check: impl FnOnce(&Table) -> Result<(), RecordingError>,
    ) -> Result<(Self, Vec<Warning>), RecordingError> {
        let wanted = wanted(column, options);
        let name = wanted.name.to_owned();
        let table = Table::read(file, input, options, &[wanted])?;
        check(&table)?;
        Self::of_table(file, name, table)
    }

    fn of_table(file: &str, name: String, mut table: Table) -> Result<(Self, Vec<Warning>), RecordingError> {
        table.keep_longest_part();
        let y = table.columns.pop().unwrap_or_default();
        if y.len() < MIN_ROWS {
            return Err(table.too_short(file));
        }
        if let Some(&value) = y.first()
            && y.iter().all(|&other| other == value)
        {
            return Err(RecordingError::Constant { file: file.to_owned(), column: name, value, rows: y.len() });
        }
        let signal = Self {
            name: file_stem(file),
            unit: units::of_column(&name, &table.header),
            column: name,
            gaps: timing::gaps(&table.t, &table.breaks),
            t: table.t,
            y,
        };
        Ok((signal, table.found))
    }
}

/// The column that is fitted: the position if `None`.
fn wanted<'a>(column: Option<&'a str>, options: &'a ReadOptions) -> Wanted<'a> {
    match column {
        Some(name) => Wanted { name, flag: "--signal" },
        None => Wanted { name: options.position_column(), flag: "--position or --signal" },
    }
}
