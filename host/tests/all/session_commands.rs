//! What `identify`, `discover` and `sinefit` refuse before they work. These are units that differ, a recording given
//! twice, columns in each other's place, names that are no text.
#![allow(clippy::format_collect, reason = "some rows of text; the fold would hide what they are")]

use std::fs;
use std::path::Path;

use crate::support::{breakaway, json, keys, text};

/// The papers' plant: the standard suite, 250 samples per second.
fn suite(folder: &Path) -> Vec<String> {
    let document = json(folder, &["run", "suite", "--tick", "0.004", "-o", "s"]);
    assert!(keys(&document).contains(&"recordings"));
    let files = document["recordings"].as_array().unwrap().iter();
    let fit = files.filter(|entry| entry["role"] == "fit").map(|entry| entry["file"].as_str().unwrap().to_owned());
    fit.collect()
}

/// Standard error of a run that must fail with `code`, and must print nothing else.
fn refused(folder: &Path, code: i32, arguments: &[&str]) -> String {
    let run = breakaway(folder, arguments);
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(code), ""), "{arguments:?}: {}", text(&run.stderr));
    text(&run.stderr).to_owned()
}

/// Each file alone and all of them: the position leads the drive when the two are swapped, which no axis does.
#[test]
fn swapped_columns_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let files = suite(folder.path());
    let all: Vec<&str> = files.iter().map(String::as_str).collect();
    let swapped =
        |files: &[&str]| refused(folder.path(), 1, &[&["identify", "--input", "x", "--position", "u"], files].concat());
    for file in &all {
        let error = swapped(&[file]);
        assert!(error.contains("swapped"), "{file}: {error}");
    }
    let error = swapped(&all);
    assert!(error.contains("swapped"), "{error}");
    let right = json(folder.path(), &[&["identify"], all.as_slice()].concat());
    assert!(right["c"]["value"].as_f64().unwrap() > 0.0);
}

#[test]
fn different_units_and_recordings_given_twice_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let files = suite(place);
    let (first, second) = (files[0].as_str(), files[1].as_str());
    let other = fs::read_to_string(place.join(second)).unwrap().replace("u=V, x=rad", "u=A, x=deg");
    fs::write(place.join("other.csv"), other).unwrap();
    fs::copy(place.join(first), place.join("copy.csv")).unwrap();
    for command in ["identify", "discover"] {
        let error = refused(place, 1, &[command, first, "other.csv"]);
        assert!(error.contains("is in V and rad and other.csv in A and deg"), "{command}: {error}");
        let error = refused(place, 1, &[command, first, second, "copy.csv"]);
        assert!(error.contains(&format!("copy.csv holds the same samples as {first}")), "{command}: {error}");
    }
    for held in [first, "copy.csv"] {
        let error = refused(place, 1, &["discover", first, second, "--holdout", held]);
        assert!(error.contains("what is fitted cannot be held out"), "{error}");
    }
}

/// Limits are told, not run into: a rate, a device that never ends, a header of a million columns.
#[test]
fn what_is_too_much_is_refused_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(place.join("wide.csv"), (0..1_000_000).map(|k| format!("c{k},")).collect::<String>()).unwrap();
    let rows: String = (0..200).map(|k| format!("{},{},{}\n", k, k % 5, k * k)).collect();
    fs::write(place.join("us.csv"), format!("time,u,x\n{rows}")).unwrap();
    let mut cases = vec![
        (vec!["identify", "wide.csv"], "no end of the row within 1024 KiB"),
        (vec!["identify", "us.csv", "--time", "time", "--fs=1e20"], "--fs is 100000000000000000000; it must be"),
        (vec!["sinefit", "us.csv", "--time", "time"], "read in s, gives 1 Hz between rows"),
        (vec!["discover", "us.csv", "--time", "time"], "it is probably in ms (1000 Hz"),
    ];
    if cfg!(unix) {
        cases.push((vec!["identify", "/dev/zero"], "/dev/zero is binary data"));
        cases.push((vec!["sinefit", "/dev/zero"], "/dev/zero is binary data"));
    }
    for (arguments, words) in cases {
        let error = refused(place, 1, &arguments);
        assert!(error.contains(words) && error.len() < 500, "{arguments:?}: {error}");
    }
}

/// A file's name need not be text: it is read, and shown as well as it can be.
#[cfg(unix)]
#[test]
fn a_name_that_is_no_text_is_read() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::process::Command;

    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let files = suite(place);
    let name = OsStr::from_bytes(b"r\xe9lais.csv");
    fs::copy(place.join(&files[0]), place.join(name)).unwrap();
    for command in ["identify", "discover", "sinefit"] {
        let run =
            Command::new(env!("CARGO_BIN_EXE_breakaway")).current_dir(place).arg(command).arg(name).output().unwrap();
        assert_eq!(run.status.code(), Some(0), "{command}: {}", text(&run.stderr));
    }
}

/// Gravity is a law of an angle. A position in degrees is converted, so that it is named there as it is in rad, with the same
/// force; it was called cogging.
#[test]
fn gravity_is_named_in_degrees() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let model = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[[effect]]\nname = \"gravity_load\"\nm = 0.3\nphi = 0.2\n";
    fs::write(place.join("axis.toml"), model).unwrap();
    let session = json(place, &["run", "suite", "--model", "axis.toml", "--tick", "0.002", "-o", "s"]);
    let mut files = Vec::new();
    for entry in session["recordings"].as_array().unwrap().iter().filter(|entry| entry["role"] == "fit") {
        let file = entry["file"].as_str().unwrap();
        let recording = fs::read_to_string(place.join(file)).unwrap();
        let rows = recording.lines().filter(|line| !line.starts_with(['#', 't'])).map(|line| {
            let (rest, x) = line.rsplit_once(',').unwrap();
            format!("{rest},{}\n", x.parse::<f64>().unwrap().to_degrees())
        });
        let name = format!("{}-deg.csv", Path::new(file).file_stem().unwrap().to_string_lossy());
        fs::write(place.join(&name), "t,u,x_deg\n".to_owned() + &rows.collect::<String>()).unwrap();
        files.push(name);
    }
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let found = json(place, &[&["discover", "--position", "x_deg"], files.as_slice()].concat());
    assert_eq!(found["effects"][0]["name"], "gravity_load", "{}", found["effects"]);
    // 1 %: the sensor's step is a thousandth of a radian, as for the suite's other acceptance numbers.
    let m = found["effects"][0]["parameters"]["m"]["value"].as_f64().unwrap();
    assert!((m - 0.3).abs() < 0.003, "{m}");
    assert!(found["remarks"].to_string().contains("converted from deg to rad"), "{}", found["remarks"]);
}
