//! `cargo xtask test`: everything a change must pass.

use std::process::ExitCode;

use anyhow::Result;

use crate::budget;
use crate::cross::{self, Toolchain};
use crate::image;
use crate::report::Report;
use crate::run::{cargo, run, run_counting, succeeds};
use crate::setup;

/// Runs all steps, stops at the first that fails, and ends with `N passed, N failed`.
pub fn all() -> ExitCode {
    let mut report = Report::default();
    let result = steps(&mut report);
    if let Err(error) = &result {
        println!("\nFAILED: {error:#}");
    }
    report.close();
    if result.is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

fn steps(report: &mut Report) -> Result<()> {
    report.check("rustfmt", || {
        setup::components()?;
        run(&mut cargo(["fmt", "--all", "--", "--check"]))
    })?;
    report.check("clippy", || {
        run(&mut cargo(["clippy", "--workspace", "--all-targets", "--all-features", "--", "-D", "warnings"]))
    })?;
    let mut toolchain = Toolchain::Active;
    report.check("toolchain for the microcontrollers", || {
        toolchain = cross::install()?;
        Ok(())
    })?;
    report.check("image of the virtual board, and QEMU", || {
        image::qemu()?;
        image::build(toolchain)
    })?;
    report.check("budget of the firmware", || budget::measure(toolchain, false))?;
    report.tests("host tests", || run_counting(&mut cargo(host_tests())))?;
    report.tests("documentation tests", || {
        run_counting(&mut cargo(["test", "--workspace", "--doc", "--no-fail-fast"]))
    })?;
    report.check("`cargo run` without a name runs the command, as the README says", || {
        run(&mut cargo(["run", "--quiet", "--", "--version"]))
    })?;
    for (title, build) in cross::BUILDS {
        report.check(title, || cross::build(toolchain, build))?;
    }
    Ok(())
}

/// nextest where it is installed (it runs the tests of all crates side by side), else cargo's own runner.
fn host_tests() -> &'static [&'static str] {
    if succeeds(&mut cargo(["nextest", "--version"])) {
        &["nextest", "run", "--workspace", "--all-features", "--no-fail-fast", "--status-level", "slow"]
    } else {
        &["test", "--workspace", "--all-features", "--lib", "--bins", "--tests", "--no-fail-fast"]
    }
}
