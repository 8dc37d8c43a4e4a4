//! What can be wrong with a log in another format than CSV.

use crate::nearest::did_you_mean;
use crate::recording::Format;

/// Why a log cannot be read, or gives no recording.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum LogError {
    /// The file ends too early.
    #[error("{file}: {format} that ends too early: what is announced at byte {at} is not there; was it copied whole?")]
    Truncated {
        /// The file's name as it was given.
        file: String,
        /// What the file is.
        format: Format,
        /// Byte, from 0, at which something is missing.
        at: u64,
    },
    /// Bytes that the format does not allow.
    #[error("{file}: damaged {format}: {what} (at byte {at})")]
    Damaged {
        /// The file's name as it was given.
        file: String,
        /// What the file is.
        format: Format,
        /// Byte, from 0, of the file or of its part that was unpacked.
        at: u64,
        /// What is wrong.
        what: String,
    },
    /// More than is read.
    #[error("{file}: {format} with more than {most} {what}, the most that are read; write a part of it")]
    TooLarge {
        /// The file's name as it was given.
        file: String,
        /// What the file is.
        format: Format,
        /// Of what.
        what: &'static str,
        /// How many are read.
        most: usize,
    },
    /// A part of the format that is not read.
    #[error("{file}: {what} is not read; {instead}")]
    Unsupported {
        /// The file's name as it was given.
        file: String,
        /// What the file is.
        format: Format,
        /// What is not read.
        what: String,
        /// What to do.
        instead: &'static str,
    },
    /// A description of frames that cannot be read.
    #[error("{file}: no description of CAN frames in DBC: {what}")]
    Description {
        /// The file's name as it was given.
        file: String,
        /// What is wrong.
        what: String,
    },
    /// A channel that is not there.
    #[error(
        "{file}: no channel `{wanted}`{}; name it with {flag}; channels: {}; `breakaway look {file}` guesses them",
        did_you_mean(nearest.as_deref()), channels.join(", ")
    )]
    NoChannel {
        /// The file's name as it was given.
        file: String,
        /// The name looked for.
        wanted: String,
        /// The flag that names this channel.
        flag: &'static str,
        /// The most similar channel.
        nearest: Option<String>,
        /// The channels.
        channels: Vec<String>,
    },
    /// A channel of text where numbers are wanted.
    #[error("{file}: channel `{channel}` is text, not numbers")]
    NotNumbers {
        /// The file's name as it was given.
        file: String,
        /// The channel.
        channel: String,
    },
    /// Two channels without a common clock.
    #[error(
        "{file}: `{first}` has {} rows and `{second}` {}, and this file says when neither was taken; both must have one length",
        rows.0, rows.1
    )]
    NoCommonClock {
        /// The file's name as it was given.
        file: String,
        /// The one.
        first: String,
        /// The other.
        second: String,
        /// Their rows.
        rows: (usize, usize),
    },
    /// The drive's values lie before or after all of the positions.
    #[error("{file}: `{drive}` has no value at the times of `{position}`; were they recorded at different times?")]
    Apart {
        /// The file's name as it was given.
        file: String,
        /// The drive.
        drive: String,
        /// The position.
        position: String,
    },
}
