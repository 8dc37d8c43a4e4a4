//! `breakaway export` and `breakaway models` from outside.

use std::fs;

use crate::support::{breakaway, json, keys, text};

const MODEL: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n\
    [[effect]]\nname = \"stiction\"\ns = 0.1\n[[effect]]\nname = \"load_friction\"\nk = 0.1\n";
const RELAY: &str = "name = \"relay\"\nduration_s = 12.0\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n[sensor]\nencoder_step = 1e-3\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("axis.toml"), MODEL).unwrap();
    folder
}

/// C needs no constants. Without `-o` the file is on standard output; with `--json` it is in the document.
#[test]
fn c_needs_nothing() {
    let folder = folder();
    let run = breakaway(folder.path(), &["export", "axis.toml", "--to", "c"]);
    assert!(text(&run.stdout).starts_with("/* exported by breakaway "), "{}", text(&run.stdout));
    assert!(text(&run.stderr).contains("LOST         stiction"), "{}", text(&run.stderr));
    let document = json(folder.path(), &["export", "axis.toml", "--to", "c"]);
    assert_eq!(
        keys(&document),
        ["lost", "output", "parts", "remarks", "schema_version", "si", "target", "text", "version"]
    );
    assert_eq!(document["lost"], serde_json::json!(["stiction"]));
    assert_eq!(document["parts"][4]["fate"], "kept");
    assert!(document["si"].is_null() && document["text"].as_str().unwrap().contains("axis_feed_forward"));
}

/// A target in SI is refused with the options that are missing; with them it has both sides of the gear.
#[test]
fn si_needs_the_motor() {
    let folder = folder();
    let line = ["export", "axis.toml", "--to", "mjcf", "-o", "axis.xml"];
    let refused = breakaway(folder.path(), &line);
    assert_eq!(refused.status.code(), Some(1));
    let said = text(&refused.stderr);
    assert!(said.contains("--motor-constant and --resistance") && said.contains("--drive-gain"), "{said}");
    assert!(!folder.path().join("axis.xml").exists());
    let with = [&line[..], &["--motor-constant", "0.02", "--resistance", "2", "--gear", "5"]].concat();
    let document = json(folder.path(), &with);
    assert_eq!(document["lost"], serde_json::json!(["load_friction"]));
    let [load, motor] = ["load", "motor"].map(|side| document["si"][side]["inertia"].as_f64().unwrap());
    // 0.05 N·m/V at the load, and 25 times less behind the gear.
    assert!((load / 0.0013425 - 1.0).abs() < 1e-9 && (load / motor - 25.0).abs() < 1e-9);
    let bad = breakaway(folder.path(), &["export", "axis.toml", "--to", "mjfc"]);
    assert_eq!(bad.status.code(), Some(2));
}

/// What is there stays, unless breakaway exported it.
#[test]
fn an_export_replaces_only_exports() {
    let folder = folder();
    let place = folder.path();
    fs::write(place.join("mine.h"), "int mine;\n").unwrap();
    let line = |to: &str| breakaway(place, &["export", "axis.toml", "--to", "c", "-o", to]).status.code();
    assert_eq!(
        [line("mine.h"), line("axis.toml"), line("axis.h"), line("axis.h")],
        [Some(1), Some(1), Some(0), Some(0)]
    );
    assert_eq!(fs::read_to_string(place.join("mine.h")).unwrap(), "int mine;\n");
    let forced = breakaway(place, &["--force", "export", "axis.toml", "--to", "c", "-o", "mine.h"]);
    assert!(forced.status.success() && fs::read_to_string(place.join("mine.h")).unwrap().contains("exported by"));
}

/// The library lists its cards, shows one, and compares two. A name that is wrong is answered with the nearest.
#[test]
fn the_library_is_shown() {
    let folder = folder();
    let place = folder.path();
    let list = json(place, &["models", "list"]);
    let cards = list["cards"].as_array().unwrap();
    assert!(cards.len() >= 6 && cards.iter().any(|card| card["name"] == "emps"), "{list}");
    let shown = json(place, &["models", "show", "emps", "-o", "emps.toml"]);
    assert_eq!(shown["parameters"][0]["unit"], "V·s²/m");
    assert!(shown["data"]["file"][0]["sha256"].as_str().unwrap().len() == 64);
    // The card's model is a model, and its motor has the force per volt.
    let exported = json(place, &["export", "emps.toml", "--to", "urdf", "--motor", "emps"]);
    let inertia = exported["si"]["load"]["inertia"].as_f64().unwrap();
    // Published 95.1 kg; the card's b is 1.5 % below.
    assert!((inertia / 95.1089 - 1.0).abs() < 0.03, "{inertia}");
    let compared = json(place, &["models", "compare", "emps", "emps"]);
    assert!(compared["parameters"].as_array().unwrap().iter().all(|line| line["ratio"] == 1.0), "{compared}");
    let wrong = breakaway(place, &["models", "show", "emp"]);
    assert!(text(&wrong.stderr).contains("did you mean `emps`"), "{}", text(&wrong.stderr));
}

/// `add` makes a card that the other commands read, and refuses one that is worse than an axis that stands still.
#[test]
fn a_card_is_one_command() {
    let folder = folder();
    let place = folder.path();
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    json(place, &["run", "relay.toml", "--model", "axis.toml", "-o", "."]);
    json(place, &["identify", "relay.csv", "-o", "model.toml"]);
    let add = |model: &str, card: &str| {
        let line = ["models", "add", model, "relay.csv", "--name", "mine", "--machine", "simulated", "--source", "own"];
        breakaway(place, &[&line[..], &["--licence", "CC0-1.0", "--window", "0.5", "-o", card]].concat())
    };
    let made = add("model.toml", "mine.toml");
    assert!(made.status.success(), "{}", text(&made.stderr));
    let shown = json(place, &["models", "show", "mine.toml"]);
    assert_eq!(shown["card"]["name"], "mine");
    assert!(shown["held_out"]["rmse"].as_f64().unwrap() < shown["held_out"]["standstill_rmse"].as_f64().unwrap());
    // A thousandth of the inertia follows the drive far too fast.
    fs::write(place.join("wrong.toml"), MODEL.replace("b = 0.02685", "b = 2e-5").replace("c = 0.11", "c = 0.001"))
        .unwrap();
    let refused = add("wrong.toml", "wrong-card.toml");
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("stands still"), "{}", text(&refused.stderr));
    assert!(!place.join("wrong-card.toml").exists());
}
