//! What is said on standard error beside the results: warnings, and with `-v` what is being done.

use std::fmt::Display;
use std::sync::atomic::{AtomicU8, Ordering};

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

/// Says what is doubtful.
pub fn warn(text: impl Display) {
    if !is(Verbosity::Quiet) {
        eprintln!("warning: {text}");
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
