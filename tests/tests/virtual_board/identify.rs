//! From a known plant, over the pseudo-terminal, back to the plant.

use std::process::{Command as Process, Stdio};

use breakaway::command::run::papers_plant;
use breakaway_core::link::{Command, Ending, IdentificationVerdict, Reply};

use crate::bench::{Bench, options, start};

/// The program itself.
pub fn breakaway(arguments: &[&str]) -> serde_json::Value {
    let output = Process::new(program()).args(arguments).arg("--json").stdin(Stdio::null()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "breakaway {}: {said}", arguments.join(" "));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What the program says when it does not do it.
pub fn refused(arguments: &[&str]) -> String {
    let output = Process::new(program()).args(arguments).stdin(Stdio::null()).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "breakaway {}", arguments.join(" "));
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Built beside this test (`CARGO_BIN_EXE_` is for tests of its own package only).
pub fn program() -> std::path::PathBuf {
    let test = std::env::current_exe().unwrap();
    let program = test.parent().and_then(std::path::Path::parent).unwrap().join("breakaway");
    assert!(program.is_file(), "{} is missing: build it by `cargo build -p breakaway`", program.display());
    program
}

fn relay_file(folder: &std::path::Path, name: &str, h1: f64, h2: f64) -> String {
    let file = folder.join(format!("{name}.toml"));
    let text = format!("name = \"{name}\"\nduration_s = 10.0\n[excitation]\nkind = \"relay\"\nh1 = {h1}\nh2 = {h2}\n");
    std::fs::write(&file, text).unwrap();
    file.display().to_string()
}

/// `run` and `identify` on the host: within 1 % of the plant.
#[test]
fn relay_experiments_over_the_port_identify_the_plant() {
    needs_qemu!();
    let board = start(&options(&papers_plant()));
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().display().to_string();
    let mut recordings = Vec::new();
    for (name, h1, h2) in [("high", 2.0, 1.5), ("low", 1.0, 0.7)] {
        let experiment = relay_file(folder.path(), name, h1, h2);
        let done = breakaway(&["run", &experiment, "--port", &board.port, "-o", &session]);
        assert_eq!(done["recordings"][0]["samples"], 10_000, "{done}");
        recordings.push(done["recordings"][0]["file"].as_str().unwrap().to_owned());
    }
    let found = breakaway(&["identify", &recordings[0], &recordings[1]]);
    let truth = papers_plant().base;
    for (name, truth) in [("b", truth.b), ("c", truth.c), ("f1", truth.f1)] {
        let value = found[name]["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.01, "{name} = {value}, not {truth}");
    }
}

/// The board by itself: the weak form in f32 and the integer sine fit, solved on the (emulated) Cortex-M4F.
#[test]
fn the_board_identifies_by_itself() {
    needs_qemu!();
    let mut bench = Bench::new(|_| {});
    for (h1, h2) in [(2.0, 1.5), (1.0, 0.7)] {
        assert_eq!(bench.run_relay(h1, h2, 12_000).ending, Ending::TimeUp);
    }
    let Ok(Reply::Identified(found)) = bench.client.request(Command::Identify) else { panic!("not identified") };
    assert_eq!(found.verdict, IdentificationVerdict::Determined);
    let truth = papers_plant().base;
    // Acceptance row 10 (tests/tests/all/acceptance/mod.rs) for the streaming estimator is 1 %, 0.5 %, 1 % on the
    // exact cycle. Here a run follows another and starts while the axis still moves. So c gets 1.5 %, its three
    // standard errors.
    for (name, got, truth, allowed) in
        [("b", found.b, truth.b, 0.01), ("c", found.c, truth.c, 0.015), ("f1", found.f1, truth.f1, 0.01)]
    {
        let off = f64::from(got.value) / truth - 1.0;
        assert!(off.abs() < allowed, "{name}: {got:?} is off by {:.2} %", 100.0 * off);
    }
    assert!(found.sine.is_some_and(|sine| sine.cycles > 20.0));
}
