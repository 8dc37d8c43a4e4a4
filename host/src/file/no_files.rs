//! Without the feature `command` no file is written: there may be no file system.

use std::io::{self, Write};
use std::path::Path;

/// Writes nothing.
pub(super) fn replace(_: &Path, _: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    Err(unsupported())
}

/// Nothing can be written.
///
/// # Errors
/// Always.
pub fn can_write(_: &Path) -> io::Result<()> {
    Err(unsupported())
}

fn unsupported() -> io::Error {
    io::Error::new(io::ErrorKind::Unsupported, "only the command writes files")
}
