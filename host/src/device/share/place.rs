//! Where the sockets of shared ports are.

use std::io;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Longer names than this are cut and told apart by a hash: a socket's path has about a hundred bytes in all.
const LONGEST: usize = 40;

/// The folder: `breakaway` in `$XDG_RUNTIME_DIR`, which is the user's own; else `breakaway-UID` in the folder for
/// temporary files; on Windows `breakaway` in `%LOCALAPPDATA%`.
pub fn folder() -> PathBuf {
    #[cfg(unix)]
    {
        match std::env::var_os("XDG_RUNTIME_DIR").map(PathBuf::from).filter(|folder| folder.is_dir()) {
            Some(folder) => folder.join("breakaway"),
            None => std::env::temp_dir().join(format!("breakaway-{}", rustix::process::getuid().as_raw())),
        }
    }
    #[cfg(not(unix))]
    {
        std::env::var_os("LOCALAPPDATA").map_or_else(std::env::temp_dir, PathBuf::from).join("breakaway")
    }
}

/// Makes the folder, for this user alone.
///
/// # Errors
/// It cannot be made, or another user has made it.
pub(in crate::device) fn make_folder() -> io::Result<PathBuf> {
    let folder = folder();
    let mut builder = std::fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{DirBuilderExt, MetadataExt};
        builder.mode(0o700).create(&folder)?;
        let found = std::fs::metadata(&folder)?;
        if found.uid() != rustix::process::getuid().as_raw() || found.mode() & 0o022 != 0 {
            return Err(io::Error::other(format!("{} is not this user's alone", folder.display())));
        }
    }
    #[cfg(not(unix))]
    builder.create(&folder)?;
    Ok(folder)
}

/// The socket of a port. Two names of one port, as the links below /dev/serial/by-id, have the same.
///
/// # Errors
/// There is no such port.
pub(super) fn of(port: &str) -> io::Result<PathBuf> {
    Ok(folder().join(format!("{}.sock", name(port)?)))
}

/// A port's name as part of a file's.
///
/// # Errors
/// There is no such port.
pub(in crate::device) fn name(port: &str) -> io::Result<String> {
    // Ports of Windows are no files.
    let whole = if cfg!(windows) { Path::new(port).to_owned() } else { std::fs::canonicalize(port)? };
    let whole = whole.to_string_lossy();
    let short: String = whole
        .trim_start_matches("/dev/")
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' })
        .collect();
    if short.len() <= LONGEST && whole.starts_with("/dev/") == (short.len() + 5 == whole.len()) {
        return Ok(short);
    }
    let hash = Sha256::digest(whole.as_bytes());
    let first = hash.iter().take(8).fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte));
    Ok(format!("{first:016x}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_has_one_name_whatever_leads_to_it() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("by-id");
        std::os::unix::fs::symlink("/dev/null", &link).unwrap();
        assert_eq!((name("/dev/null").unwrap(), name(link.to_str().unwrap()).unwrap()), ("null".into(), "null".into()));
        let long = folder.path().join("a-name-that-is-longer-than-a-socket-may-be-called");
        std::fs::write(&long, "").unwrap();
        assert_eq!(name(long.to_str().unwrap()).unwrap().len(), 16);
        assert!(name("/dev/ttyNONE0").is_err());
    }
}
