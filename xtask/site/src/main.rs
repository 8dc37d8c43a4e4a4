//! Builds the documentation as a site: the folder of book.toml is the first argument.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use mdbook_driver::MDBook;

fn main() -> ExitCode {
    let root = std::env::args_os().nth(1).unwrap_or_else(|| ".".into());
    match MDBook::load(&root).and_then(|book| book.build()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
