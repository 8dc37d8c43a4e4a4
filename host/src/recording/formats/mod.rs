//! Logs in other formats than CSV: each format is a file of its own, and gives a [`Log`] of named channels with times.
//!
//! A format is known by the first bytes of a file, whatever the file's name ends in.

mod array;
mod bytes;
#[cfg(feature = "logs")]
mod can;
#[cfg(feature = "logs")]
mod cdr;
mod csv;
#[cfg(feature = "logs")]
mod dbc;
mod fault;
mod gather;
#[cfg(feature = "logs")]
mod guard;
mod join;
#[cfg(feature = "logs")]
mod json;
#[cfg(feature = "logs")]
mod leaf;
mod log;
mod mat;
#[cfg(feature = "logs")]
mod mat73;
#[cfg(feature = "logs")]
mod mcap;
mod npy;
#[cfg(feature = "logs")]
mod npz;
#[cfg(feature = "logs")]
mod parquet;
#[cfg(feature = "logs")]
mod protobuf;
#[cfg(feature = "logs")]
mod ros_type;
#[cfg(feature = "logs")]
mod rosbag2;
mod text;
mod ulog;
mod wpilog;

use std::fmt;
use std::io::Read;
use std::path::Path;

pub use csv::read as read_csv;
pub use log::{Channel, Group, Log, MAX_CHANNELS, MAX_VALUES, Values};

pub(super) use join::{Joined, Times};
pub(super) use text::{cell_of_list, seconds_of_date};

use super::error::RecordingError;
use super::source::unpacked;
use super::{MAX_ROWS, Source};
use crate::file::{FileError, shown};
use fault::Fault;

/// Most bytes of a log that are read, and of what is packed in it: three numbers for each of [`MAX_ROWS`] rows.
pub const MAX_BYTES: usize = 24 * MAX_ROWS;
/// First bytes by which a format is known.
pub(super) const HEAD: usize = 128;

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Format {
    /// Comma-separated values.
    Csv,
    /// Arrays of NumPy, in a zip archive.
    Npz,
    /// One array of NumPy.
    Npy,
    /// MATLAB's, of versions 5 to 7.
    Mat,
    /// Apache Parquet.
    Parquet,
    /// Of PX4's autopilots.
    Ulog,
    /// WPILib's data log.
    Wpilog,
    /// MCAP, of ROS 2 and Foxglove.
    Mcap,
    /// HDF5, in which MATLAB writes version 7.3.
    Hdf5,
    /// SQLite, in which ROS 2 wrote its bags until 2023.
    Sqlite,
    /// The bag of ROS 1.
    Rosbag1,
    /// Frames of CAN, of candump or SavvyCAN.
    Can,
}

impl Format {
    /// The formats with their first bytes.
    const MARKS: [(&'static [u8], Self); 12] = [
        (b"PK\x03\x04", Self::Npz),
        (b"PK\x05\x06", Self::Npz),
        (b"\x93NUMPY", Self::Npy),
        (b"MATLAB 5.0 MAT-file", Self::Mat),
        (b"MATLAB 7.3 MAT-file", Self::Hdf5),
        (b"\x89HDF\r\n\x1a\n", Self::Hdf5),
        (b"PAR1", Self::Parquet),
        (b"ULog\x01\x12\x35", Self::Ulog),
        (b"WPILOG", Self::Wpilog),
        (b"\x89MCAP0\r\n", Self::Mcap),
        (b"SQLite format 3\0", Self::Sqlite),
        (b"#ROSBAG V", Self::Rosbag1),
    ];

    /// The format of a file that begins with `head`; `None` where that is none of these, and may be CSV.
    pub fn of(head: &[u8]) -> Option<Self> {
        let marked = Self::MARKS.iter().find(|(mark, _)| head.starts_with(mark)).map(|(_, format)| *format);
        #[cfg(feature = "logs")]
        let marked = marked.or_else(|| can::begins(head).then_some(Self::Can));
        marked
    }

    /// Reads a log of this format from all its bytes; frames by their description.
    fn log(self, bytes: &[u8], frames: Option<&Frames>) -> Result<Log, Fault> {
        let unsupported = |what: &str, instead| Err(Fault::Unsupported { what: what.to_owned(), instead });
        match self {
            #[cfg(feature = "logs")]
            Self::Npz => npz::read(bytes),
            Self::Npy => npy::read(bytes),
            Self::Mat => mat::read(bytes),
            #[cfg(feature = "logs")]
            Self::Parquet => parquet::read(bytes),
            Self::Ulog => ulog::read(bytes),
            Self::Wpilog => wpilog::read(bytes),
            #[cfg(feature = "logs")]
            Self::Mcap => mcap::read(bytes),
            #[cfg(feature = "logs")]
            Self::Hdf5 => mat73::read(bytes),
            #[cfg(feature = "logs")]
            Self::Sqlite => rosbag2::read(bytes),
            #[cfg(feature = "logs")]
            Self::Can => can::read(bytes, frames),
            #[cfg(not(feature = "logs"))]
            Self::Npz | Self::Parquet | Self::Mcap | Self::Hdf5 | Self::Sqlite | Self::Can => {
                let _ = frames;
                unsupported(&self.to_string(), "give it to the command `breakaway`, or write it as CSV")
            }
            Self::Rosbag1 => unsupported("a bag of ROS 1", "convert it to MCAP by `mcap convert`"),
            Self::Csv => unsupported("CSV as a log of bytes", "read it as rows"),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Csv => "a CSV file",
            Self::Npz => "an npz archive",
            Self::Npy => "an npy array",
            Self::Mat => "a MAT file",
            Self::Parquet => "a Parquet file",
            Self::Ulog => "a ULog",
            Self::Wpilog => "a WPILOG",
            Self::Mcap => "an MCAP file",
            Self::Hdf5 => "an HDF5 file",
            Self::Sqlite => "an SQLite file",
            Self::Rosbag1 => "a bag of ROS 1",
            Self::Can => "a CAN log",
        })
    }
}

impl Log {
    /// Reads all channels of the file at `path`, CSV or another format; `-` is standard input.
    ///
    /// # Errors
    /// [`RecordingError`], with the file and what to do.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        Self::read_described(path, None)
    }

    /// Reads all channels of the file at `path`; the file `dbc` describes the frames of a CAN log.
    ///
    /// # Errors
    /// [`RecordingError`], with the file and what to do.
    pub fn read_described(path: &Path, dbc: Option<&Path>) -> Result<Self, RecordingError> {
        Self::read_with(&shown(path), Source::open(path)?, dbc)
    }

    /// Reads all channels from `input`; `file` is its name in messages.
    ///
    /// # Errors
    /// [`RecordingError`], with the file and what to do.
    pub fn read_from(file: &str, input: impl Read) -> Result<Self, RecordingError> {
        Self::read_with(file, input, None)
    }

    /// Reads a CAN log from its bytes; `description` is what a DBC file says of its frames.
    ///
    /// # Errors
    /// [`RecordingError`], with the file and what to do.
    #[cfg(feature = "logs")]
    pub fn read_frames(file: &str, frames: &[u8], description: &[u8]) -> Result<Self, RecordingError> {
        let dbc = dbc::parse("the description", description)?;
        Ok(can::read(frames, Some(&dbc)).map_err(|fault| fault.of(file, Format::Can))?)
    }

    fn read_with(file: &str, input: impl Read, dbc: Option<&Path>) -> Result<Self, RecordingError> {
        let failed = |error: std::io::Error| FileError::reading(file, &error);
        let mut input = unpacked(input).map_err(failed)?;
        let mut head = Vec::new();
        input.by_ref().take(HEAD as u64).read_to_end(&mut head).map_err(failed)?;
        let format = Format::of(&head);
        let whole = head.as_slice().chain(input);
        match format {
            Some(format) => foreign(file, format, whole, dbc),
            None => csv::read(file, whole),
        }
    }
}

/// What describes the frames of a CAN log.
#[cfg(feature = "logs")]
type Frames = can_dbc::Dbc;
#[cfg(not(feature = "logs"))]
type Frames = ();

/// Reads a log that is not CSV; the file `dbc` describes the frames of a CAN log.
pub(super) fn foreign(file: &str, format: Format, input: impl Read, dbc: Option<&Path>) -> Result<Log, RecordingError> {
    #[cfg(feature = "logs")]
    let frames = dbc.map(dbc::read).transpose()?;
    #[cfg(not(feature = "logs"))]
    let frames: Option<Frames> = dbc.map(|_| ());
    let mut bytes = Vec::new();
    let read = input.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes);
    read.map_err(|error| FileError::reading(file, &error))?;
    let all = if bytes.len() > MAX_BYTES {
        Err(Fault::TooLarge { what: "bytes", most: MAX_BYTES })
    } else {
        format.log(&bytes, frames.as_ref())
    };
    Ok(all.map_err(|fault| fault.of(file, format))?)
}
