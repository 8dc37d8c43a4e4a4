//! `cargo xtask bench`: the benches, in release.

pub mod peers;

use std::process::Command;

use anyhow::{Context, Result};

use crate::cross::target_folder;
use crate::export;
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

/// Machines of MuJoCo: sessions into the target folder, rows into docs/mujoco.csv, and docs/mujoco.md from them. Two sessions
/// are discovered at once, each on one core.
pub fn mujoco(seeds: &str, scenarios: Option<&str>, anew: bool) -> Result<()> {
    let (python, sessions) = (export::python()?, target_folder().join("mujoco-sessions"));
    let asked: Vec<&str> =
        ["--seeds", seeds].into_iter().chain(scenarios.iter().flat_map(|own| ["--scenarios", own])).collect();
    let mut simulate = Command::new(python);
    run(simulate.arg("-B").arg(root().join("tests/mujoco/machines/session.py")).arg(&sessions).args(&asked))?;
    let example =
        || cargo(["run", "--package", "breakaway-tests", "--example", "mujoco", "--", "--csv", "docs/mujoco.csv"]);
    let (commit, date) = (commit()?, date()?);
    let mut discover = example();
    discover.arg("--sessions").arg(&sessions).args(["--jobs", "2", "--commit", &commit]).args(&asked);
    run(discover.args(anew.then_some("--anew")))?;
    let words: Vec<&str> = ["cargo xtask mujoco"].into_iter().chain(asked).collect();
    run(example().args(["--page", "docs/mujoco.md", "--date", &date, "--command", &words.join(" ")]))
}

fn commit() -> Result<String> {
    answer(Command::new("git").args(["rev-parse", "--short", "HEAD"]).current_dir(root())).context("git")
}

fn date() -> Result<String> {
    answer(Command::new("date").args(["-u", "+%Y-%m-%d"])).context("date")
}

/// The real machines: rows into docs/machines.csv, and docs/machines.md from them. In the dev profile, which takes a sixth
/// longer than release and is built in a fifth of the time.
pub fn machines(arguments: &[String]) -> Result<()> {
    let example = || cargo(["run", "--package", "breakaway-tests", "--example", "machines", "--"]);
    let (commit, date) = (commit()?, date()?);
    run(example().args(["--csv", ROWS, "--commit", &commit]).args(arguments))?;
    let words: Vec<&str> = ["cargo xtask machines"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    run(example().args(["--csv", ROWS, "--page", PAGE, "--date", &date, "--command", &words.join(" ")]))
}
