//! `cargo xtask bench`: the benches, in release.

pub mod peers;

use anyhow::Result;

use crate::cross::target_folder;
use crate::run::{cargo, root, run};

/// Packages with benches.
const PACKAGES: [&str; 2] = ["breakaway-core", "breakaway"];

/// Runs them one after the other, so that they do not disturb each other.
pub fn all() -> Result<()> {
    for package in PACKAGES {
        println!("\n==> bench {package}");
        run(&mut cargo(["bench", "--package", package]))?;
    }
    Ok(())
}

/// Time and memory over the length and the number of recordings.
pub fn scale() -> Result<()> {
    run(&mut cargo(["build", "--release", "--package", "breakaway"]))?;
    let program = target_folder().join("release/breakaway");
    let mut command = cargo(["run", "--release", "--package", "breakaway-bench", "--bin", "scale", "--"]);
    run(command.arg(program).arg(root().join("docs")))
}

/// The blind matrix.
pub fn blind(arguments: &[String]) -> Result<()> {
    let mut command = cargo(["run", "--release", "--package", "breakaway-tests", "--example", "blind", "--"]);
    run(command.args(arguments))
}
