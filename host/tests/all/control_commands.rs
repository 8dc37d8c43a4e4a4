//! `tune` and `track` from outside: exit codes, JSON documents, files.

use std::fs;

use crate::support::{breakaway, json, keys, text};
use breakaway::control::design::{Design, Request};
use breakaway::model::Model;
use proptest::prelude::*;

const BASE: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";
const COGGING: &str = "[[effect]]\nname = \"cogging\"\nA = 0.2\nn = 7.0\nphi = 0.5\n";
const STICTION: &str = "[[effect]]\nname = \"stiction\"\ns = 0.05\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("base.toml"), BASE).unwrap();
    fs::write(folder.path().join("cogging.toml"), format!("{BASE}{COGGING}{STICTION}")).unwrap();
    folder
}

#[test]
fn tune_reports_gains_margins_and_what_it_leaves_out() {
    let folder = folder();
    let document = json(folder.path(), &["tune", "cogging.toml", "--bandwidth", "8", "-o", "c.toml"]);
    assert_eq!(
        keys(&document),
        [
            "adaptive",
            "bandwidth_hz",
            "compensator",
            "count",
            "delay_ticks",
            "gains",
            "largest_bandwidth_hz",
            "margins",
            "schema_version",
            "tick_s",
            "units"
        ]
    );
    // The filter of ė moves the crossover by up to 7 %.
    assert!((document["bandwidth_hz"].as_f64().unwrap() / 8.0 - 1.0).abs() < 0.07);
    let count = |key: &str| document["count"][key].as_f64().unwrap();
    assert!(count("drive") < count("largest") && count("bandwidth_hz") > 8.0, "{document}");
    assert!(document["margins"]["phase_deg"].as_f64().unwrap() > 45.0);
    assert_eq!(document["compensator"]["on"], false);
    assert_eq!(document["compensator"]["leaves_out"], serde_json::json!(["stiction"]));
    let design = Design::read(&folder.path().join("c.toml")).unwrap();
    assert_eq!(design.gains.kv, document["gains"]["kv"].as_f64().unwrap());
    let people = breakaway(folder.path(), &["tune", "cogging.toml"]);
    assert!(text(&people.stdout).contains("note: stiction cannot be compensated"));
    // Too coarse an encoder for what is asked for: it is said, with what would do.
    let coarse = ["tune", "base.toml", "--bandwidth", "20", "--encoder-step", "0.02"];
    let people = breakaway(folder.path(), &coarse);
    let most = text(&people.stdout).split("at most --bandwidth ").nth(1).unwrap().lines().next().unwrap();
    let within = ["tune", "base.toml", "--bandwidth", most, "--encoder-step", "0.02"];
    assert!(!text(&breakaway(folder.path(), &within).stdout).contains("too much"), "{most}");
}

#[test]
fn past_the_limit_the_largest_is_named() {
    let folder = folder();
    let run = breakaway(folder.path(), &["tune", "base.toml", "--bandwidth", "300", "-o", "c.toml"]);
    assert_eq!(run.status.code(), Some(1));
    let message = text(&run.stderr);
    let largest: f64 = message.split("for this model is ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(!folder.path().join("c.toml").exists());
    // The number it names is rounded: a last digit below it passes.
    let allowed = format!("{}", largest - 1e-3);
    assert_eq!(breakaway(folder.path(), &["tune", "base.toml", "--bandwidth", &allowed]).status.code(), Some(0));
    assert_eq!(breakaway(folder.path(), &["tune", "base.toml", "--tick", "-1"]).status.code(), Some(2));
    assert_eq!(breakaway(folder.path(), &["tune", "none.toml"]).status.code(), Some(1));
}

/// On the model itself compensation divides the error: the base model by what cogging leaves, the whole model by far more.
#[test]
fn track_shows_what_compensation_gains() {
    let folder = folder();
    let arguments =
        ["track", "--model", "cogging.toml", "--reference", "sine:1,0.25", "--report", "r.html", "-o", "runs"];
    let document = json(folder.path(), &arguments);
    assert_eq!(
        keys(&document),
        ["duration_s", "improvement", "plant", "reference", "runs", "schema_version", "settle_s", "tick_s", "units"]
    );
    let rms = |name: &str| {
        let runs = document["runs"].as_array().unwrap();
        runs.iter().find(|run| run["name"] == name).unwrap()["rms"].as_f64().unwrap()
    };
    assert!(rms("base") < rms("pid") && rms("model") < 0.5 * rms("base"), "{document}");
    assert!((document["improvement"].as_f64().unwrap() - rms("pid") / rms("model")).abs() < 1e-9);
    for file in ["pid.csv", "base.csv", "model.csv", "adaptive.csv", "error.svg"] {
        assert!(folder.path().join("runs").join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("Compensation brings the tracking error") && page.contains("the model itself"));
    // A recording of the run is a recording.
    let fitted = breakaway(folder.path(), &["identify", "runs/model.csv"]);
    assert_eq!(fitted.status.code(), Some(0), "{}", text(&fitted.stderr));
}

#[test]
fn track_takes_controller_plant_and_references() {
    let folder = folder();
    json(folder.path(), &["tune", "base.toml", "-o", "c.toml", "--drive-limit", "12"]);
    for reference in ["trapezoid:2,2,20", "s_curve:2,2,20,400,0.2"] {
        let document = json(
            folder.path(),
            &[
                "track",
                "--model",
                "base.toml",
                "--controller",
                "c.toml",
                "--plant",
                "cogging.toml",
                "--reference",
                reference,
            ],
        );
        assert_eq!(document["plant"], "cogging.toml");
        assert!(document["improvement"].as_f64().unwrap() > 1.0, "{document}");
    }
    let samples = (0..400).fold(String::from("t,x\n"), |text, k| {
        text + &format!("{},{}\n", 0.01 * f64::from(k), (0.02 * f64::from(k)).sin())
    });
    fs::write(folder.path().join("path.csv"), samples).unwrap();
    let document = json(folder.path(), &["track", "--model", "base.toml", "--reference", "path.csv"]);
    assert!(document["improvement"].as_f64().unwrap() > 2.0, "{document}");
    for wrong in ["sine:1", "square:1,2", "sine:1,x", "sine:1,-3", "none.csv", "trapezoid:1,0,1"] {
        let run = breakaway(folder.path(), &["track", "--model", "base.toml", "--reference", wrong]);
        assert_eq!(run.status.code(), Some(1), "{wrong}");
        assert!(text(&run.stderr).contains("--reference"), "{}", text(&run.stderr));
    }
}

#[test]
fn a_wrong_controller_file_is_refused_with_its_place() {
    let folder = folder();
    json(folder.path(), &["tune", "base.toml", "-o", "c.toml"]);
    let good = fs::read_to_string(folder.path().join("c.toml")).unwrap();
    for (from, to, words) in [
        ("law = \"pid\"", "law = \"pdi\"", "pdi"),
        ("kv = ", "vk = ", "vk"),
        ("f1 = 0.5  # V", "f1 = -0.5", "f1"),
        ("tick_s = 0.001", "tick_s = 0.01", "kv + lambda2"),
    ] {
        assert!(good.contains(from), "{from}");
        fs::write(folder.path().join("bad.toml"), good.replacen(from, to, 1)).unwrap();
        let run = breakaway(folder.path(), &["track", "--model", "base.toml", "--controller", "bad.toml"]);
        assert_eq!(run.status.code(), Some(1));
        let message = text(&run.stderr);
        assert!(message.contains("bad.toml") && message.contains(words), "{message}");
    }
}

proptest! {
    /// What is written is what is read, bit for bit.
    #[test]
    fn a_controller_file_keeps_every_bit(b in 1e-4..1.0_f64, ratio in 0.1..100.0_f64, f1 in 0.0..2.0_f64, tick in 1e-4..2e-3_f64, delay in 0..3_u32) {
        let mut model = Model::parse("m", BASE).unwrap();
        (model.base.b, model.base.c, model.base.f1) = (b, b * ratio, f1);
        let request = Request {
            tick_s: tick, delay_ticks: delay, bandwidth_hz: None, drive_limit: 12.0, encoder_step: 1e-3,
            speed: Some(5.0), acceleration: Some(50.0), adaptation_rate: 2.0,
        };
        let design = Design::new(&model, &request).unwrap();
        let mut again = Design::parse("again", &design.to_toml()).unwrap();
        // The comments at the head of the model are not part of the controller.
        again.model.provenance.clone_from(&design.model.provenance);
        prop_assert_eq!(again, design);
    }
}
