//! The folders of a fleet, and what is in each.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why a folder is no fleet, or a machine's folder cannot be used.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum FolderError {
    /// The system could not list the folder.
    #[error("the folder {folder} cannot be read")]
    Read {
        /// The folder.
        folder: String,
        /// What the system said.
        #[serde(skip)]
        source: io::Error,
    },
    /// The fleet's folder holds no folder.
    #[error("{folder} holds no machine: it needs one folder per machine, with its recordings in fit/*.csv or *.csv")]
    NoMachine {
        /// The folder.
        folder: String,
    },
    /// No recording to fit.
    #[error("no recordings: {folder} needs fit/*.csv (and score/*.csv), or *.csv")]
    NoRecordings {
        /// The folder.
        folder: String,
    },
    /// Recordings to score, and none to fit.
    #[error("recordings to score but none to fit: {folder} has score/*.csv and needs fit/*.csv too")]
    NothingToFit {
        /// The folder.
        folder: String,
    },
    /// Two models.
    #[error("{folder} has base.toml and model.toml; keep the one to start from")]
    TwoModels {
        /// The folder.
        folder: String,
    },
}

/// A machine of the fleet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Name of its folder.
    pub name: String,
    /// Its folder.
    pub folder: PathBuf,
}

/// The files of a machine.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Recordings to fit, by name.
    pub fit: Vec<PathBuf>,
    /// Recordings to score, by name; empty for the last third of those to fit.
    pub score: Vec<PathBuf>,
    /// Model to start from, if there is one.
    pub model: Option<PathBuf>,
}

/// The machines in `folder`, by name: every folder in it that is not hidden.
///
/// # Errors
/// [`FolderError::Read`], [`FolderError::NoMachine`].
pub fn machines(folder: &Path) -> Result<Vec<Machine>, FolderError> {
    let found: Vec<Machine> = entries(folder)?
        .into_iter()
        .filter(|path| path.is_dir())
        .filter_map(|folder| Some(Machine { name: folder.file_name()?.to_string_lossy().into_owned(), folder }))
        .filter(|machine| !machine.name.starts_with('.'))
        .collect();
    if found.is_empty() {
        return Err(FolderError::NoMachine { folder: folder.display().to_string() });
    }
    Ok(found)
}

impl Machine {
    /// Its files: `fit/*.csv` and `score/*.csv`, or where there are none of them `*.csv`; `base.toml` or `model.toml`.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn inputs(&self) -> Result<Inputs, FolderError> {
        let folder = || self.folder.display().to_string();
        let recordings = |name: &str| match self.folder.join(name) {
            part if part.is_dir() => csv_files(&part),
            _ => Ok(Vec::new()),
        };
        let (mut fit, score) = (recordings("fit")?, recordings("score")?);
        if fit.is_empty() && !score.is_empty() {
            return Err(FolderError::NothingToFit { folder: folder() });
        }
        if fit.is_empty() {
            fit = csv_files(&self.folder)?;
        }
        if fit.is_empty() {
            return Err(FolderError::NoRecordings { folder: folder() });
        }
        let models = ["base.toml", "model.toml"].map(|name| self.folder.join(name)).into_iter();
        let mut models = models.filter(|path| path.exists());
        let model = models.next();
        if models.next().is_some() {
            return Err(FolderError::TwoModels { folder: folder() });
        }
        Ok(Inputs { fit, score, model })
    }
}

/// What is in a folder, by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, FolderError> {
    let list = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    let mut found = list().map_err(|source| FolderError::Read { folder: folder.display().to_string(), source })?;
    found.sort();
    Ok(found)
}

fn csv_files(folder: &Path) -> Result<Vec<PathBuf>, FolderError> {
    let ends = |path: &Path, with: &str| path.extension().is_some_and(|ext| ext.eq_ignore_ascii_case(with));
    let packed = |path: &Path| ends(path, "gz") && path.file_stem().is_some_and(|stem| ends(stem.as_ref(), "csv"));
    let csv = |path: &PathBuf| (ends(path, "csv") || packed(path)) && !path.is_dir();
    let hidden = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    Ok(entries(folder)?.into_iter().filter(|path| csv(path) && !hidden(path)).collect())
}
