//! Hashes of input files.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use anyhow::Context;
use sha2::{Digest, Sha256};

/// A reader that hashes what is read through it.
pub struct Hashing<R> {
    inner: R,
    hasher: Sha256,
}

impl<R: Read> Hashing<R> {
    /// Hashes what is read from `inner`.
    pub fn new(inner: R) -> Self {
        Self { inner, hasher: Sha256::new() }
    }

    /// Reads the rest. Gives the SHA-256 of all bytes, in hex.
    ///
    /// # Errors
    /// What the reader reports.
    pub fn finish(mut self) -> io::Result<String> {
        io::copy(&mut self, &mut io::sink())?;
        Ok(self.hasher.finalize().iter().fold(String::new(), |mut hex, byte| {
            // Writing to a String cannot fail.
            let _ = write!(hex, "{byte:02x}");
            hex
        }))
    }
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.hasher.update(&buffer[..count]);
        Ok(count)
    }
}

/// SHA-256 of a file, in hex.
///
/// # Errors
/// A file that cannot be read.
pub fn hash(path: &Path) -> anyhow::Result<String> {
    let name = || format!("{} cannot be read", path.display());
    let file = File::open(path).with_context(name)?;
    Hashing::new(BufReader::with_capacity(1 << 16, file)).finish().with_context(name)
}
