//! Ctrl-C: files being written are removed before the process ends.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, PoisonError};

static BEING_WRITTEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Exit code of a process ended by Ctrl-C (128 + SIGINT), as shells report it.
const INTERRUPTED: i32 = 130;

/// From here on, Ctrl-C removes what [`remove_if_interrupted`] was told of and ends the process with code 130.
///
/// # Errors
/// When the system refuses the handler, or one is installed already.
pub fn install() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| {
        // The lock is kept until the end: no new file may be started meanwhile.
        let files = BEING_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        for file in files.iter() {
            // Nothing can be done about a file that does not go: the process is ending.
            let _ = fs::remove_file(file);
        }
        process::exit(INTERRUPTED)
    })
}

/// Keeps a file on the list of those Ctrl-C removes, as long as it lives.
#[derive(Debug)]
#[must_use]
pub struct RemoveIfInterrupted(PathBuf);

/// Puts a file that is only half written on the list of those Ctrl-C removes.
pub fn remove_if_interrupted(path: &Path) -> RemoveIfInterrupted {
    let mut files = BEING_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    files.push(path.to_path_buf());
    RemoveIfInterrupted(path.to_path_buf())
}

impl Drop for RemoveIfInterrupted {
    fn drop(&mut self) {
        let mut files = BEING_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        files.retain(|file| *file != self.0);
    }
}
