//! `cargo xtask test`: everything a change must pass.

use std::process::{Command, ExitCode};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use anyhow::{Result, anyhow, bail};

use crate::ahead;
use crate::budget;
use crate::cross::{self, Toolchain};
use crate::emulator;
use crate::export;
use crate::image;
use crate::lint::cargo_linted;
use crate::own_features;
use crate::python;
use crate::qemu;
use crate::report::{Report, Tests};
use crate::rp2350;
use crate::run::{Counted, at_low_priority, cargo, one_after_another, run, run_counting, side_by_side, succeeds};
use crate::setup;
use crate::web;
use crate::words::words_interface_licences;

/// Runs all steps, stops at the first that fails; ends with times, what was not run, and `N passed, N failed`.
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
    let mut toolchain = Toolchain::Active;
    report.check("toolchain for the microcontrollers", || {
        toolchain = cross::install()?;
        Ok(())
    })?;
    let stopped = AtomicBool::new(false);
    let taken = thread::scope(|scope| {
        let ahead = scope.spawn(|| ahead::all(toolchain, &stopped));
        let result = host_without_tests(report);
        stopped.store(result.is_err(), Ordering::Relaxed);
        result?;
        ahead.join().map_err(|_| anyhow!("what was begun ahead has panicked"))
    })?;
    report.beside("images, page, QEMU, Unicorn, Pythons: beside the steps above", taken.time, taken.processor_s);
    let (mut qemu, mut missing) = (None, None);
    report.check("image of the virtual board, and QEMU", || {
        image::build(toolchain)?;
        match qemu::program() {
            Ok(found) => qemu = Some(found),
            // In CI nothing is left out.
            Err(error) if std::env::var_os("CI").is_some() => return Err(error),
            Err(error) => missing = Some(error),
        }
        Ok(())
    })?;
    if let Some(error) = missing {
        report.not_run(format!("the tests of the virtual board, and the instructions per tick: {error:#}"));
    }
    let mut emulated = None;
    report.check("image of the board, and Unicorn", || {
        emulator::image(toolchain)?;
        emulated = Some(emulator::library());
        match &emulated {
            Some(Err(error)) if std::env::var_os("CI").is_some() => bail!("{error:#}"),
            _ => Ok(()),
        }
    })?;
    let emulated = match emulated {
        Some(Err(error)) => {
            report.not_run(format!("the tests on the board's registers: {error:#}"));
            false
        }
        _ => true,
    };
    let ticks = emulated.then(|| Command::new(budget::ticks()));
    report.check("budget of the firmware", || budget::measure(toolchain, qemu.as_deref(), ticks, false))?;
    let mut python = None;
    report.check("Python for the emulated Pico 2", || {
        python = Some(rp2350::emulator());
        match &python {
            Some(Err(error)) if std::env::var_os("CI").is_some() => bail!("{error:#}"),
            _ => Ok(()),
        }
    })?;
    match python {
        Some(Ok(python)) => report.check("the Pico 2's image on an emulated core", || rp2350::emulate(&python))?,
        Some(Err(error)) => report.not_run(format!("the Pico 2's image on an emulated core: {error:#}")),
        None => (),
    }
    let mut simulators = None;
    report.check("Python with MuJoCo", || {
        simulators = Some(export::python());
        match &simulators {
            Some(Err(error)) if std::env::var_os("CI").is_some() => bail!("{error:#}"),
            _ => Ok(()),
        }
    })?;
    if let Some(Err(error)) = &simulators {
        report.not_run(format!("exported models in MuJoCo: {error:#}"));
    }
    let simulators = matches!(simulators, Some(Ok(_)));
    let browser = web::prepare(report)?;
    let mut pythons = None;
    report.check("Python for the wheel", || {
        pythons = Some(python::environments());
        match &pythons {
            Some(Err(error)) if std::env::var_os("CI").is_some() => bail!("{error:#}"),
            _ => Ok(()),
        }
    })?;
    if let Some(Err(error)) = &pythons {
        report.not_run(format!("the Python package: {error:#}"));
    }
    let package = || match &pythons {
        Some(Ok(pythons)) => python::test(pythons),
        _ => (Tests::default(), Ok(())),
    };
    let programs =
        [("virtual_board", qemu.is_some()), ("emulator", emulated), ("export", simulators), ("browser", browser)];
    report.tests("host tests, and the Python package", || host_tests(programs, package))?;
    report
        .tests("documentation tests", || run_counting(cargo_linted(["test", "--doc", "--no-fail-fast"]).args(ALL)))?;
    for (title, build) in cross::BUILDS {
        report.check(title, || cross::build(toolchain, build))?;
    }
    Ok(())
}

/// What needs nothing but the host's toolchain.
fn host_without_tests(report: &mut Report) -> Result<()> {
    words_interface_licences(report)?;
    report.check("clippy and host programs", host_programs)?;
    report.check("features of the command", own_features::compare)
}

/// All crates with all their features. Each other choice would build the host anew, as it changes the features of
/// dependencies that are shared.
const ALL: [&str; 2] = ["--workspace", "--all-features"];

/// The one build of the host, with clippy as the compiler: tests, programs, the library that Python loads, examples and benches.
fn host_programs() -> Result<()> {
    run(cargo_linted(["build", "--all-targets"]).args(ALL))
}

/// Programs that a part of the tests needs, with whether each is there.
type Programs = [(&'static str, bool); 4];

/// Runs the host tests by nextest where it is installed; else by cargo's own runner, where the tests look for QEMU, Unicorn
/// and MuJoCo themselves. The tests of the Python `package` run beside them.
fn host_tests(programs: Programs, package: impl FnOnce() -> Counted) -> Counted {
    if !succeeds(&mut cargo(["nextest", "--version"])) {
        let mut all = cargo_linted(["test", "--tests", "--no-fail-fast"]);
        return one_after_another(|| run_counting(all.args(ALL)), package);
    }
    let (real_time, others) = (format!("binary({REAL_TIME})"), format!("not binary({REAL_TIME})"));
    // One more than there are processors, because some tests wait: for a device, a browser, or their own longest part.
    let at_once = thread::available_parallelism().map_or(2, |processors| processors.get() + 1);
    let mut others = nextest(&others, &programs);
    others.args(["--test-threads", &at_once.to_string()]);
    let mut others = at_low_priority(&others);
    // A virtual board is an emulator, a plant and a client, with time-outs of real time between them. Together they take about
    // half of a core. The other tests get what is left. The package's tests wait, because they take a whole core.
    let boards = || {
        let there = programs.contains(&(REAL_TIME, true));
        let mut boards = nextest(&real_time, &programs);
        if there { run_counting(boards.args(["--test-threads", "1"])) } else { (Tests::default(), Ok(())) }
    };
    side_by_side(|| one_after_another(boards, package), || run_counting(&mut others))
}

/// The tests that run in real time.
const REAL_TIME: &str = "virtual_board";

/// Runs the tests that `filter` chooses and whose program is there.
fn nextest(filter: &str, programs: &Programs) -> Command {
    let mut command = cargo_linted(["nextest", "run", "--tests", "--no-fail-fast"]);
    // What passed is counted and its time read, not shown.
    command.args(ALL).args(["--status-level", "pass", "--color", "never"]);
    let left_out = programs.iter().filter(|(_, there)| !there);
    let left_out = left_out.map(|(program, _)| format!("not binary({program})"));
    let filters: Vec<String> = [filter.to_owned()].into_iter().chain(left_out).collect();
    command.args(["--filterset", &filters.join(" and ")]);
    command
}
