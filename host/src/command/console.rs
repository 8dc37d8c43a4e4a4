//! What is said on standard error beside the results: warnings, and with `-v` what is being done.

use std::fmt::Display;
use std::mem::Discriminant;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::recording::Warning;

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verbosity {
    /// Errors alone.
    Quiet,
    /// Warnings, and progress on a terminal.
    Normal,
    /// Each step as a line, also where standard error is no terminal.
    Verbose,
}

/// One for the process: standard error is one, too.
static VERBOSITY: AtomicU8 = AtomicU8::new(Verbosity::Normal as u8);

/// Beside it: what was doubtful in this run.
static WARNINGS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Kinds of the warnings about files so far.
static OF_A_KIND: Mutex<Vec<Discriminant<Warning>>> = Mutex::new(Vec::new());

/// Warnings of one kind that are shown. A folder of recordings of one machine has the same fault in each.
const SHOWN: usize = 3;

/// Sets how much is said from now on.
pub fn set(verbosity: Verbosity) {
    VERBOSITY.store(verbosity as u8, Ordering::Relaxed);
}

/// How much is said.
pub fn verbosity() -> Verbosity {
    [Verbosity::Quiet, Verbosity::Verbose].into_iter().find(|one| is(*one)).unwrap_or(Verbosity::Normal)
}

fn is(verbosity: Verbosity) -> bool {
    VERBOSITY.load(Ordering::Relaxed) == verbosity as u8
}

/// Whether bars and spinners are drawn; with [`Verbosity::Verbose`] lines take their place.
pub fn draws_progress() -> bool {
    is(Verbosity::Normal)
}

/// Whether more is to be said.
pub fn is_verbose() -> bool {
    is(Verbosity::Verbose)
}

/// The warnings so far: a JSON document has them among its remarks.
pub fn warnings() -> Vec<String> {
    WARNINGS.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Says what is doubtful.
pub fn warn(text: impl Display) {
    WARNINGS.lock().unwrap_or_else(PoisonError::into_inner).push(text.to_string());
    if !is(Verbosity::Quiet) {
        eprintln!("warning: {text}");
    }
}

/// Says what is doubtful about one of many files. Of one `kind` the first [`SHOWN`] are shown, and all with `-v`.
pub fn warn_of(kind: Discriminant<Warning>, text: impl Display) {
    let mut kinds = OF_A_KIND.lock().unwrap_or_else(PoisonError::into_inner);
    let before = kinds.iter().filter(|known| **known == kind).count();
    kinds.push(kind);
    if before < SHOWN || is(Verbosity::Verbose) {
        return warn(text);
    }
    WARNINGS.lock().unwrap_or_else(PoisonError::into_inner).push(text.to_string());
    if before == SHOWN {
        note("further warnings of this kind are left out; -v shows them");
    }
}

/// Says what was chosen.
pub fn note(text: impl Display) {
    if !is(Verbosity::Quiet) {
        eprintln!("{text}");
    }
}

/// Says what is being done, with `-v`.
pub fn detail(text: impl Display) {
    if is(Verbosity::Verbose) {
        eprintln!("{text}");
    }
}
