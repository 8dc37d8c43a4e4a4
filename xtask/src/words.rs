//! The checks beside the code: words, the interface of the core, and the dependencies' licences and sources.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;

use crate::cross::target_folder;
use crate::environment::environment;
use crate::report::Report;
use crate::run::{answer, cargo, root, run, succeeds};

/// The program that finds wrong words: the installed one, else one from PyPI in the target folder.
fn typos() -> Result<PathBuf> {
    program("typos")
}

/// The program that compares a workflow with the schema that it carries along: as [`typos`].
fn workflow_checker() -> Result<PathBuf> {
    program("check-jsonschema")
}

/// Sees to it that both are there.
///
/// # Errors
/// No Python, or no PyPI; with what to install.
pub fn programs() -> Result<()> {
    typos()?;
    workflow_checker().map(drop)
}

fn program(name: &str) -> Result<PathBuf> {
    if succeeds(Command::new(name).arg("--version")) {
        return Ok(name.into());
    }
    let python = environment(&target_folder().join("words-venv"), &root().join("xtask/requirements.txt"))?;
    Ok(python.with_file_name(name))
}

/// Every workflow has the form that its runner takes: keys, types and what must be there.
fn workflows(program: &Path) -> Result<()> {
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(root().join(".github/workflows"))? {
        files.push(entry?.path());
    }
    files.sort();
    run(Command::new(program).args(["--builtin-schema", "vendor.github-workflows"]).args(files))
}

/// Wrong words in source and pages fail. So do workflows of a wrong form. So do licences and sources of the dependencies that deny.toml does not allow.
/// So do changes of the core's interface that its version does not announce. The programs that check them take long to
/// build, so that each check is made only where its program is installed.
pub fn words_interface_licences(report: &mut Report) -> Result<()> {
    match typos() {
        Ok(program) => report.check("words (typos)", || run(Command::new(program).current_dir(root())))?,
        Err(error) => report.not_run(format!("wrong words: no typos (`cargo install typos-cli`): {error:#}")),
    }
    match workflow_checker() {
        Ok(program) => report.check("workflows (check-jsonschema)", || workflows(&program))?,
        Err(error) => report.not_run(format!("form of the workflows: no check-jsonschema: {error:#}")),
    }
    let tag = ["describe", "--tags", "--abbrev=0", "--match", "v*"];
    let released = answer(Command::new("git").args(tag).current_dir(root()));
    match (succeeds(&mut cargo(["semver-checks", "--version"])), released) {
        (true, Some(tag)) => {
            let check = ["semver-checks", "--package", "breakaway-core", "--baseline-rev", &tag];
            report.check("interface of the core (cargo-semver-checks)", || run(&mut cargo(check)))?;
        }
        (true, None) => report.not_run("interface of the core: no version is tagged (v*) to compare with".to_owned()),
        (false, _) => report.not_run(
            "interface of the core: cargo-semver-checks is not installed (`cargo install cargo-semver-checks`)"
                .to_owned(),
        ),
    }
    if succeeds(&mut cargo(["deny", "--version"])) {
        // Advisories need the network.
        let check = ["deny", "--offline", "check", "bans", "licenses", "sources"];
        return report.check("licences and sources (cargo-deny)", || run(&mut cargo(check)));
    }
    report.not_run("licences and sources: cargo-deny is not installed (`cargo install cargo-deny`)".to_owned());
    Ok(())
}
