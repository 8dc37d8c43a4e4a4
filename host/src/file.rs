//! Files that are written whole or not at all, and never over what breakaway did not write.

#[cfg(feature = "command")]
mod beside;
mod error;
mod kind;
#[cfg(not(feature = "command"))]
mod no_files;
mod target;

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::Path;

#[cfg(not(feature = "command"))]
use no_files as beside;

pub use beside::can_write;
pub use error::{FileError, is_standard_input, read_as, shown};
pub use kind::{CARD_MARK, EXPORT_MARK, FIGURE_MARK, FileKind, PAGE_MARK, TABLE_MARK};
pub use target::{Target, TargetError, apart, inside, may_write};

/// Writes a file through `content`: beside its place first, then renamed into it.
///
/// A reader of `path` sees the old file or the new one, never a part. If `content` fails, or Ctrl-C comes, the old
/// file stays and nothing is left behind. A symbolic link is followed. What is not a regular file (a pipe, a
/// terminal) is written directly.
///
/// # Errors
/// Whatever `content` or the file system reports; the target is then untouched.
pub fn write_whole<F>(path: &Path, content: F) -> io::Result<()>
where
    F: FnOnce(&mut dyn Write) -> io::Result<()>,
{
    let target = match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a directory, not a file"));
        }
        Ok(found) if !found.is_file() => {
            let mut out = BufWriter::new(OpenOptions::new().write(true).open(path)?);
            content(&mut out)?;
            return out.flush();
        }
        Ok(_) => fs::canonicalize(path)?,
        Err(_) => path.to_path_buf(),
    };
    beside::replace(&target, content)
}

/// Makes a folder, and those it is in.
///
/// # Errors
/// What the system says, with the folder's name, and the file that stands in its place if there is one.
pub fn make_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path).map_err(|error| {
        let reason = match path.ancestors().find(|part| part.is_file()) {
            Some(file) => format!("{} is a file; give another folder", file.display()),
            None => error.to_string(),
        };
        io::Error::new(error.kind(), format!("cannot make the folder {}: {reason}", path.display()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, |out| out.write_all(b"old")).unwrap();
        let failed = write_whole(&path, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("cut"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "cut");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_new_write_replaces_and_a_missing_folder_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, |out| out.write_all(b"old and longer")).unwrap();
        write_whole(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        let nowhere = folder.path().join("no/such/folder/a.txt");
        assert!(write_whole(&nowhere, |out| out.write_all(b"x")).is_err());
        assert!(write_whole(folder.path(), |out| out.write_all(b"x")).is_err());
    }

    /// What cannot be written is known before the work, with the same reason, and the check leaves nothing.
    #[test]
    fn it_is_known_before_whether_a_file_can_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        can_write(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(&path, "old").unwrap();
        can_write(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        for (wrong, words) in [
            (folder.path().join("no/a.txt"), "no is not there; make it first"),
            (path.join("b.txt"), "a.txt is a file, not a folder"),
            (folder.path().to_path_buf(), "is a directory, not a file"),
        ] {
            let before = can_write(&wrong).unwrap_err().to_string();
            assert!(before.ends_with(words), "{before}");
            assert_eq!(write_whole(&wrong, |out| out.write_all(b"x")).unwrap_err().to_string(), before);
        }
        let inside = make_folder(&path.join("c/d")).unwrap_err().to_string();
        assert!(inside.ends_with("a.txt is a file; give another folder"), "{inside}");
    }
}
