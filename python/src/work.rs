//! Work on a thread of its own, without Python's lock, while the caller looks for Ctrl-C.

use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use anyhow::Context as _;
use breakaway::discover::progress::Progress;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::exception;

/// How often signals are looked for: too short to be felt at a keyboard.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// What the working thread says.
enum Said<T> {
    /// A step has begun.
    Step(String),
    /// Done.
    Done(anyhow::Result<T>),
}

/// What unwinds a thread whose caller has gone: not a panic, and nothing is printed.
struct NobodyWaits;

/// By which the work says what it does.
pub struct Steps<T>(Sender<Said<T>>);

impl<T> Steps<T> {
    /// Passes on a step. Where the caller has gone (Ctrl-C), the work ends here.
    pub fn show(&self, progress: Progress<'_>) {
        let step = match progress {
            Progress::Step(what) => what.to_owned(),
            Progress::Round { effect, candidates } => format!("looking for effect {effect} among {candidates}"),
            // It says nothing, and asks whether somebody still waits.
            Progress::Compared => String::new(),
        };
        if self.0.send(Said::Step(step)).is_err() {
            resume_unwind(Box::new(NobodyWaits));
        }
    }
}

/// Does `work` on another thread. `progress` is called with each step in words, on the calling thread.
///
/// # Errors
/// The work's; Ctrl-C's, and what `progress` raises: the work then ends at its next step, and nobody waits for it.
pub fn away<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Steps<T>) -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (say, hear) = channel();
    let worker = thread::Builder::new().name("breakaway".to_owned()).spawn(move || {
        let steps = Steps(say);
        let done = work(&steps);
        // Nobody may wait for it any more.
        let _ = steps.0.send(Said::Done(done));
    })?;
    let hear = std::sync::Mutex::new(hear);
    loop {
        let heard = py.detach(|| match hear.lock() {
            Ok(hear) => hear.recv_timeout(LOOK_EVERY),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match heard {
            Ok(Said::Done(done)) => return done.map_err(|error| exception(py, &error)),
            Ok(Said::Step(step)) => {
                if let Some(progress) = progress.filter(|_| !step.is_empty()) {
                    progress.call1((step,))?;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        py.check_signals()?;
    }
    // Only a defect of the library comes here. Its text is on standard error.
    let _ = py.detach(|| worker.join());
    Err(PyRuntimeError::new_err("the work ended by a defect of breakaway; please report it with the lines above"))
}

/// Runs `work` with so many threads, or with all cores.
///
/// # Errors
/// The work's; threads that cannot be started.
pub fn with_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> anyhow::Result<T> + Send,
) -> anyhow::Result<T> {
    match threads {
        Some(threads) => {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.context("the threads cannot be started")?.install(work)
        }
        None => work(),
    }
}
