//! `breakaway bode` from outside, on a simulated axis and on the flexible link.

use std::fs;

use serde_json::Value;

use super::measured::data;
use super::support::{breakaway, json, text};

const COLUMNS: [&str; 6] = ["--time", "t_s", "--input", "u_cmd", "--position", "x_counts"];

fn value(quantity: &Value) -> f64 {
    quantity["value"].as_f64().unwrap()
}

/// The link's modes are known from a fit of two bodies: 2.2 to 2.5 Hz and 3.5 Hz, with 2 to 4 ms of delay. Segments of 2 s
/// tell 0.5 Hz apart, so that a mode may be off by that, and a delay by a quarter of a sample.
#[test]
fn the_flexible_link_has_its_modes_and_its_delay() {
    let Some(data) = data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let files: Vec<String> =
        (1..=6).map(|k| data.join(format!("machines/flexlink/swept{k}_0_10hz.csv")).display().to_string()).collect();
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let found = json(folder.path(), &[&["bode"][..], &files, &COLUMNS].concat());
    let only = |name: &str| {
        let modes = found[name].as_array().unwrap();
        assert_eq!(modes.len(), 1, "{name}: {modes:?}");
        value(&modes[0]["frequency"])
    };
    let (low, high) = (only("antiresonances"), only("resonances"));
    assert!((1.7..3.0).contains(&low) && (3.0..4.0).contains(&high), "{low} and {high} Hz");
    let delay_s = value(&found["delay"]);
    assert!((0.002..0.0045).contains(&delay_s), "{delay_s} s");
    assert_eq!(found["gain_unit"], "counts/u");
    // Above both modes the sweep is coherent, up to its 10 Hz.
    let points = found["points"].as_array().unwrap();
    let coherent = |point: &Value| point["coherent"] == true;
    assert!(points.iter().filter(|point| (4.0..10.0).contains(&point["frequency_hz"].as_f64().unwrap())).all(coherent));
}

const MODEL: &str = "base = { b = 0.02685, c = 0.11, f1 = 0.01 }\nunits = { u = \"V\", x = \"rad\" }\n";
const MULTISINE: &str = "name = \"multisine\"\nduration_s = 20.0\n\
    excitation = { kind = \"multisine\", amplitude = 3.6, from_hz = 0.5, to_hz = 40.0, centring = 0.08 }\n";

/// Text, figure and document say the same, and a file that is no figure is kept.
#[test]
fn a_simulated_axis_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(place.join("model.toml"), MODEL).unwrap();
    fs::write(place.join("multisine.toml"), MULTISINE).unwrap();
    json(place, &["simulate", "--model", "model.toml", "--experiment", "multisine.toml", "-o", "rec.csv"]);
    let run = breakaway(place, &["bode", "rec.csv", "--figure", "bode.svg"]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let page = text(&run.stdout);
    assert!(page.contains("no resonance and no antiresonance"), "{page}");
    assert!(page.contains("gain, rad/V"), "{page}");
    let drawing = fs::read_to_string(place.join("bode.svg")).unwrap();
    for part in ["gain", "phase", "coherence", "Frequency response, rec"] {
        assert!(drawing.contains(part), "{part}");
    }
    fs::write(place.join("notes.svg"), "<svg/>").unwrap();
    let refused = breakaway(place, &["bode", "rec.csv", "--figure", "notes.svg"]);
    assert_eq!(refused.status.code(), Some(1));
    assert_eq!(fs::read_to_string(place.join("notes.svg")).unwrap(), "<svg/>");
    let long = breakaway(place, &["bode", "rec.csv", "--segment", "30", "--json"]);
    assert_eq!(long.status.code(), Some(1));
    let error: Value = serde_json::from_slice(&long.stdout).unwrap();
    assert_eq!(error["error"]["kind"], "segment", "{error}");
}
