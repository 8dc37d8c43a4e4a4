//! Ctrl-C: files being written are removed before the process ends, and work that has to be finished is finished.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

static BEING_WRITTEN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
/// Work that wants to be asked before the process ends.
static FINISHING: AtomicUsize = AtomicUsize::new(0);
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a process ended by Ctrl-C (128 + SIGINT), as shells report it.
pub const INTERRUPTED: u8 = 130;

/// From here on, Ctrl-C removes what [`remove_if_interrupted`] was told of and ends the process with code 130. The same
/// holds for a request to terminate, and for a terminal that is closed.
///
/// # Errors
/// When the system refuses the handler, or one is installed already.
pub fn install() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(|| {
        // Who has asked to finish first is given one chance.
        if FINISHING.load(Ordering::SeqCst) > 0 && !REQUESTED.swap(true, Ordering::SeqCst) {
            return;
        }
        // The lock is kept until the end: no new file may be started meanwhile.
        let files = BEING_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        for file in files.iter() {
            // Nothing can be done about a file that does not go: the process is ending.
            let _ = fs::remove_file(file);
        }
        process::exit(i32::from(INTERRUPTED))
    })
}

/// As long as it lives, the first Ctrl-C does not end the process but is left to its owner; the second one ends it.
#[derive(Debug)]
#[must_use]
pub struct FinishFirst(());

/// Lets the caller finish its work on the first Ctrl-C.
pub fn finish_first() -> FinishFirst {
    FINISHING.fetch_add(1, Ordering::SeqCst);
    FinishFirst(())
}

impl FinishFirst {
    /// As if Ctrl-C had come: a terminal in raw mode makes a key of it.
    pub fn request(&self) {
        REQUESTED.store(true, Ordering::SeqCst);
    }

    /// Whether Ctrl-C has come.
    pub fn requested(&self) -> bool {
        REQUESTED.load(Ordering::SeqCst)
    }
}

impl Drop for FinishFirst {
    fn drop(&mut self) {
        FINISHING.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Keeps a file on the list of those Ctrl-C removes, as long as it lives.
#[derive(Debug)]
#[must_use]
pub struct RemoveIfInterrupted(PathBuf);

/// Makes a file and puts it, only half written as it is, on the list of those Ctrl-C removes. Ctrl-C comes before or after
/// both: never between them, where it would leave the file.
///
/// # Errors
/// Those of `make`.
pub fn remove_if_interrupted<F: AsRef<Path>>(
    make: impl FnOnce() -> io::Result<F>,
) -> io::Result<(F, RemoveIfInterrupted)> {
    let mut files = BEING_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    let file = make()?;
    let path = file.as_ref().to_path_buf();
    files.push(path.clone());
    Ok((file, RemoveIfInterrupted(path)))
}

impl Drop for RemoveIfInterrupted {
    fn drop(&mut self) {
        let mut files = BEING_WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
        files.retain(|file| *file != self.0);
    }
}
