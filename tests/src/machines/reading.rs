//! Reading a machine's files, as the `breakaway` command would.

use std::fs;
use std::path::{Path, PathBuf};

use breakaway::recording::{ReadOptions, Recording};

use super::Machine;

/// One file: its recordings, and what is to be said of it.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name of the file.
    pub file: String,
    /// The recording, or none where it was refused.
    pub recording: Option<Recording>,
    /// The reader's refusal, if there was one.
    pub remark: Option<String>,
}

/// Why a machine cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadingError {
    /// The folder cannot be listed.
    #[error("{folder}: cannot be listed")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Another number of files than the catalogue says.
    #[error("{folder}: {found} files, and the catalogue says {expected}")]
    Files {
        /// The folder.
        folder: PathBuf,
        /// Files there.
        found: usize,
        /// Files of the catalogue.
        expected: usize,
    },
    /// No drive was logged.
    #[error("no drive logged")]
    NoDrive,
}

/// The paths of a machine's files, by name.
///
/// # Errors
/// [`ReadingError::Folder`] and [`ReadingError::Files`].
pub fn files(machine: &Machine, data: &Path) -> Result<Vec<PathBuf>, ReadingError> {
    let folder = data.join(machine.folder);
    let listed = |source| ReadingError::Folder { folder: folder.clone(), source };
    let mut paths = Vec::new();
    for entry in fs::read_dir(&folder).map_err(listed)? {
        let path = entry.map_err(listed)?.path();
        let csv = path.extension().is_some_and(|ending| ending == "csv");
        if csv && file_name(&path).starts_with(machine.prefix) {
            paths.push(path);
        }
    }
    if paths.len() != machine.files {
        return Err(ReadingError::Files { folder, found: paths.len(), expected: machine.files });
    }
    paths.sort();
    Ok(paths)
}

/// Reads a machine's files, by name.
///
/// # Errors
/// [`ReadingError`]. A file that the reader refuses is no error: its [`Source`] says so.
pub fn read(machine: &Machine, data: &Path) -> Result<Vec<Source>, ReadingError> {
    let options = machine.columns.options().ok_or(ReadingError::NoDrive)?;
    let mut sources: Vec<Source> = files(machine, data)?.iter().map(|path| source(path, &options)).collect();
    if let Some(units) = machine.columns.units() {
        for recording in sources.iter_mut().flat_map(|source| &mut source.recording) {
            recording.units = units.clone();
        }
    }
    Ok(sources)
}

fn source(path: &Path, options: &ReadOptions) -> Source {
    let file = file_name(path);
    match Recording::read(path, options) {
        Ok(recording) => Source { file, recording: Some(recording), remark: None },
        Err(error) => {
            let folder = path.parent().map(|folder| format!("{}/", folder.display())).unwrap_or_default();
            let remark = error.to_string().replace(&folder, "");
            Source { file, recording: None, remark: Some(remark) }
        }
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}
