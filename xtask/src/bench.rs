//! `cargo xtask bench`: the benches, in release.

pub mod peers;

use std::process::Command;

use anyhow::{Context, Result};

use crate::cross::target_folder;
use crate::run::{answer, cargo, root, run};

/// Packages with benches.
const PACKAGES: [&str; 2] = ["breakaway-core", "breakaway"];

/// Rows of the real machines, and their page.
const ROWS: &str = "docs/machines.csv";
const PAGE: &str = "docs/machines.md";

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

/// The real machines: rows into docs/machines.csv, and docs/machines.md from them. In the dev profile, which takes a sixth
/// longer than release and is built in a fifth of the time.
pub fn machines(arguments: &[String]) -> Result<()> {
    let example = || cargo(["run", "--package", "breakaway-tests", "--example", "machines", "--"]);
    let commit =
        answer(Command::new("git").args(["rev-parse", "--short", "HEAD"]).current_dir(root())).context("git")?;
    let date = answer(Command::new("date").args(["-u", "+%Y-%m-%d"])).context("date")?;
    run(example().args(["--csv", ROWS, "--commit", &commit]).args(arguments))?;
    let words: Vec<&str> = ["cargo xtask machines"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    run(example().args(["--csv", ROWS, "--page", PAGE, "--date", &date, "--command", &words.join(" ")]))
}
