//! What a person gets who gives the wrong thing: it says what was wrong, where, and what to do, on one page of a terminal.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn breakaway(folder: &Path, line: &str) -> Output {
    let words = line.split_whitespace();
    Command::new(env!("CARGO_BIN_EXE_breakaway")).current_dir(folder).args(words).output().unwrap()
}

const MODEL: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";
const RELAY: &str = "name = \"relay\"\nduration_s = 2.0\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n[sensor]\nencoder_step = 1e-3\n";

/// A folder with one file of each kind, each of them right where it belongs.
fn files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(place.join("model.toml"), MODEL).unwrap();
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    for line in ["run relay.toml --model model.toml -o session/fit", "tune model.toml -o controller.toml"] {
        let done = breakaway(place, line);
        assert!(done.status.success(), "{line}: {}", String::from_utf8_lossy(&done.stderr));
    }
    fs::rename(place.join("session/fit/relay.csv"), place.join("rec.csv")).unwrap();
    fs::write(place.join("binary"), (0..=255).collect::<Vec<u8>>()).unwrap();
    fs::write(place.join("report.html"), "<!DOCTYPE html>\n<p>no</p>\n").unwrap();
    fs::write(place.join("result.json"), "{}\n").unwrap();
    fs::write(place.join("words.csv"), "hello\nworld\n").unwrap();
    let mut rows = fs::read_to_string(place.join("rec.csv")).unwrap();
    rows.push_str("2.5,1e200,0\n");
    fs::write(place.join("large.csv"), rows).unwrap();
    folder
}

#[test]
fn a_file_of_another_kind_is_recognised() {
    let folder = files();
    for (line, words) in [
        ("identify model.toml", "model.toml is a model (TOML), not a recording"),
        ("identify controller.toml", "a model is given by --model"),
        ("discover relay.toml", "relay.toml is a TOML file, not a recording"),
        (
            "sinefit binary",
            "binary is binary data, not a recording (CSV with a header row); give the log as CSV, MCAP, WPILOG, ULog, npz, MAT or Parquet",
        ),
        ("identify report.html", "is a page (HTML or XML), not a recording"),
        ("identify result.json", "is a JSON file, not a recording"),
        ("identify words.csv", "are they separated by commas"),
        ("identify session", "session is a folder, not a recording; name the files in it, such as session/fit/*.csv"),
        ("tune rec.csv", "rec.csv is a recording (CSV), not a model"),
        ("tune relay.toml", "relay.toml is an experiment (TOML), not a model"),
        ("tune controller.toml", "give the model it was tuned from"),
        ("tune binary", "binary is binary data, not a model"),
        (
            "simulate --model model.toml --experiment rec.csv -o a.csv",
            "rec.csv is a recording (CSV), not an experiment",
        ),
        ("simulate --model relay.toml --experiment model.toml -o a.csv", "is an experiment (TOML), not a model"),
        ("run model.toml -o a", "model.toml is a model (TOML), not an experiment (TOML with [excitation])"),
        ("run suit -o a", "suit: no such file; EXPERIMENT is a TOML file, or the word `suite`"),
        (
            "track --model model.toml --controller model.toml",
            "is a model (TOML), not a controller (TOML); `breakaway tune",
        ),
        ("virtual-board --image model.toml", "model.toml is not a firmware image (ELF)"),
    ] {
        let run = breakaway(folder.path(), line);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), run.stdout.as_slice()), (Some(1), &b""[..]), "{line}: {message}");
        assert!(message.contains(words), "{line}: {message}");
    }
    assert!(!folder.path().join("a.csv").exists() && !folder.path().join("a").exists());
}

/// A reason that is the file's own is not replaced: the file is what it should be, with a mistake in it.
#[test]
fn a_mistake_in_the_right_file_keeps_its_line() {
    let folder = files();
    let place = folder.path();
    fs::write(place.join("model.toml"), MODEL.replace("c = 0.11", "c = -1")).unwrap();
    fs::write(place.join("relay.toml"), RELAY.replace("h1", "h0")).unwrap();
    for (line, words) in [
        ("tune model.toml", "model.toml:3: `c` is -1"),
        ("run relay.toml -o a", "unknown field `h0`, expected one of `h1`"),
        ("identify rec.csv --input iq", "no column `iq`"),
        ("identify rec.csv --input iq --time u", "columns: t, u, x"),
    ] {
        let message = String::from_utf8(breakaway(place, line).stderr).unwrap();
        assert!(message.contains(words), "{line}: {message}");
    }
}

/// Where the result cannot be written is said before the work, names the folder, and not a file that the user never saw.
#[test]
fn places_that_cannot_be_written_are_told_first() {
    let folder = files();
    fs::write(folder.path().join("file"), "").unwrap();
    for (line, words) in [
        (
            "discover rec.csv --report no/r.html",
            "no/r.html: cannot be written: the folder no is not there; make it first",
        ),
        ("discover rec.csv -o session", "session: cannot be written: is a directory, not a file"),
        ("discover rec.csv -o file/m.toml", "file is a file, not a folder"),
        ("identify rec.csv -o no/m.toml", "the folder no is not there; make it first"),
        ("run relay.toml -o file/a", "cannot make the folder file/a: file is a file; give another folder"),
        ("demo -o file", "cannot make the folder file: file is a file"),
        ("man -o file", "cannot make the folder file: file is a file"),
        ("discover --fleet session -o file", "cannot make the folder file: file is a file"),
        ("discover --fleet no -o out", "the folder no cannot be read"),
    ] {
        let run = breakaway(folder.path(), line);
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), run.stdout.as_slice()), (Some(1), &b""[..]), "{line}: {message}");
        assert!(message.contains(words) && !message.contains(".breakaway-"), "{line}: {message}");
    }
}

/// Numbers of any size are refused by name, in a line that fits a terminal.
#[test]
fn huge_numbers_are_told_in_a_line() {
    let folder = files();
    for (line, words) in [
        ("run suite -o a --tick 1e-300", "out of range: it must be 8 to 1e8 samples"),
        ("run suite -o a --tick 1e9", "out of range: it must be 8 to 1e8 samples"),
        ("run suite -o a --noise 1e300", "ten deviations of the noise"),
        ("track --model model.toml --duration 1e300", "--duration 1e300 s is more than"),
        ("tune model.toml --tick 1e9", "no bandwidth is possible"),
        ("tune model.toml --encoder-step 1e300", "check --encoder-step"),
        ("identify large.csv", "warning: large.csv: 1e200 at t = 2.5 s is no drive and no position"),
    ] {
        let run = breakaway(folder.path(), line);
        let message = String::from_utf8(run.stderr).unwrap();
        assert!(message.contains(words), "{line}: {message}");
        assert!(message.lines().all(|line| line.chars().count() < 500), "{line}: {message}");
    }
}
