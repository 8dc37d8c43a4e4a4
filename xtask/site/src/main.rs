//! Builds the documentation as a site: from the folder of book.toml, the first argument, into the second.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use mdbook_driver::MDBook;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [from, to] = arguments.as_slice() else {
        eprintln!("error: expected the folder of book.toml and the one to write to");
        return ExitCode::from(2);
    };
    let built = MDBook::load(from).and_then(|mut book| {
        book.config.build.build_dir = to.into();
        book.build()
    });
    match built {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
