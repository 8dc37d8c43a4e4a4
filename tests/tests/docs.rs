//! The examples of docs/formats.md, read by the real readers, so that the page cannot rot.

use std::collections::BTreeMap;
use std::path::Path;

use breakaway::model::Model;
use breakaway::recording::{ReadOptions, Recording};
use breakaway::simulate::experiment::{Excitation, Experiment};

/// The page.
fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats.md");
    std::fs::read_to_string(path).expect("docs/formats.md is there")
}

/// The fenced blocks of one language, each with its line.
fn blocks(page: &str, language: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, String, bool)> = None;
    for (number, line) in page.lines().enumerate() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => open = Some((number + 1, String::new(), info.trim() == language)),
            (Some(_), Some(_)) => {
                if let Some((at, text, true)) = open.take() {
                    found.push((at, text));
                }
            }
            (Some((_, text, _)), None) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a fenced block is not closed");
    found
}

/// Every `toml` example is a model (it has `[base]`) or an experiment, and its reader takes it; each kind of excitation
/// and of reference has an example.
#[test]
fn toml_examples_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("example.toml");
    let (mut models, mut kinds) = (0, BTreeMap::<&str, u32>::new());
    let mut seen = |name| *kinds.entry(name).or_default() += 1;
    for (line, text) in blocks(&page(), "toml") {
        std::fs::write(&file, &text).unwrap();
        if text.contains("[base]") {
            let model = Model::read(&file).unwrap_or_else(|error| panic!("docs/formats.md:{line}: {error}"));
            // What is written is what was read.
            assert_eq!(Model::parse("again", &model.to_toml()).unwrap(), model, "docs/formats.md:{line}");
            models += 1;
            continue;
        }
        let experiment = Experiment::read(&file).unwrap_or_else(|error| panic!("docs/formats.md:{line}: {error}"));
        seen(match &experiment.excitation {
            Excitation::Relay { .. } => "relay",
            Excitation::Multisine { .. } => "multisine",
            Excitation::Sine { .. } => "sine",
            Excitation::Ramp { .. } => "ramp",
            Excitation::Track { .. } => "track",
        });
    }
    assert!(models >= 1);
    assert_eq!(kinds.keys().copied().collect::<Vec<_>>(), ["multisine", "ramp", "relay", "sine", "track"]);
}

/// Every `csv` example is a recording, and what the page says of it holds: 8 rows and more, the tick, the units, the gap.
#[test]
fn recording_examples_are_read() {
    let page = page();
    let examples = blocks(&page, "csv");
    let [(_, own), (_, strange)] = examples.as_slice() else { panic!("two csv examples") };
    let recording = Recording::read_from("own.csv", own.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((recording.units.u.as_str(), recording.units.x.as_str()), ("V", "rad"));
    assert_eq!(recording.encoder_step, Some(0.001));
    assert_eq!(recording.gaps, [6]);
    assert_eq!(recording.meta.get("experiment").map(String::as_str), Some("relay_high"));
    let mut written = Vec::new();
    recording.write_to(&mut written).unwrap();
    let again = Recording::read_from("own.csv", written.as_slice(), &ReadOptions::default()).unwrap();
    assert_eq!(again, recording);

    let options = ReadOptions {
        time: Some("t_ms".into()),
        input: Some("iq_A".into()),
        position: Some("angle [rad]".into()),
        select: vec!["mode=2".parse().unwrap()],
        ..ReadOptions::default()
    };
    let recording = Recording::read_from("strange.csv", strange.as_bytes(), &options).unwrap();
    assert_eq!((recording.units.u.as_str(), recording.units.x.as_str()), ("A", "rad"));
    assert!((recording.t[1] - recording.t[0] - 0.002).abs() < 1e-12);
    assert_eq!((recording.t.len(), recording.gaps.as_slice()), (8, &[4][..]));
}

/// Every `json` example is JSON with the keys that the commands promise (command-line contract).
#[test]
fn json_examples_have_the_promised_keys() {
    let page = page();
    let examples = blocks(&page, "json");
    let documents: Vec<serde_json::Value> = examples
        .iter()
        .map(|(line, text)| serde_json::from_str(text).unwrap_or_else(|e| panic!("{line}: {e}")))
        .collect();
    let [sinefit, identify] = documents.as_slice() else { panic!("two json examples") };
    for key in ["amplitude", "omega", "phase", "phase_centre", "offset", "rms", "se", "cycles"] {
        assert!(sinefit.get(key).is_some(), "sinefit: {key}");
    }
    for key in ["b", "c", "f1", "load", "undetermined", "noise", "estimator"] {
        assert!(identify.get(key).is_some(), "identify: {key}");
    }
}
