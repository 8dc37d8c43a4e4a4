//! A file beside the one that it will replace, and its renaming.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::interrupt;

/// Writes beside `target`, and renames.
pub(super) fn replace(target: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let (temporary, guard) = interrupt::remove_if_interrupted(|| beside(target))?;
    let mut out = BufWriter::with_capacity(1 << 16, temporary);
    content(&mut out)?;
    let temporary = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    temporary.as_file().sync_all()?;
    temporary.persist(target).map_err(|failed| failed.error)?;
    drop(guard);
    Ok(())
}

/// A new file in the folder of `target`.
fn beside(target: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".breakaway-");
    // The default of 0600 would survive the rename; 0666 less the umask is what any other program would give.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // What the system says names the temporary file, which means nothing to the reader.
    builder.tempfile_in(&folder).map_err(|error| {
        let name = folder.display();
        let reason = match fs::metadata(&folder) {
            Err(missing) if missing.kind() == io::ErrorKind::NotFound => {
                format!("the folder {name} is not there; make it first")
            }
            Ok(found) if !found.is_dir() => format!("{name} is a file, not a folder"),
            _ => format!("the folder {name} takes no new file: {}", error.kind()),
        };
        io::Error::new(error.kind(), reason)
    })
}

/// Checks that [`write_whole`](super::write_whole) could begin now: for before long work, not after it. Nothing is changed.
///
/// # Errors
/// What `write_whole` would report.
pub fn can_write(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::Error::new(io::ErrorKind::IsADirectory, "is a directory, not a file")),
        Ok(found) if !found.is_file() => OpenOptions::new().write(true).open(path).map(drop),
        Ok(_) => interrupt::remove_if_interrupted(|| beside(&fs::canonicalize(path)?)).map(drop),
        Err(_) => interrupt::remove_if_interrupted(|| beside(path)).map(drop),
    }
}
