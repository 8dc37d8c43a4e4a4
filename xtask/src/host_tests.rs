//! The tests on the host. A virtual board is an emulator, a plant and a client, with time-outs of real time between them. They
//! leave one of two processors idle, which the other tests take at the lowest priority.

use std::process::Command;
use std::thread;
use std::time::Instant;

use anyhow::{Result, anyhow};

use crate::check::ALL;
use crate::lint::cargo_linted;
use crate::processor;
use crate::report::{Report, Taken};
use crate::run::{beside, cargo, run_counting, succeeds, yielding};

/// What needs a QEMU.
pub const BOARDS: &str = "virtual_board";

/// nextest where it is installed, which runs the tests of all crates side by side; else cargo's own runner. With that, the
/// tests look for QEMU, Unicorn and MuJoCo themselves. `programs` are tests that need one, and whether it is there.
pub fn all(report: &mut Report, programs: [(&str, bool); 4]) -> Result<()> {
    const TITLE: &str = "host tests";
    if !succeeds(&mut cargo(["nextest", "--version"])) {
        return report.tests(TITLE, || run_counting(cargo_linted(["test", "--tests", "--no-fail-fast"]).args(ALL)));
    }
    let boards = programs.iter().any(|(program, there)| *program == BOARDS && *there);
    let left_out = programs.into_iter().filter(|(program, there)| !there || *program == BOARDS);
    let left_out: Vec<String> = left_out.map(|(program, _)| format!("not binary({program})")).collect();
    let mut others = nextest(&left_out.join(" and "));
    if !boards {
        return report.tests(TITLE, || run_counting(&mut others));
    }
    let boards = format!("binary({BOARDS})");
    thread::scope(|scope| {
        let ahead_s = processor::time_beside_s();
        let begun = Instant::now();
        let boards = scope.spawn(move || {
            let done = beside(|| run_counting(&mut nextest(&boards)));
            (done, begun.elapsed())
        });
        let result = report.tests(TITLE, || yielding(|| run_counting(&mut others)));
        let (done, time) = boards.join().map_err(|_| anyhow!("who waits for the virtual boards has panicked"))?;
        let processor_s = processor::time_beside_s().zip(ahead_s).map(|(end, begin)| end - begin);
        let of_boards = report.ended("tests of the virtual board: beside those", Taken { time, processor_s }, done);
        result.and(of_boards)
    })
}

/// Runs the tests that `filter` lets through. What passed is counted and its time read, not shown.
fn nextest(filter: &str) -> Command {
    let mut command = cargo_linted(["nextest", "run", "--tests", "--no-fail-fast"]);
    command.args(ALL).args(["--status-level", "pass", "--color", "never", "--filterset", filter]);
    command
}
