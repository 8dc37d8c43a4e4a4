//! What can be wrong with recordings that are used together.

/// Why recordings are not one session.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum SessionError {
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
    /// Recordings of one session in different units.
    #[error(
        "{first} is in {first_units} and {second} in {second_units}; recordings of one session need the same units"
    )]
    Units {
        /// A recording's file.
        first: String,
        /// Its units.
        first_units: String,
        /// Another recording's file.
        second: String,
        /// Its units.
        second_units: String,
    },
    /// One recording given twice.
    #[error(
        "{second} holds the same samples as {first}; {}",
        if *held_out { "what is fitted cannot be held out: give a recording of its own to --holdout" }
        else { "counted twice, they would seem more certain than they are: give it once" }
    )]
    GivenTwice {
        /// A file.
        first: String,
        /// The other file.
        second: String,
        /// Whether the other one is to be held out.
        held_out: bool,
    },
}
