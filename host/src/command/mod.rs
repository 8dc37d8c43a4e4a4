//! The commands: one file each, with its arguments and a `run`.
//!
//! A new command is a variant of [`cli::CliCommand`], an arm in [`cli::run()`], and its file.
//!
//! Without the feature `command` there is no command line: what `look`, `identify` and `discover` do with recordings that
//! are read already, and their documents.

#[cfg(feature = "command")]
pub mod bode;
#[cfg(feature = "command")]
pub mod capture;
#[cfg(feature = "command")]
pub mod cli;
#[cfg(feature = "command")]
pub mod completions;
pub mod console;
#[cfg(feature = "command")]
pub mod demo;
#[cfg(feature = "command")]
pub mod device;
pub mod discover;
#[cfg(feature = "command")]
pub mod effects;
#[cfg(feature = "command")]
pub mod export;
#[cfg(feature = "command")]
pub mod failure;
pub mod figures;
pub mod identify;
pub mod look;
#[cfg(feature = "command")]
pub mod man;
#[cfg(feature = "command")]
pub mod models;
#[cfg(feature = "command")]
pub mod monitor;
pub mod output;
#[cfg(feature = "command")]
pub mod port_args;
#[cfg(feature = "command")]
pub mod progress;
pub mod recording_args;
#[cfg(feature = "command")]
pub mod run;
#[cfg(feature = "command")]
pub mod schema;
pub mod session;
#[cfg(feature = "command")]
pub mod simulate;
#[cfg(feature = "command")]
pub mod sinefit;
#[cfg(feature = "command")]
pub mod track;
#[cfg(feature = "command")]
pub mod tune;
#[cfg(feature = "command")]
pub mod virtual_board;

#[cfg(feature = "command")]
pub use cli::{Cli, CliCommand, parse, run};

/// A combination of arguments that makes no sense: exit code 2, as for those clap refuses itself.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct UsageError(pub String);
