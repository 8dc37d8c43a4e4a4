//! `run`, `simulate`, `identify` and `effects` from outside: exit codes, the JSON documents of docs/formats.md, section "JSON results", the files they leave.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::support::{breakaway, json, keys, text};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

const RELAY: &str = "kind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n";

/// An experiment file on a tick of 1 ms.
fn experiment(folder: &Path, name: &str, duration_s: f64, head: &str, excitation: &str, sensor: &str) -> String {
    let file = format!("{name}.toml");
    let text =
        format!("name = \"{name}\"\nduration_s = {duration_s:?}\n{head}[excitation]\n{excitation}[sensor]\n{sensor}");
    fs::write(folder.join(&file), text).unwrap();
    file
}

/// The papers' plant at a tick of 0.1 ms with 1e-4 rad per count. The relay then switches half a tick and one and a
/// half counts late. That moves T by less than 0.5 % of the exact cycle's 0.723195 s (docs/theory.md, section 2).
#[test]
fn a_settled_relay_run_reports_the_limit_cycle() {
    let folder = tempfile::tempdir().unwrap();
    let file = experiment(folder.path(), "relay", 15.0, "tick_s = 1e-4\n", RELAY, "encoder_step = 1e-4\n");
    let document = json(folder.path(), &["run", &file, "-o", "out"]);
    assert_eq!(keys(&document), ["breakaway", "recordings", "schema_version"]);
    assert_eq!(keys(&document["recordings"][0]), ["ending", "file", "role", "samples"]);
    let ending = &document["recordings"][0]["ending"];
    assert_eq!(keys(ending), ["amplitude", "bias", "cycles", "kind", "mean_drive", "omega", "period_s", "tolerance"]);
    assert_eq!(ending["kind"], "settled");
    assert!((number(&ending["period_s"]) / 0.723_195 - 1.0).abs() < 5e-3, "{ending}");
    assert!((number(&ending["omega"]) * number(&ending["period_s"]) / std::f64::consts::TAU - 1.0).abs() < 1e-12);
    // √2 times the rms is the fundamental's 1.27742 to 0.1 %; a lengthens as T² (2 · 0.5 %).
    assert!((number(&ending["amplitude"]) / 1.277_42 - 1.0).abs() < 1e-2, "{ending}");
    assert!(number(&ending["bias"]).abs() < 0.01 && number(&ending["tolerance"]) <= 0.05);
    assert!(folder.path().join("out/relay.csv").is_file());
    let people = breakaway(folder.path(), &["run", &file, "-o", "out"]);
    assert!(text(&people.stdout).contains("settled: T = 0.7"), "{}", text(&people.stdout));
}

/// Each ending of docs/theory.md, section 2; (1, 0.49) on f1 = 0.5 is acceptance row 14.
#[test]
fn every_ending_is_reported_as_itself() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let loaded = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[[effect]]\nname = \"constant_load\"\nf0 = 0.3\n";
    fs::write(place.join("loaded.toml"), loaded).unwrap();
    let relay = |h1: f64, h2: f64| format!("kind = \"relay\"\nh1 = {h1:?}\nh2 = {h2:?}\n");
    let triangle = format!("{RELAY}reference = {{ shape = \"triangle\", amplitude = 1.0, period_s = 4.0 }}\n");
    let sine = "kind = \"sine\"\namplitude = 2.0\nfrequency_hz = 1.0\n";
    for (name, duration, head, excitation, model, kind, words) in [
        ("low", 8.0, "", relay(1.0, 0.49), "", "no_limit_cycle", "no limit cycle: h2 ≤ f1"),
        ("still", 8.0, "", relay(0.2, 0.1), "", "no_limit_cycle", "raise h2"),
        ("loaded_run", 12.0, "", relay(4.0, 1.5), "loaded.toml", "asymmetric", "asymmetric ("),
        ("short", 1.0, "", relay(2.0, 1.5), "", "timeout", "record for longer"),
        ("tripped", 8.0, "travel_limit = 0.5\n", relay(2.0, 1.5), "", "limit_tripped", "from the start"),
        ("sine", 8.0, "travel_limit = 0.1\n", sine.to_owned(), "", "limit_tripped", "limit tripped: 0.1"),
        ("moving", 6.0, "", triangle, "", "not_judged", "not judged: the reference moves"),
        ("brief", 0.01, "", relay(2.0, 1.5), "", "not_judged", "too short to judge"),
    ] {
        let file = experiment(place, name, duration, head, &excitation, "encoder_step = 1e-3\n");
        let mut arguments = vec!["run", file.as_str(), "-o", "out"];
        if !model.is_empty() {
            arguments.extend(["--model", model]);
        }
        let ending = &json(place, &arguments)["recordings"][0]["ending"];
        assert_eq!(ending["kind"], kind, "{name}: {ending}");
        let people = breakaway(place, &arguments);
        assert!(text(&people.stdout).contains(words), "{name}: {}", text(&people.stdout));
        if kind == "asymmetric" {
            // The mean drive carries the load.
            assert!((number(&ending["mean_drive"]) - 0.3).abs() < 0.03, "{ending}");
        }
    }
}

/// At 10 kHz noise turns the relay on the integral before the axis has moved by its hysteresis of three counts. The
/// drive is then h1 − h2 = 0.3 < f1, and nothing moves although h1 + h2 = 1.7 would do.
#[test]
fn a_relay_that_sticks_at_the_start_is_told_from_one_that_is_too_weak() {
    let folder = tempfile::tempdir().unwrap();
    let relay = "kind = \"relay\"\nh1 = 1.0\nh2 = 0.7\n";
    let file = experiment(folder.path(), "stuck", 2.0, "tick_s = 1e-4\n", relay, "encoder_step = 1e-3\nnoise = 5e-4\n");
    let ending = &json(folder.path(), &["run", &file, "-o", "out"])["recordings"][0]["ending"];
    assert_eq!(ending["kind"], "no_limit_cycle");
    assert!(ending["reason"].as_str().unwrap().contains("Make |h1 − h2| larger"), "{ending}");
}

#[test]
fn the_suite_judges_its_relays_and_sorts_its_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let document = json(folder.path(), &["run", "suite", "-o", "s"]);
    // f1 = 0.5; read back from a ramp's motion it is 0.502 ± 0.009 over 30 seeds of an independent simulation.
    assert!((number(&document["breakaway"]) - 0.5).abs() < 0.03, "{}", document["breakaway"]);
    let recordings = document["recordings"].as_array().unwrap();
    assert_eq!(recordings.len(), 8);
    for entry in recordings {
        let (file, role) = (entry["file"].as_str().unwrap(), entry["role"].as_str().unwrap());
        assert!(folder.path().join(file).is_file() && file.starts_with(&format!("s/{role}/")), "{file}");
        let wanted = match Path::new(file).file_stem().unwrap().to_str().unwrap() {
            "relay_travel" => "not_judged".into(),
            name if name.starts_with("relay") => "settled".into(),
            _ => Value::Null,
        };
        assert_eq!(entry["ending"].get("kind").cloned().unwrap_or_default(), wanted, "{file}: {}", entry["ending"]);
    }
}

const NOISY: &str = "encoder_step = 1e-3\nnoise = 1e-3\n";

/// Recordings of the papers' plant by `simulate`, 20 s each: two relays of different h2, and one with the first's.
fn relays(folder: &Path) {
    fs::write(folder.join("m.toml"), "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n")
        .unwrap();
    for (name, h1, h2) in [("a", 2.0, 1.5), ("b", 1.0, 0.7), ("same", 3.0, 1.5)] {
        let file = experiment(folder, name, 20.0, "", &format!("kind = \"relay\"\nh1 = {h1:?}\nh2 = {h2:?}\n"), NOISY);
        let output = format!("{name}.csv");
        let document = json(folder, &["simulate", "--model", "m.toml", "--experiment", &file, "-o", &output]);
        assert_eq!(keys(&document), ["recording", "samples", "schema_version", "travel_limit_tripped"]);
        assert_eq!(document["samples"], 20_000);
    }
}

/// q = σ = 1e-3, h = (2, 1.5), (1, 0.7): docs/theory.md, section 4 and acceptance row 10 for `modulating`. The
/// describing function's bias is 5–20 % there; the best estimate is held to 0.2 % (its table: 0.00/0.04/0.07 %).
#[test]
fn identify_prints_the_document_of_the_contract_and_writes_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    relays(place);
    let document = json(place, &["identify", "a.csv", "b.csv", "-o", "found.toml"]);
    for key in ["b", "c", "f1", "load", "undetermined", "noise", "estimator", "estimators", "chosen_because", "remarks"]
    {
        assert!(document.get(key).is_some(), "{key}");
    }
    let truth = [("b", 0.02685, "V·s²/rad"), ("c", 0.11, "V·s/rad"), ("f1", 0.5, "V")];
    for (key, truth, unit) in truth {
        assert_eq!(keys(&document[key]), ["se", "unit", "value"]);
        assert_eq!(document[key]["unit"], unit);
        assert!((number(&document[key]["value"]) / truth - 1.0).abs() < 2e-3, "{key}: {}", document[key]);
    }
    assert_eq!(document["load"], Value::Null);
    assert_eq!(document["undetermined"], Value::Array(Vec::new()));
    let row = |name: &str| {
        let rows = document["estimators"].as_array().unwrap();
        rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("no row {name}"))
    };
    for (name, limits) in [("modulating", [0.01, 0.005, 0.01]), ("describing_function", [0.05, 0.2, 0.2])] {
        for ((key, truth, _), limit) in truth.into_iter().zip(limits) {
            let value = &row(name)[key];
            assert!((number(&value["value"]) / truth - 1.0).abs() < limit, "{name} {key}: {value}");
            assert!(number(&value["se"]) > 0.0);
        }
    }
    let model = breakaway::model::Model::read(&place.join("found.toml")).unwrap();
    assert_eq!(model.base.b, number(&document["b"]["value"]));
    let people = breakaway(place, &["identify", "a.csv", "b.csv"]);
    assert!(text(&people.stdout).contains("\n  modulating          b 2.68"), "{}", text(&people.stdout));
}

/// The recording with the current of a winding of 2 Ω and 50 mV·s/rad beside it, in mA, as the drive and the position have it.
fn with_current(folder: &Path, name: &str) {
    let file = folder.join(format!("{name}.csv"));
    let recording =
        breakaway::recording::Recording::read(&file, &breakaway::recording::ReadOptions::default()).unwrap();
    let mut text = "t,u_V,x_rad,motor_mA\n".to_owned();
    for k in 1..recording.t.len() - 1 {
        let way = recording.x[k + 1] - recording.x[k - 1];
        let v = way / (recording.t[k + 1] - recording.t[k - 1]);
        let current = 1000.0 * (recording.u[k] - 0.05 * v) / 2.0;
        writeln!(text, "{},{},{},{current}", recording.t[k], recording.u[k], recording.x[k]).unwrap();
    }
    fs::write(folder.join(format!("{name}i.csv")), text).unwrap();
}

/// R and Ke to 1 %: their noise is that of v from two positions. c less Ke is what is told as friction, with both errors.
#[test]
fn identify_parts_the_damping_where_a_current_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    relays(place);
    with_current(place, "a");
    with_current(place, "b");
    let columns = ["--input", "u_V", "--position", "x_rad"];
    let run = |more: &[&str]| json(place, &[&["identify", "ai.csv", "bi.csv"], &columns[..], more].concat());
    let document = run(&["--current", "motor_mA"]);
    let winding = &document["winding"];
    assert_eq!(keys(winding), ["back_emf", "inductance", "resistance", "viscous"]);
    for (key, truth, unit) in [("resistance", 2.0, "Ω"), ("back_emf", 0.05, "V·s/rad")] {
        assert_eq!(winding[key]["unit"], unit);
        assert!((number(&winding[key]["value"]) / truth - 1.0).abs() < 0.01, "{key}: {winding}");
    }
    let [c, emf, viscous] = [&document["c"], &winding["back_emf"], &winding["viscous"]];
    assert!((number(&c["value"]) - number(&emf["value"]) - number(&viscous["value"])).abs() < 1e-12);
    assert!((number(&c["se"]).hypot(number(&emf["se"])) - number(&viscous["se"])).abs() < 1e-12);
    let first = |document: &Value| document["remarks"][0]["text"].as_str().unwrap().to_owned();
    assert!(first(&document).starts_with("c is the back-EMF "), "{}", first(&document));
    // Nobody says which column, or there is none.
    let document = run(&[]);
    assert_eq!(document["winding"], Value::Null);
    assert!(first(&document).starts_with("c is back-EMF and viscous friction together"), "{}", first(&document));
    // From a name plate, c is parted all the same; the winding is not told.
    let document = run(&["--back-emf", "0.05"]);
    assert_eq!(document["winding"], Value::Null);
    assert!(first(&document).starts_with("c is the back-EMF 5.0000e-2 ± 0.0e0"), "{}", first(&document));
    let people = breakaway(place, &["identify", "ai.csv", "--input", "u_V", "--position", "x_rad", "--current", "i"]);
    assert!(text(&people.stderr).contains("no column `i`; name it with --current"), "{}", text(&people.stderr));
}

/// A refusal of the describing function names the experiment that would help; the other estimates stand.
#[test]
fn relay_recordings_that_cannot_separate_c_and_f1_say_so() {
    let folder = tempfile::tempdir().unwrap();
    relays(folder.path());
    for (recordings, wanted) in [
        (&["a.csv"][..], "a single relay recording ends in a settled limit cycle: c and f1 cannot be separated by it"),
        (&["a.csv", "same.csv"], "all experiments use the same h2: c and f1 cannot be separated"),
    ] {
        let document = json(folder.path(), &[&["identify"], recordings].concat());
        let remarks = document["remarks"].as_array().unwrap();
        assert!(remarks.iter().any(|remark| remark["text"].as_str().unwrap().contains(wanted)), "{remarks:?}");
        let rows = document["estimators"].as_array().unwrap();
        assert!(rows.iter().all(|row| row["name"] != "describing_function"));
        assert!((number(&document["f1"]["value"]) / 0.5 - 1.0).abs() < 5e-3, "{}", document["f1"]);
    }
}

/// Nothing is written, standard output stays empty, and the reason names the field.
#[test]
fn experiments_out_of_range_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let relay = |h1: &str, h2: &str| format!("kind = \"relay\"\nh1 = {h1}\nh2 = {h2}\n");
    let sine = |a: &str, f: &str| format!("kind = \"sine\"\namplitude = {a}\nfrequency_hz = {f}\n");
    let multi =
        |from: &str, to: &str| format!("kind = \"multisine\"\namplitude = 1.0\nfrom_hz = {from}\nto_hz = {to}\n");
    for (duration, excitation, wanted) in [
        (0.0, relay("2.0", "1.5"), "duration_s = 0 is out of range: it must be > 0"),
        (-1.0, relay("2.0", "1.5"), "duration_s = -1"),
        (f64::INFINITY, relay("2.0", "1.5"), "duration_s = inf"),
        (1e9, relay("2.0", "1.5"), "8 to 1e8 samples"),
        (0.002, relay("2.0", "1.5"), "8 to 1e8 samples"),
        (1.0, relay("0.0", "1.5"), "excitation.h1 = 0"),
        (1.0, relay("2.0", "-1.5"), "excitation.h2 = -1.5"),
        (1.0, relay("nan", "1.5"), "excitation.h1 = NaN"),
        (1.0, relay("1e999", "1.5"), "not an experiment"),
        (1.0, sine("0.0", "1.0"), "excitation.amplitude = 0"),
        (1.0, sine("1.0", "0.0"), "excitation.frequency_hz = 0"),
        (1.0, sine("1.0", "500.0"), "below half the sample rate"),
        (1.0, multi("1.0", "500.0"), "below half the sample rate"),
        (1.0, multi("4.0", "2.0"), "above from_hz"),
        (1.0, multi("1e-300", "2.0"), "1e-4 to 0.9999 of to_hz"),
        (1.0, "kind = \"relais\"\n".to_owned(), "unknown variant `relais`"),
        (1.0, "kind = \"relay\"\nh1 = 2.0\n".to_owned(), "missing field `h2`"),
    ] {
        let file = experiment(place, "bad", duration, "", &excitation, "");
        for arguments in [
            &["run", &file, "-o", "out"][..],
            &["simulate", "--model", "m.toml", "--experiment", &file, "-o", "out.csv"],
        ] {
            fs::write(place.join("m.toml"), "[base]\nb = 1\nc = 1\nf1 = 0.1\n").unwrap();
            let run = breakaway(place, arguments);
            assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), ""), "{arguments:?} {excitation}");
            assert!(text(&run.stderr).contains(wanted), "{wanted}: {}", text(&run.stderr));
            assert!(!place.join("out").exists() && !place.join("out.csv").exists());
        }
    }
}

#[test]
fn files_that_are_missing_or_cannot_be_written_are_errors_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let file = experiment(place, "e", 1.0, "", RELAY, "");
    fs::write(place.join("m.toml"), "[base]\nb = 1\nc = 1\nf1 = 0.1\n").unwrap();
    fs::write(place.join("far.toml"), "[base]\nb = 1\nc = 1\nf1 = 0.1\n[[effect]]\nname = \"stribek\"\n").unwrap();
    for (arguments, wanted) in [
        (&["run", "none.toml", "-o", "out"][..], "none.toml: no such file; EXPERIMENT is a TOML file"),
        (&["run", &file, "--model", "none.toml", "-o", "out"], "none.toml: no such file"),
        (
            &["run", &file, "--model", "far.toml", "-o", "out"],
            "far.toml:6: unknown effect `stribek`; did you mean `stribeck`?",
        ),
        (&["run", &file, "-o", "m.toml"], "cannot make the folder m.toml"),
        (&["simulate", "--model", "m.toml", "--experiment", &file, "-o", "no/such.csv"], "cannot be written"),
    ] {
        let run = breakaway(place, arguments);
        assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), ""), "{arguments:?}");
        assert!(text(&run.stderr).contains(wanted), "{}", text(&run.stderr));
    }
    assert_eq!(fs::read_dir(place).unwrap().count(), 3);
    for arguments in
        [&["run"][..], &["simulate", "-o", "a.csv"], &["identify"], &["run", "suite", "-o", "s", "--tick", "0"]]
    {
        assert_eq!(breakaway(place, arguments).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn the_catalogue_is_printed_whole_or_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let all = json(folder.path(), &["effects"]);
    let effects = all["effects"].as_array().unwrap();
    assert_eq!(effects.len(), breakaway_core::plant::Kind::ALL.len());
    let one = json(folder.path(), &["effects", "stribeck"]);
    let own = ["acts_in", "compensation", "law", "name", "parameters", "shown_by", "title"];
    let beside_others = ["confused_with", "excludes", "generalises", "repeats", "residue"];
    let asks = ["needs_angle", "phase_per_recording", "shared_clock"];
    let mut expected = [&own[..], &beside_others, &asks].concat();
    expected.sort_unstable();
    assert_eq!(keys(&one["effects"][0]), expected);
    assert!(effects.contains(&one["effects"][0]));
    let parameter = &one["effects"][0]["parameters"][2];
    assert_eq!(keys(parameter), ["default", "max", "meaning", "min", "role", "symbol", "unit"]);
    assert_eq!((parameter["symbol"].as_str(), number(&parameter["default"])), (Some("p"), 2.0));
    let people = breakaway(folder.path(), &["effects", "stribeck"]);
    let excludes = "lugre (LuGre friction contains the Stribeck curve)";
    for words in ["Stribeck", "confused with", excludes, "compensation", "0.5 to 4 (if left out: 2)"] {
        assert!(text(&people.stdout).contains(words), "{words}: {}", text(&people.stdout));
    }
    let wrong = breakaway(folder.path(), &["effects", "stribek"]);
    assert_eq!((wrong.status.code(), text(&wrong.stdout)), (Some(2), ""));
    assert!(text(&wrong.stderr).contains("no effect `stribek`; did you mean `stribeck`?"), "{}", text(&wrong.stderr));
}
