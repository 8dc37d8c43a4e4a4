//! The command itself, on a pseudo-terminal behind which is the emulated LPUART.

use std::process::{Command as Process, Stdio};

use breakaway::command::run::papers_plant;
use breakaway_core::link::Command;
use breakaway_emulator::terminal::Terminal;

use crate::machine::axis;

/// Runs the program, and what it says. It is built beside this test.
fn breakaway(arguments: &[&str]) -> serde_json::Value {
    let test = std::env::current_exe().unwrap();
    let program = test.parent().and_then(std::path::Path::parent).unwrap().join("breakaway");
    assert!(program.is_file(), "{} is missing: build it by `cargo build -p breakaway`", program.display());
    let output = Process::new(program).args(arguments).arg("--json").stdin(Stdio::null()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "breakaway {}: {said}", arguments.join(" "));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// `device info`, two relay experiments, `identify`: within 1 % of the plant, as on the virtual board. Seven seconds are nine
/// cycles.
#[test]
fn the_command_identifies_the_plant() {
    needs_unicorn!();
    let board = Terminal::serve(|| {
        let mut bench = axis();
        // The board's time may run faster than that of the client, who says now and then that it is there.
        let settings = bench.settings();
        bench.done(Command::SetSettings(breakaway_core::link::Settings { command_timeout_ms: 20_000, ..settings }));
        bench
    })
    .unwrap();
    let info = breakaway(&["device", "--port", &board.port, "info"]);
    assert_eq!(info["board"], "nucleo-g474re", "{info}");
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().display().to_string();
    let mut recordings = Vec::new();
    for (name, h1, h2) in [("high", 2.0, 1.5), ("low", 1.0, 0.7)] {
        let file = folder.path().join(format!("{name}.toml"));
        let text =
            format!("name = \"{name}\"\nduration_s = 7.0\n[excitation]\nkind = \"relay\"\nh1 = {h1}\nh2 = {h2}\n");
        std::fs::write(&file, text).unwrap();
        let done = breakaway(&["run", &file.display().to_string(), "--port", &board.port, "-o", &session]);
        recordings.push(done["recordings"][0]["file"].as_str().unwrap().to_owned());
    }
    let found = breakaway(&["identify", &recordings[0], &recordings[1]]);
    let truth = papers_plant().base;
    for (name, truth) in [("b", truth.b), ("c", truth.c), ("f1", truth.f1)] {
        let value = found[name]["value"].as_f64().unwrap();
        println!("{name}: {:+.3} %", 100.0 * (value / truth - 1.0));
        assert!((value / truth - 1.0).abs() < 0.01, "{name} = {value}, not {truth}");
    }
}
