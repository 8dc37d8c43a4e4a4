//! What the bytes of a log can be refused for, before the file's name is known.

use super::Format;
use crate::recording::error::LogError;

/// What is wrong with the bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// The file ends before what it announced.
    Truncated { at: u64 },
    /// Bytes that the format does not allow.
    Damaged { at: u64, what: &'static str },
    /// More than is read.
    TooLarge { what: &'static str, most: usize },
    /// A part of the format that is not read, and what to do instead.
    Unsupported { what: String, instead: &'static str },
}

impl Fault {
    /// The same with the file.
    pub(super) fn of(self, file: &str, format: Format) -> LogError {
        let file = file.to_owned();
        match self {
            Self::Truncated { at } => LogError::Truncated { file, format, at },
            Self::Damaged { at, what } => LogError::Damaged { file, format, at, what: what.to_owned() },
            Self::TooLarge { what, most } => LogError::TooLarge { file, format, what, most },
            Self::Unsupported { what, instead } => LogError::Unsupported { file, format, what, instead },
        }
    }
}
