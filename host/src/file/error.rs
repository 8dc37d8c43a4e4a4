//! Why a file could not be read or written, the same for every kind of file that is read.

use std::fs;
use std::io::{self, Read};
use std::path::Path;

use crate::mistaken::{Content, seems};

/// Why a file could not be read or written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum FileError {
    /// There is no such file.
    #[error("{file}: no such file; check the path")]
    NotFound {
        /// The file's name as it was given.
        file: String,
    },
    /// A file of another kind.
    #[error("{file} is {found}, not {}; {}", wanted.described(), wanted.instead_of(*found))]
    OtherKind {
        /// The file's name as it was given.
        file: String,
        /// What it should be.
        wanted: Content,
        /// What it seems to be.
        found: Content,
    },
    /// The system could not open or read the file, or it is not UTF-8.
    #[error("{file}: cannot be read: {reason}")]
    Read {
        /// The file's name as it was given.
        file: String,
        /// What the system said.
        reason: String,
    },
    /// The system could not write the file; an earlier file of that name is untouched.
    #[error("{file}: cannot be written, and nothing was changed: {reason}")]
    Write {
        /// The file's name as it was given.
        file: String,
        /// What the system said.
        reason: String,
    },
}

impl FileError {
    /// Of a file that the system did not open or read.
    pub fn reading(file: &str, source: &io::Error) -> Self {
        let file = file.to_owned();
        match source.kind() {
            io::ErrorKind::NotFound => Self::NotFound { file },
            _ => Self::Read { file, reason: source.to_string() },
        }
    }

    /// Of a file that the system did not write.
    pub fn writing(file: &Path, source: &io::Error) -> Self {
        Self::Write { file: file.display().to_string(), reason: source.to_string() }
    }
}

/// Whether a path stands for standard input: `-`.
pub fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// The name of an input in messages.
pub fn shown(path: &Path) -> String {
    if is_standard_input(path) { "standard input".to_owned() } else { path.display().to_string() }
}

/// Most bytes of a text that is read from standard input.
const MOST_BYTES: u64 = 1 << 24;

/// The bytes of a file, or of standard input up to [`MOST_BYTES`].
fn content(path: &Path) -> io::Result<Vec<u8>> {
    if !is_standard_input(path) {
        return fs::read(path);
    }
    let mut content = Vec::new();
    io::stdin().lock().take(MOST_BYTES).read_to_end(&mut content)?;
    Ok(content)
}

/// Reads a text file of a kind; `-` is standard input: `parse` has its name and its text. What `parse` refuses, and what is not UTF-8, is refused by
/// the kind of file that it seems to be, if it seems to be another.
///
/// # Errors
/// [`FileError`], and those of `parse`.
pub fn read_as<T, E: From<FileError>>(
    path: &Path,
    wanted: Content,
    parse: impl FnOnce(&str, &str) -> Result<T, E>,
) -> Result<T, E> {
    let file = shown(path);
    let content = content(path).map_err(|source| FileError::reading(&file, &source))?;
    let refused = |error: E| match seems(&content).filter(|found| *found != wanted && *found != Content::Toml) {
        Some(found) => FileError::OtherKind { file: file.clone(), wanted, found }.into(),
        None => error,
    };
    match std::str::from_utf8(&content) {
        Ok(text) => parse(&file, text).map_err(refused),
        Err(source) => Err(refused(FileError::Read { file: file.clone(), reason: source.to_string() }.into())),
    }
}
