//! `discover --fleet` from outside: one row per machine whatever happens, nothing done twice, nothing half written.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use breakaway::recording::Units;
use breakaway::simulate::axis::Axis;
use breakaway::simulate::experiment::{Excitation, Experiment, Reference, Sensor};
use breakaway_core::plant::{Base, Effect, Kind};
use serde_json::Value;

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_breakaway"));
    command.current_dir(folder).args(["discover", "--fleet", "machines", "-o", "out", "--json"]).args(arguments);
    command
}

fn fleet(folder: &Path, arguments: &[&str]) -> (Output, Value) {
    let output = command(folder, arguments).output().unwrap();
    let document = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output, document)
}

/// Two relay limit cycles of 3 s at 4 ms on the papers' plant under a load, noise-free but for the encoder. They are
/// the smallest recordings that settle base and load (a few seconds to discover).
fn machine(folder: &Path, name: &str, load: f64) {
    let base = Base::new(0.02685, 0.11, 0.5).unwrap();
    let kind = *Kind::ALL.iter().find(|kind| kind.name() == "constant_load").unwrap();
    let effects = if load == 0.0 { vec![] } else { vec![Effect::new(kind, &[load])] };
    let mut axis = Axis::new(base, &effects, Units { u: "V".into(), x: "rad".into() });
    let fit = folder.join("machines").join(name).join("fit");
    fs::create_dir_all(&fit).unwrap();
    for (name, h1, h2) in [("high", 2.0, 1.5), ("low", 1.0, 0.9)] {
        let experiment = Experiment {
            name: name.into(),
            tick_s: 4e-3,
            duration_s: 3.0,
            seed: 1,
            drive_limit: f64::INFINITY,
            travel_limit: f64::INFINITY,
            excitation: Excitation::Relay { h1, h2, hysteresis: None, reference: Reference::Start },
            sensor: Sensor { encoder_step: 1e-3, noise: 0.0, delay_ticks: 0 },
        };
        axis.run(&experiment).unwrap().recording.write(&fit.join(format!("{name}.csv"))).unwrap();
    }
}

fn row<'a>(document: &'a Value, machine: &str) -> &'a Value {
    let rows = document["machines"].as_array().unwrap();
    rows.iter().find(|row| row["machine"] == machine).unwrap_or_else(|| panic!("no row for {machine}"))
}

fn counts(document: &Value) -> [u64; 3] {
    ["done", "skipped", "failed"].map(|key| document[key].as_u64().unwrap())
}

#[test]
fn a_broken_machine_is_a_row_and_only_what_changed_is_done_again() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    machine(place, "free", 0.0);
    machine(place, "loaded", 0.3);
    fs::create_dir_all(place.join("machines/broken")).unwrap();
    fs::write(place.join("machines/broken/a.csv"), "t,u,x\n0,1,nonsense\n").unwrap();
    fs::create_dir_all(place.join("machines/empty")).unwrap();
    let (output, first) = fleet(place, &["--workers", "2"]);
    assert_eq!((output.status.code(), counts(&first)), (Some(1), [2, 0, 2]), "{first}");
    assert_eq!(row(&first, "free")["effects"], serde_json::json!([]));
    let loaded = row(&first, "loaded");
    assert_eq!(loaded["effects"], serde_json::json!(["constant_load"]));
    // Without the load the simulation drifts off within the second; what remains is the encoder's step.
    assert!(loaded["shrink"].as_f64().unwrap() > 10.0 && loaded["noise_factor"].as_f64().unwrap() < 1.5, "{loaded}");
    for (machine, words) in [("broken", "a.csv:2: column `x`"), ("empty", "no recordings")] {
        let reason = row(&first, machine)["reason"].as_str().unwrap();
        assert!(reason.contains(words), "{reason}");
    }
    // The result is the contract's document, and the model is one that can be read.
    let result: Value = serde_json::from_slice(&fs::read(place.join("out/loaded/result.json")).unwrap()).unwrap();
    assert_eq!(result["verdict"], loaded["verdict"]);
    let model = breakaway::model::Model::read(&place.join("out/loaded/improved.toml")).unwrap();
    assert!((model.effects[0].parameters["f0"] / 0.3 - 1.0).abs() < 0.05, "{model:?}");
    let page = fs::read_to_string(place.join("out/summary.html")).unwrap();
    assert!(page.contains("href=\"loaded/report.html\"") && !page.contains("href=\"broken"));
    let csv = fs::read_to_string(place.join("out/summary.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5, "{csv}");

    // Again: both are skipped, and their rows say the same.
    let (_, again) = fleet(place, &[]);
    assert_eq!(counts(&again), [0, 2, 2]);
    assert_eq!(row(&again, "loaded")["shrink"], loaded["shrink"]);
    assert_eq!(fs::read_to_string(place.join("out/summary.csv")).unwrap(), csv);

    // A changed input is seen by its content; one that has become unreadable leaves no old result behind.
    machine(place, "free", 0.2);
    fs::write(place.join("machines/loaded/fit/low.csv"), "t,u,x\n").unwrap();
    let (_, changed) = fleet(place, &[]);
    assert_eq!(counts(&changed), [1, 0, 3], "{changed}");
    assert_eq!(row(&changed, "free")["effects"], serde_json::json!(["constant_load"]));
    assert_eq!(fs::read_dir(place.join("out/loaded")).unwrap().count(), 0);

    // Other options are another question, and --again asks the same one again.
    assert_eq!(counts(&fleet(place, &["--encoder-step", "0.001"]).1), [1, 0, 3]);
    assert_eq!(counts(&fleet(place, &["--encoder-step", "0.001", "--again"]).1), [1, 0, 3]);
}

#[test]
fn a_fleet_without_a_result_fails_and_wrong_folders_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::create_dir_all(place.join("machines")).unwrap();
    let (output, _) = fleet(place, &[]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && message.contains("holds no machine"), "{message}");
    fs::create_dir_all(place.join("machines/only")).unwrap();
    let (output, document) = fleet(place, &[]);
    assert_eq!((output.status.code(), counts(&document)), (Some(1), [0, 0, 1]));
    for (arguments, words) in [
        (&["--fleet", "machines", "-o", "machines/out"][..], "would be taken for a machine"),
        (&["--fleet", "machines", "-o", "machines"], "would be taken for a machine"),
        (&["--fleet", "machines"], "--output"),
        (&["a.csv", "--fleet", "machines", "-o", "out"], "cannot be used with"),
        (&["a.csv", "--workers", "2"], "--fleet"),
    ] {
        let run = Command::new(env!("CARGO_BIN_EXE_breakaway"));
        let output = { run }.current_dir(place).arg("discover").args(arguments).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && message.contains(words), "{arguments:?}: {message}");
    }
}

/// Every file under a folder.
fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// Ctrl-C while the second of three machines is worked on. All files are whole, none is half written, and the next
/// run goes on from there.
#[cfg(unix)]
#[test]
fn what_is_cut_off_is_whole_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    for (name, load) in [("a", 0.1), ("b", 0.2), ("c", 0.3)] {
        machine(place, name, load);
    }
    let mut child = command(place, &["--workers", "1"]).stdout(Stdio::null()).spawn().unwrap();
    while !place.join("out/a/result.json").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it ended before it had a result");
        sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    for file in files(&place.join("out")) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        assert!(!name.starts_with('.'), "{} is left behind", file.display());
        let text = fs::read_to_string(&file).unwrap();
        let whole = match file.extension().and_then(|ext| ext.to_str()) {
            Some("json") => serde_json::from_str::<Value>(&text).is_ok(),
            Some("html") => text.ends_with("</html>\n"),
            Some("toml") => breakaway::model::Model::parse("improved.toml", &text).is_ok(),
            _ => text.lines().count() == 4,
        };
        assert!(whole, "{} is cut off", file.display());
    }
    let csv = fs::read_to_string(place.join("out/summary.csv")).unwrap();
    assert!(csv.contains("not worked on yet"), "{csv}");
    let (_, document) = fleet(place, &["--workers", "1"]);
    assert_eq!(document["failed"], 0, "{document}");
    assert_eq!(row(&document, "a")["skipped"], true);
    assert_eq!(row(&document, "c")["skipped"], false);
}
