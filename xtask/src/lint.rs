//! Clippy as the compiler of our crates. It lints while it builds, so that no crate is compiled for the lints alone.

use std::ffi::OsStr;
use std::process::Command;

use crate::run::cargo;

/// Cargo calls this program, where it would call rustc for a crate of the workspace. `cargo clippy` does the same.
const DRIVER: (&str, &str) = ("RUSTC_WORKSPACE_WRAPPER", "clippy-driver");
/// The words of a separator between the arguments, as `cargo clippy` has it.
const END: &str = "__CLIPPY_HACKERY__";
/// Warnings are errors.
const ARGUMENTS: [&str; 2] = ["-D", "warnings"];

/// As [`cargo`], with clippy as the compiler of our crates. Cargo builds them anew where a command has another compiler than
/// the last one, so that all steps of the tests are started so.
pub fn cargo_linted<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> Command {
    let mut command = cargo(args);
    linted(&mut command);
    command
}

/// The same for a command that starts cargo by itself.
pub fn linted(command: &mut Command) {
    command.env(DRIVER.0, DRIVER.1).env("CLIPPY_ARGS", ARGUMENTS.map(|word| format!("{word}{END}")).concat());
}
