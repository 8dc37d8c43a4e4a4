//! What can be wrong with a recording: one variant and one message each, with file, line, column and what to do.

use std::io;

use crate::nearest::did_you_mean;

/// A place in a recording's file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file's name as it was given.
    pub file: String,
    /// Line, from 1, comments and header row counted.
    pub line: u64,
    /// Name of the column.
    pub column: String,
}

impl std::fmt::Display for Place {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}:{}: column `{}`", self.file, self.line, self.column)
    }
}

/// Why a file is not a recording that can be used, or could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// There is no such file.
    #[error("{file}: no such file; check the path")]
    NotFound {
        /// The file's name as it was given.
        file: String,
    },
    /// A folder.
    #[error("{file} is a folder, not a recording; name the files in it, such as {files}")]
    Folder {
        /// The folder's name as it was given.
        file: String,
        /// The recordings that are or would be in it.
        files: String,
    },
    /// A file of another kind.
    #[error(
        "{file} is {found}, not a recording (CSV with a header row); {}",
        if found.contains("TOML") { "check the order of the arguments: a model is given by --model" } else { "give the log as CSV" }
    )]
    OtherFile {
        /// The file's name as it was given.
        file: String,
        /// What it seems to be, with an article.
        found: &'static str,
    },
    /// The system could not open or read the file.
    #[error("{file}: cannot be read")]
    Read {
        /// The file's name as it was given.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// The system could not write the file; an earlier file of that name is untouched.
    #[error("{file}: cannot be written; nothing was changed")]
    Write {
        /// The file's name as it was given.
        file: String,
        /// What the system said.
        source: io::Error,
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
    #[error("{place}: `{text}` is not a finite number; remove the row (the reader then sees a gap) or repair it")]
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
    /// An empty field.
    #[error("{place}: the field is empty; remove the row (the reader then sees a gap) or repair it")]
    EmptyField {
        /// Where.
        place: Place,
    },
    /// A row with fewer fields than the header row.
    #[error(
        "{place}: the field is missing: the row has {found} field(s), the header {expected}; if this is the last row, the file was cut off: remove the row"
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
    /// Time goes back so often that the rows are in no order of time.
    #[error(
        "{place}: time goes back from {before} to {after}{}; sort the rows, keep one recording per file, or give the right \
         column with --time",
        if *times > 1 { format!(", and so {times} times") } else { String::new() }
    )]
    TimeDecreases {
        /// Where it does so first.
        place: Place,
        /// Time of the row before, s.
        before: f64,
        /// Time of this row, s.
        after: f64,
        /// How often it does so.
        times: u64,
    },
    /// Time stands still in all but a few rows.
    #[error(
        "{place}: time stands still at {time}, {rows} rows repeat the stamp of the row before; give the right column with \
         --time, or the sampling rate with --fs"
    )]
    TimeRepeats {
        /// Where it does so first.
        place: Place,
        /// The time, s.
        time: f64,
        /// Rows that repeat the stamp of the row before.
        rows: usize,
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
    /// No recording of a session moves.
    #[error(
        "{file}: no motion: column `{column}` {}; was the drive on, and large enough to overcome friction?",
        if range.0 == range.1 { format!("is {} in all {rows} rows", range.0) }
        else { format!("stays within one encoder step, {} to {}, in all {rows} rows", range.0, range.1) }
    )]
    NoMotion {
        /// The first file's name as it was given.
        file: String,
        /// The position column.
        column: String,
        /// Its lowest and highest value.
        range: (f64, f64),
        /// Rows read.
        rows: usize,
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
    #[error("{option} is {value}; it must be a positive, finite number")]
    Option {
        /// The option's name.
        option: &'static str,
        /// Its value.
        value: f64,
    },
}
