//! What can be wrong with a recording: one variant and one message each, with file, line, column and what to do.

mod clock;
mod list;
mod log;
mod place;
mod session;

pub use clock::ClockError;
pub use list::ListError;
pub use log::LogError;
pub use place::Place;
pub use session::SessionError;

use super::limits::{MAX_COLUMNS, MAX_ROW_BYTES};
use crate::file::FileError;
use crate::nearest::did_you_mean;

/// A time, s, without the digits below 1 µs that a sum of ticks leaves.
fn in_microseconds(t_s: f64) -> f64 {
    (1e6 * t_s).round() / 1e6
}

/// Why a file is not a recording that can be used, or could not be written.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum RecordingError {
    /// What is wrong with its clock.
    #[error(transparent)]
    Clock(#[from] ClockError),
    /// What is wrong with a session of recordings.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// What is wrong with a log in another format than CSV.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The file could not be read or written, or is of another kind.
    #[error(transparent)]
    File(#[from] FileError),
    /// A folder.
    #[error("{file} is a folder, not a recording; name the files in it, such as {files}")]
    Folder {
        /// The folder's name as it was given.
        file: String,
        /// The recordings that are or would be in it.
        files: String,
    },
    /// No bytes, or nothing but comments and blank lines.
    #[error("{file}: the file is empty; a recording has a header row such as `t,u,x` and one row per sample")]
    Empty {
        /// The file's name as it was given.
        file: String,
    },
    /// The first row is numbers.
    #[error("{file}:{line}: the first row is numbers ({found}), not column names; add a header row such as `t,u,x`")]
    NoHeader {
        /// The file's name as it was given.
        file: String,
        /// Line of the first row.
        line: u64,
        /// The row.
        found: String,
    },
    /// A header row and nothing below.
    #[error("{file}:{line}: a header row and no samples below it; was the recording stopped before it began?")]
    NoRows {
        /// The file's name as it was given.
        file: String,
        /// Line of the header row.
        line: u64,
    },
    /// Fewer rows than any estimate needs.
    #[error("{file}:{line}: too short: {rows} row(s), and at least {needed} are needed; record for longer")]
    TooShort {
        /// The file's name as it was given.
        file: String,
        /// Line of the last row.
        line: u64,
        /// Rows found (after `--where`).
        rows: usize,
        /// Rows needed.
        needed: usize,
    },
    /// A row that does not end.
    #[error(
        "{file}:{line}: no end of the row within {} KiB, the longest row that is read. A recording has one row per \
         sample, and a quote must be closed", MAX_ROW_BYTES >> 10
    )]
    LongRow {
        /// The file's name as it was given.
        file: String,
        /// Line of the row.
        line: u64,
    },
    /// More columns than are read.
    #[error(
        "{file}:{line}: the header row has {found} columns, and at most {MAX_COLUMNS} are read; leave out those not needed"
    )]
    TooManyColumns {
        /// The file's name as it was given.
        file: String,
        /// Line of the header row.
        line: u64,
        /// Columns found.
        found: usize,
    },
    /// More rows than are read.
    #[error("{file}:{line}: the recording goes on past {most} rows, the most that are read; split the file")]
    TooManyRows {
        /// The file's name as it was given.
        file: String,
        /// Line of the first row too many.
        line: u64,
        /// Rows that are read.
        most: usize,
    },
    /// A column that is not there.
    #[error("{file}:{line}: no column `{wanted}`{}; name it with {flag}; columns: {}{}", did_you_mean(nearest.as_deref()), columns.join(", "), if columns.len() == 1 { "; are they separated by commas, semicolons or tabs?" } else { "" })]
    WrongColumn {
        /// The file's name as it was given.
        file: String,
        /// Line of the header row.
        line: u64,
        /// The name looked for.
        wanted: String,
        /// The flag that names this column.
        flag: &'static str,
        /// The most similar column.
        nearest: Option<String>,
        /// All columns.
        columns: Vec<String>,
    },
    /// Two columns have the name looked for.
    #[error("{file}:{line}: two columns are called `{column}`; rename one in the header row")]
    DuplicateColumn {
        /// The file's name as it was given.
        file: String,
        /// Line of the header row.
        line: u64,
        /// The name.
        column: String,
    },
    /// NaN, an infinity, or a number too large for f64.
    #[error("{place}: `{text}` is not a finite number; remove the row, which leaves a gap, or repair it")]
    NotFinite {
        /// Where.
        place: Place,
        /// The field.
        text: String,
    },
    /// A field that is not a number.
    #[error("{place}: `{text}` is not a number; numbers are written like -1.5e-3, with a point")]
    NotANumber {
        /// Where.
        place: Place,
        /// The field.
        text: String,
    },
    /// What is wrong with a list in a field.
    #[error(transparent)]
    List(#[from] ListError),
    /// A number that goes on over lines.
    #[error("{place}: the field goes on past the end of its line; is a quote opened and not closed?")]
    OpenQuote {
        /// Where.
        place: Place,
    },
    /// An empty field.
    #[error("{place}: the field is empty; remove the row, which leaves a gap, or repair it")]
    EmptyField {
        /// Where.
        place: Place,
    },
    /// A row with fewer fields than the header row.
    #[error(
        "{place}: the field is missing: the row has {found} field(s), the header {expected}; remove the row, which leaves a gap, or repair it"
    )]
    MissingField {
        /// Where.
        place: Place,
        /// Fields in the row.
        found: usize,
        /// Fields in the header row.
        expected: usize,
    },
    /// A row with more fields than the header row.
    #[error(
        "{file}:{line}: the row has {found} fields, the header {expected}; is there a decimal comma, or an unquoted comma in a text?"
    )]
    ExtraFields {
        /// The file's name as it was given.
        file: String,
        /// Line of the row.
        line: u64,
        /// Fields in the row.
        found: usize,
        /// Fields in the header row.
        expected: usize,
    },
    /// Bytes that are not UTF-8 where a number should be.
    #[error("{place}: not UTF-8 text; save the file as UTF-8 CSV")]
    NotUtf8 {
        /// Where.
        place: Place,
    },
    /// `--where` leaves nothing.
    #[error("{file}: no row has {wanted}; the first rows have {}", seen.join(", "))]
    NothingSelected {
        /// The file's name as it was given.
        file: String,
        /// The condition.
        wanted: String,
        /// Some values the column does have.
        seen: Vec<String>,
    },
    /// `--from` is not before `--to`.
    #[error("--from {from_s} is not before --to {to_s}")]
    WindowReversed {
        /// First time, s.
        from_s: f64,
        /// Last time, s.
        to_s: f64,
    },
    /// `--from` and `--to` leave nothing.
    #[error(
        "{file}: no row from {} s to {} s; the recording runs from {} s to {} s", window_s.0, window_s.1,
        in_microseconds(found_s.0), in_microseconds(found_s.1)
    )]
    OutsideWindow {
        /// The file's name as it was given.
        file: String,
        /// First and last time asked for, s.
        window_s: (f64, f64),
        /// First and last time in the file, s.
        found_s: (f64, f64),
    },
    /// The position rolls over, and nobody said that it does.
    #[error(
        "{place}: the position goes from {before} to {after} within one row, against the motion around it{}. The \
         encoder seems to roll over: give --wrap {modulus} to join the turns, or --wrap none if the axis did jump",
        if *times > 1 { format!(", and so {times} times") } else { String::new() }
    )]
    RollsOver {
        /// Where it does so first.
        place: Place,
        /// Position in the row before.
        before: f64,
        /// Position in this row.
        after: f64,
        /// How often it does so.
        times: usize,
        /// Position units after which it starts anew.
        modulus: f64,
    },
    /// A signal to be fitted never changes.
    #[error("{file}: column `{column}` is constant ({value} in all {rows} rows); there is nothing to fit")]
    Constant {
        /// The file's name as it was given.
        file: String,
        /// The column.
        column: String,
        /// Its value.
        value: f64,
        /// Rows read.
        rows: usize,
    },
    /// A `# key: value` line whose value cannot be read.
    #[error("{file}:{line}: header `{key}`: `{text}` is not {expected}")]
    HeaderValue {
        /// The file's name as it was given.
        file: String,
        /// Line of the comment.
        line: u64,
        /// The key.
        key: String,
        /// The value.
        text: String,
        /// What it should be.
        expected: &'static str,
    },
    /// An option out of range.
    #[error("{option} is {value}; it must be a number from {:e} to {:e}", range.0, range.1)]
    Option {
        /// The option's name.
        option: &'static str,
        /// Its value.
        value: f64,
        /// Lowest and highest value.
        range: (f64, f64),
    },
}
