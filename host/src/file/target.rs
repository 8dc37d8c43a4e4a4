//! Where a command writes, and what it never writes over: its own inputs, and files that breakaway did not write.

use std::ffi::OsString;
use std::fmt;
use std::fs;
use std::io::{self, Read, Seek as _, Write};
use std::path::{Component, Path, PathBuf};

use super::kind::{FileKind, HEAD_BYTES, LOG_MARKS};
use super::{can_write, write_whole};

/// Where a command writes a file: in the file system, or standard output (`-`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// Standard output.
    Standard,
    /// A file.
    File(PathBuf),
}

/// Why a file is not written.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum TargetError {
    /// It is read by the same command.
    #[error("{file} is an input of this command and is not written over; give another name")]
    Input {
        /// The file's name as it was given.
        file: String,
    },
    /// It is there and breakaway did not write it, or wrote something else.
    #[error(
        "{file} is there already, and is not {} that breakaway wrote{}; give another name, or --force to replace it",
        kind.name(), found.map_or_else(String::new, |found| format!(", but {found}"))
    )]
    NotOurs {
        /// The file's name as it was given.
        file: String,
        /// What would be written.
        kind: FileKind,
        /// What is there, if that can be told.
        found: Option<crate::mistaken::Content>,
    },
    /// Two results in one place.
    #[error("{file} is given for two results; give each a name of its own")]
    Twice {
        /// The place.
        file: String,
    },
    /// A result and the JSON document on standard output.
    #[error("with --json standard output is the JSON document; write the file somewhere else than to `-`")]
    StandardWithJson,
    /// A folder is wanted.
    #[error("`-` is standard output, and this command writes {what}; give {what}'s name")]
    NotStandard {
        /// What it writes, with an article.
        what: &'static str,
    },
    /// A name that would leave its folder.
    #[error("`{name}` cannot be the name of a file in {folder}: it holds a `/`, or is none")]
    Name {
        /// The name.
        name: String,
        /// The folder.
        folder: String,
    },
    /// The folder holds the recordings of another session.
    #[error(
        "{folder} holds a session already ({recordings} recordings); give another folder, or --force to replace that session"
    )]
    Session {
        /// The folder.
        folder: String,
        /// Recordings in it.
        recordings: usize,
    },
    /// The file system does not allow it.
    #[error("{file}: cannot be written: {source}")]
    Write {
        /// The file's name as it was given.
        file: String,
        /// What the system said.
        #[serde(skip)]
        source: io::Error,
    },
}

impl TargetError {
    /// Whether the arguments contradict each other, whatever the files are.
    pub const fn is_usage(&self) -> bool {
        matches!(self, Self::Twice { .. } | Self::StandardWithJson | Self::NotStandard { .. })
    }
}

impl From<OsString> for Target {
    fn from(text: OsString) -> Self {
        if text == "-" { Self::Standard } else { Self::File(text.into()) }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard => out.write_str("standard output"),
            Self::File(path) => path.display().fmt(out),
        }
    }
}

impl Target {
    /// Writes through `content`: a file whole or not at all.
    ///
    /// # Errors
    /// What `content`, the file system or standard output report. That the reader of standard output has gone is no error.
    pub fn write(&self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), TargetError> {
        let done = match self {
            Self::File(path) => write_whole(path, content),
            Self::Standard => {
                let mut out = io::BufWriter::new(io::stdout().lock());
                match content(&mut out).and_then(|()| out.flush()) {
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                    done => done,
                }
            }
        };
        done.map_err(|source| TargetError::Write { file: self.to_string(), source })
    }

    /// Writes a text.
    ///
    /// # Errors
    /// As [`Target::write`].
    pub fn write_text(&self, text: &str) -> Result<(), TargetError> {
        self.write(|out| out.write_all(text.as_bytes()))
    }
}

/// Checks before any work that `path` may become a file of this kind. What is there already must be empty, or such a file
/// that breakaway wrote, unless `force`; an input is never written over. Nothing is changed.
///
/// # Errors
/// [`TargetError::Input`], [`TargetError::NotOurs`], [`TargetError::Write`].
pub fn may_write(path: &Path, kind: FileKind, inputs: &[&Path], force: bool) -> Result<(), TargetError> {
    let file = || path.display().to_string();
    if fs::metadata(path).is_ok_and(|found| found.is_file()) {
        if inputs.iter().any(|input| place(input) == place(path)) {
            return Err(TargetError::Input { file: file() });
        }
        let head = head(path).map_err(|source| TargetError::Write { file: file(), source })?;
        if !(force || head.is_empty() || kind.is_of(&head)) {
            return Err(TargetError::NotOurs { file: file(), kind, found: crate::mistaken::seems(&head) });
        }
    }
    can_write(path).map_err(|source| TargetError::Write { file: file(), source })
}

/// Checks that no two of `targets` are one place.
///
/// # Errors
/// [`TargetError::Twice`].
pub fn apart(targets: &[&Target]) -> Result<(), TargetError> {
    let place_of = |target: &Target| match target {
        Target::Standard => PathBuf::from("-"),
        Target::File(path) => place(path),
    };
    for (k, target) in targets.iter().enumerate() {
        if targets[..k].iter().any(|other| place_of(other) == place_of(target)) {
            return Err(TargetError::Twice { file: target.to_string() });
        }
    }
    Ok(())
}

/// The file `name.extension` in `folder`.
///
/// # Errors
/// [`TargetError::Name`] if that is not a file in this very folder.
pub fn inside(folder: &Path, name: &str, extension: &str) -> Result<PathBuf, TargetError> {
    let file = format!("{name}.{extension}");
    let parts: Vec<Component<'_>> = Path::new(&file).components().collect();
    let plain = !name.is_empty() && !name.contains(['/', '\\']) && !name.contains(char::is_control);
    match parts.as_slice() {
        [Component::Normal(_)] if plain => Ok(folder.join(file)),
        _ => Err(TargetError::Name { name: name.to_owned(), folder: folder.display().to_string() }),
    }
}

/// A path that is the same for all names of one file, whether it is there or not.
fn place(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| {
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf());
        path.file_name().map_or_else(|| folder.clone(), |name| folder.join(name))
    })
}

/// The first bytes of a file, and the last ones of a log file, which may say there who wrote it.
fn head(path: &Path) -> io::Result<Vec<u8>> {
    let (mut file, mut head) = (fs::File::open(path)?, Vec::new());
    (&mut file).take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    if LOG_MARKS.iter().any(|mark| head.starts_with(mark)) {
        let end = file.metadata()?.len().saturating_sub(HEAD_BYTES as u64);
        file.seek(io::SeekFrom::Start(end))?;
        file.take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    }
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_breakaway_wrote_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("own.toml"), "# identified by breakaway 0.1.0 (weak_form)\n\n[base]\n").unwrap();
        fs::write(path("hand.toml"), "[base]\nb = 1\n").unwrap();
        fs::write(path("log.csv"), "t,u,x\n0,1,2\n1,2,3\n").unwrap();
        fs::write(path("empty"), "").unwrap();
        let check = |name: &str, force| may_write(&path(name), FileKind::Model, &[&path("log.csv")], force);
        for free in ["own.toml", "empty", "new.toml"] {
            check(free, false).unwrap();
        }
        let refused = check("hand.toml", false).unwrap_err().to_string();
        assert!(refused.ends_with("hand.toml is there already, and is not a model that breakaway wrote, but a model (TOML); give another name, or --force to replace it"), "{refused}");
        check("hand.toml", true).unwrap();
        // An input stays, whatever its name here and however much it is asked for.
        for name in ["log.csv", "./log.csv", "../log.csv"] {
            let name = if name.starts_with("..") {
                format!("../{}/log.csv", folder.path().file_name().unwrap().display())
            } else {
                name.to_owned()
            };
            assert!(matches!(check(&name, true), Err(TargetError::Input { .. })), "{name}");
        }
        assert!(matches!(check("no/such.toml", false), Err(TargetError::Write { .. })));
    }

    #[test]
    fn two_results_in_one_place_are_seen_before_they_are_there() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| Target::File(folder.path().join(name));
        apart(&[&file("a"), &file("b"), &Target::Standard]).unwrap();
        for pair in [[&file("a"), &file("./a")], [&Target::Standard, &Target::Standard]] {
            assert!(matches!(apart(&pair), Err(TargetError::Twice { .. })), "{pair:?}");
        }
    }

    #[test]
    fn names_do_not_leave_their_folder() {
        let folder = Path::new("out");
        assert_eq!(inside(folder, "relay 1,5", "csv").unwrap(), Path::new("out/relay 1,5.csv"));
        assert_eq!(inside(folder, "..", "csv").unwrap(), Path::new("out/...csv"));
        for name in ["../x", "a/b", "/etc/x", "a\\b", "", "a\nb"] {
            assert!(matches!(inside(folder, name, "csv"), Err(TargetError::Name { .. })), "{name:?}");
        }
    }
}
