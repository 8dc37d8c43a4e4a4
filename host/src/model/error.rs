//! What can be wrong with a model file.

use std::borrow::Cow;

use breakaway_core::plant::PlantError;

use crate::file::FileError;
use crate::nearest::did_you_mean;

/// Why a model file cannot be used or written.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ModelError {
    /// The file could not be read or written, or is of another kind.
    #[error(transparent)]
    File(#[from] FileError),
    /// Not TOML.
    #[error("{file}:{line}: not valid TOML: {message}")]
    Syntax {
        /// The file's name as it was given.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What the parser said.
        message: String,
    },
    /// A key, effect or symbol that means nothing here.
    #[error("{file}:{line}: unknown {what} `{found}`{}; valid: {}", did_you_mean(nearest.as_deref()), valid.join(", "))]
    Unknown {
        /// The file's name as it was given.
        file: String,
        /// Line, from 1.
        line: usize,
        /// What is unknown: a key, an effect, or a parameter with its effect's name.
        what: Box<str>,
        /// What stands there.
        found: String,
        /// The most similar valid name.
        nearest: Option<Box<str>>,
        /// All valid names.
        valid: Vec<String>,
    },
    /// A key that must be there is not.
    #[error("{file}:{line}: `{key}` is missing in {table}")]
    Missing {
        /// The file's name as it was given.
        file: String,
        /// Line of the table, from 1.
        line: usize,
        /// The key.
        key: String,
        /// The table.
        table: String,
    },
    /// A value of another kind or out of range.
    #[error("{file}:{line}: `{key}` is {found}; it must be {expected}")]
    Value {
        /// The file's name as it was given.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// What stands there.
        found: String,
        /// What it must be.
        expected: Cow<'static, str>,
    },
}

/// The parameter a [`PlantError`] names, and its range.
pub(super) fn out_of_range(error: PlantError) -> (&'static str, &'static str) {
    match error {
        PlantError::B => ("b", "a finite number above 0"),
        PlantError::C => ("c", "a finite number, 0 or more"),
        PlantError::F1 => ("f1", "a finite number, 0 or more"),
    }
}
