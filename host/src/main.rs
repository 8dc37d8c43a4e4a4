//! The `breakaway` command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    if let Err(error) = breakaway::interrupt::install() {
        eprintln!("warning: Ctrl-C will not clean up: {error}");
    }
    match breakaway::command::parse() {
        Ok(cli) => breakaway::command::run(cli),
        Err(code) => code,
    }
}
