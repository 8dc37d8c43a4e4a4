//! With `--json` an error is a document, too: docs/formats.md, section "Errors".

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

/// The document of a command that fails, and its exit code.
fn fails(place: &Path, line: &str) -> (Value, i32) {
    let words = line.split_whitespace();
    let output =
        Command::new(env!("CARGO_BIN_EXE_breakaway")).current_dir(place).args(words).arg("--json").output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    let document: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{line}: {stderr}"));
    assert_eq!(document["schema_version"], 1);
    let message = document["error"]["message"].as_str().unwrap();
    assert!(stderr.contains(message.lines().next().unwrap()), "{stderr}");
    (document["error"].clone(), output.status.code().unwrap())
}

/// Kind, file, line and column of what was found, beside what the message says to do.
#[test]
fn an_error_has_its_kind_and_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let rows: Vec<String> =
        (0..200).map(|i| format!("{},1.0,{}\n", f64::from(i) * 1e-3, f64::from(i) * 1e-4)).collect();
    let rows = rows.concat();
    fs::write(place.join("rec.csv"), format!("t,u,x\n{rows}")).unwrap();
    fs::write(place.join("bad.csv"), format!("t,u,x\n{rows}0.3,1.0,many\n{rows}")).unwrap();
    fs::write(place.join("model.toml"), "[base]\nb = 0.1\nc = 0.1\nf1 = 0.1\ninertia = 1\n").unwrap();
    let at = |error: &Value| json!([error["kind"], error["file"], error["line"], error["column"]]);
    for (line, place_of, code) in [
        ("identify none.csv", json!(["not_found", "none.csv", null, null]), 1),
        ("identify rec.csv --position angle", json!(["wrong_column", "rec.csv", 1, null]), 1),
        ("identify bad.csv", json!(["not_a_number", "bad.csv", 202, "x"]), 1),
        ("tune model.toml", json!(["unknown", "model.toml", 5, null]), 1),
        ("identify rec.csv --from 3 --to 2", json!(["window_reversed", null, null, null]), 2),
        ("identify", json!(["usage", null, null, null]), 2),
        ("capture --port /dev/ttyNONE0 -o a.csv", json!(["no_port", null, null, null]), 1),
    ] {
        let (error, exit) = fails(place, line);
        assert_eq!((at(&error), exit), (place_of, code), "{line}: {error}");
    }
    let (error, _) = fails(place, "identify rec.csv --position angle");
    assert!(error["hint"].as_str().unwrap().contains("--position"), "{error}");
}

/// Whoever closes standard output reads no document; the command ends with its own exit code all the same.
#[test]
fn a_reader_that_has_gone_away_is_no_panic() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_breakaway"))
        .args(["identify", "none.csv", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What is doubtful and does not end the command is among the remarks of its document.
#[test]
fn a_warning_is_a_remark() {
    let folder = tempfile::tempdir().unwrap();
    let row = |i: i32| format!("{},{}\n", f64::from(i) * 1e-3, (0.1 * f64::from(i)).sin());
    // The clock starts anew: only the longer part is used.
    let rows: String = (0..400).chain(0..200).map(row).collect();
    fs::write(folder.path().join("rec.csv"), format!("t,x\n{rows}")).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_breakaway"))
        .current_dir(folder.path())
        .args(["sinefit", "rec.csv", "--json"])
        .output()
        .unwrap();
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let warned = String::from_utf8(output.stderr).unwrap();
    let remarks = document["remarks"].as_array().unwrap();
    assert_eq!(remarks.len(), warned.matches("warning: ").count(), "{warned}");
    assert!(
        remarks.iter().all(|remark| remark["kind"] == "warning" && warned.contains(remark["text"].as_str().unwrap()))
    );
    assert!(!remarks.is_empty(), "{warned}");
}
