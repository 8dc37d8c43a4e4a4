//! Where a recording is read from: a file or standard input, packed by gzip or not.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::RecordingError;
use crate::file::{FileError, is_standard_input};

/// The first bytes of a gzip file (RFC 1952, section 2.3.1).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// An open file, or standard input.
#[derive(Debug)]
pub enum Source {
    /// A file.
    File(File),
    /// Standard input.
    Standard(io::Stdin),
}

impl Source {
    /// Opens the file at `path`; `-` is standard input.
    ///
    /// # Errors
    /// [`FileError`] as [`RecordingError::File`]; [`RecordingError::Folder`].
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        if is_standard_input(path) {
            return Ok(Self::Standard(io::stdin()));
        }
        let file = path.display().to_string();
        if path.is_dir() {
            // The suite's folders.
            let part = [path.join("fit"), path.to_path_buf()].into_iter().find(|part| part.is_dir());
            let files = part.unwrap_or_default().join("*.csv").display().to_string();
            return Err(RecordingError::Folder { file, files });
        }
        File::open(path).map(Self::File).map_err(|source| FileError::reading(&file, &source).into())
    }

    /// Bytes to come, where that is known; 0 otherwise.
    pub fn length(&self) -> u64 {
        match self {
            Self::File(file) => file.metadata().map_or(0, |metadata| metadata.len()),
            Self::Standard(_) => 0,
        }
    }
}

impl Read for Source {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Standard(input) => input.read(buffer),
        }
    }
}

/// What a reader gives, unpacked where its first bytes are those of gzip, whatever the file's name ends in.
///
/// # Errors
/// What the reader reports for its first bytes.
pub(super) fn unpacked<'a>(mut input: impl Read + 'a) -> io::Result<Box<dyn Read + 'a>> {
    let mut head = Vec::new();
    input.by_ref().take(GZIP.len() as u64).read_to_end(&mut head)?;
    let packed = head == GZIP;
    let whole = io::Cursor::new(head).chain(input);
    Ok(if packed { Box::new(MultiGzDecoder::new(whole)) } else { Box::new(whole) })
}
