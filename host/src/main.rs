//! The `breakaway` command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;

use breakaway::command::Cli;

fn main() -> ExitCode {
    if let Err(error) = breakaway::interrupt::install() {
        eprintln!("warning: Ctrl-C will not clean up: {error}");
    }
    breakaway::command::run(Cli::parse())
}
