//! Machines that MuJoCo simulates (tests/mujoco/machines), discovered and scored: a second world, whose dynamics are not ours.
//!
//! `cargo xtask mujoco` makes the sessions, and writes docs/mujoco.md from the [rows](row::Row).

pub mod page;
pub mod row;

use std::path::{Path, PathBuf};

use breakaway::recording::{ReadOptions, Recording};

use crate::machines::discovery::{self, Said};
use crate::machines::rows;
use crate::machines::splits::Taken;

use row::Row;

/// Why a session cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// A folder cannot be listed.
    #[error("{}: cannot be listed", .0.display())]
    Folder(PathBuf, #[source] std::io::Error),
    /// The file of what is true.
    #[error("{}: cannot be read as a truth", .0.display())]
    Truth(PathBuf, #[source] csv::Error),
    /// It has no row.
    #[error("{}: has no row", .0.display())]
    Empty(PathBuf),
    /// A recording is refused.
    #[error("{0}")]
    Recording(String),
}

/// The folders of the sessions in a folder, by name. One without `truth.csv` is not complete, and is left out.
///
/// # Errors
/// [`SessionError::Folder`].
pub fn sessions(folder: &Path) -> Result<Vec<PathBuf>, SessionError> {
    let mut sessions = listed(folder)?;
    sessions.retain(|session| session.join("truth.csv").is_file());
    Ok(sessions)
}

fn listed(folder: &Path) -> Result<Vec<PathBuf>, SessionError> {
    let failed = |error| SessionError::Folder(folder.to_owned(), error);
    let entries = folder.read_dir().map_err(failed)?.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    let mut paths: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
    paths.sort();
    Ok(paths)
}

/// The row of a session before it is discovered: what its `truth.csv` says.
///
/// # Errors
/// [`SessionError::Truth`] and [`SessionError::Empty`].
pub fn undiscovered(session: &Path) -> Result<Row, SessionError> {
    let path = session.join("truth.csv");
    let rows: Vec<Row> = rows::read(&path).map_err(|error| SessionError::Truth(path.clone(), error))?;
    rows.into_iter().next().ok_or(SessionError::Empty(path))
}

/// Discovers a session with nothing told.
///
/// # Errors
/// [`SessionError::Folder`] and [`SessionError::Recording`].
pub fn discovered(session: &Path) -> Result<Said, SessionError> {
    let files = listed(session)?.into_iter().filter(|path| path.file_name().is_some_and(|name| name != "truth.csv"));
    let read = |path: PathBuf| {
        Recording::read(&path, &ReadOptions::default()).map_err(|error| SessionError::Recording(error.to_string()))
    };
    let fit = files.map(read).collect::<Result<Vec<_>, _>>()?;
    Ok(discovery::run(Taken { fit, holdout: Vec::new() }, &|_| ()))
}
