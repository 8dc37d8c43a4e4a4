//! What commands write, and what they never write over: their inputs, and what breakaway did not write.

use std::fs;
use std::path::Path;

use crate::support::{breakaway, json, keys, text};

const MODEL: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";
const RELAY: &str = "name = \"relay\"\nduration_s = 4.0\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n[sensor]\nencoder_step = 1e-3\n";

/// A folder with a model and an experiment written by hand, a recording, and a note.
fn files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(place.join("hand.toml"), MODEL).unwrap();
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    let document = json(place, &["run", "relay.toml", "--model", "hand.toml", "-o", "."]);
    assert!(keys(&document).contains(&"recordings"));
    fs::rename(place.join("relay.csv"), place.join("rec.csv")).unwrap();
    fs::write(place.join("note.txt"), "buy bearings\n").unwrap();
    folder
}

/// Runs a line that must fail with `code`; gives what it says. It prints nothing on standard output but, with `--json`, the
/// error.
fn refused(folder: &Path, code: i32, line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    let run = breakaway(folder, &words);
    assert_eq!(run.status.code(), Some(code), "{line}: {}", text(&run.stderr));
    let printed = text(&run.stdout);
    assert!(if words.contains(&"--json") { printed.contains("\"usage\"") } else { printed.is_empty() }, "{printed}");
    text(&run.stderr).to_owned()
}

fn done(folder: &Path, line: &str) -> (String, String) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let run = breakaway(folder, &words);
    assert_eq!(run.status.code(), Some(0), "{line}: {}", text(&run.stderr));
    (text(&run.stdout).to_owned(), text(&run.stderr).to_owned())
}

/// Every command refuses to write over its own input, whatever the name and however much it is asked for.
#[test]
fn an_input_is_never_written_over() {
    let folder = files();
    let place = folder.path();
    let before = fs::read(place.join("rec.csv")).unwrap();
    for line in [
        "identify rec.csv -o rec.csv",
        "identify rec.csv -o ./rec.csv --force",
        "discover rec.csv -o rec.csv --force",
        "discover rec.csv --report rec.csv --force",
        "discover rec.csv --model hand.toml -o hand.toml --force",
        "simulate --model hand.toml --experiment relay.toml -o hand.toml --force",
        "simulate --model hand.toml --experiment relay.toml -o relay.toml --force",
        "tune hand.toml -o hand.toml --force",
        "track --model hand.toml --report hand.toml --force",
    ] {
        assert!(refused(place, 1, line).contains("is an input of this command"), "{line}");
    }
    assert_eq!(fs::read(place.join("rec.csv")).unwrap(), before);
    assert_eq!(fs::read_to_string(place.join("hand.toml")).unwrap(), MODEL);
}

/// What breakaway did not write, or wrote as something else, needs --force; its own is replaced.
#[test]
fn only_its_own_files_are_replaced_without_force() {
    let folder = files();
    let place = folder.path();
    fs::create_dir_all(place.join("fleet/a")).unwrap();
    fs::copy(place.join("rec.csv"), place.join("fleet/a/a.csv")).unwrap();
    for (folder, file) in
        [("pages", "breakaway.1"), ("found", "summary.csv"), ("tracked", "pid.csv"), ("demo", "demo.html")]
    {
        fs::create_dir(place.join(folder)).unwrap();
        fs::write(place.join(folder).join(file), "mine\n").unwrap();
    }
    fs::write(place.join("relay.csv"), "t,u,x\n0,1,2\n1,2,3\n").unwrap();
    for (line, file) in [
        ("identify rec.csv -o hand.toml", "hand.toml"),
        ("identify rec.csv -o note.txt", "note.txt"),
        ("discover rec.csv -o note.txt", "note.txt"),
        ("discover rec.csv --report hand.toml", "hand.toml"),
        ("simulate --model hand.toml --experiment relay.toml -o relay.csv", "relay.csv"),
        ("run relay.toml -o .", "relay.csv"),
        ("tune hand.toml -o note.txt", "note.txt"),
        ("track --model hand.toml --report note.txt", "note.txt"),
        ("track --model hand.toml -o tracked", "tracked/pid.csv"),
        ("capture --port none -o relay.csv", "relay.csv"),
        ("device --port none model get -o hand.toml", "hand.toml"),
        ("man -o pages", "pages/breakaway.1"),
        ("discover --fleet fleet -o found", "found/summary.csv"),
        ("demo -o demo", "demo/demo.html"),
    ] {
        let before = fs::read(place.join(file)).unwrap();
        let said = refused(place, 1, line);
        assert!(said.contains("is there already, and is not") && said.contains("--force"), "{line}: {said}");
        assert_eq!(fs::read(place.join(file)).unwrap(), before, "{line}");
    }
    // A recording is no model: what is its own, but of another kind, stays as well.
    assert!(refused(place, 1, "tune hand.toml -o rec.csv").contains("but a recording (CSV)"));
    for line in [
        "identify rec.csv -o model.toml",
        "tune hand.toml -o controller.toml",
        "track --model hand.toml --report track.html",
        "simulate --model hand.toml --experiment relay.toml -o again.csv",
        "man -o man",
    ] {
        done(place, line);
        done(place, line);
    }
    done(place, "identify rec.csv -o note.txt --force");
    assert!(fs::read_to_string(place.join("note.txt")).unwrap().starts_with("# identified by breakaway"));
}

#[test]
fn two_results_in_one_place_are_wrong_usage() {
    let folder = files();
    let place = folder.path();
    for (line, words) in [
        ("discover rec.csv -o out.toml --report ./out.toml", "out.toml is given for two results"),
        ("discover rec.csv -o - --report -", "standard output is given for two results"),
        ("identify rec.csv -o - --json", "with --json standard output is the JSON document"),
        ("run suite -o -", "`-` is standard output, and this command writes a folder"),
        ("demo -o -", "`-` is standard output"),
        ("man -o -", "`-` is standard output"),
        ("capture --port none -o -", "this command writes a file"),
        ("discover --fleet . -o -", "`-` is standard output"),
    ] {
        assert!(refused(place, 2, line).contains(words), "{line}: {}", refused(place, 2, line));
    }
    assert!(!place.join("out.toml").exists() && !place.join("-").exists());
}

/// The file goes to standard output and what is said of it to standard error, so that commands can be chained.
#[test]
fn a_dash_is_standard_output() {
    let folder = files();
    let place = folder.path();
    let (model, said) = done(place, "identify rec.csv -o -");
    assert!(model.starts_with("# identified by breakaway") && said.contains("by estimator"), "{said}");
    done(place, "identify rec.csv -o model.toml");
    assert_eq!(model, fs::read_to_string(place.join("model.toml")).unwrap());
    let (recording, said) = done(place, "simulate --model hand.toml --experiment relay.toml -o -");
    assert!(recording.starts_with("# tick: ") && said.contains("samples written to standard output"), "{said}");
    done(place, "simulate --model hand.toml --experiment relay.toml -o again.csv");
    assert_eq!(recording, fs::read_to_string(place.join("again.csv")).unwrap());
    let (controller, _) = done(place, "tune hand.toml -o -");
    assert!(controller.starts_with("# Tuned by breakaway"));
    let (page, _) = done(place, "track --model hand.toml --report -");
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
}

/// A second suite in a folder is refused; asked for, it replaces the first, and leaves what breakaway did not write.
#[test]
fn a_suite_does_not_mix_two_sessions() {
    let folder = files();
    let place = folder.path();
    let suite = "run suite --tick 0.004 -o session";
    done(place, suite);
    fs::copy(place.join("rec.csv"), place.join("session/fit/left_over.csv")).unwrap();
    fs::write(place.join("session/fit/log.csv"), "t,u,x\n0,1,2\n").unwrap();
    let before = fs::read(place.join("session/fit/relay_high.csv")).unwrap();
    let said = refused(place, 1, suite);
    assert!(said.contains("session holds a session already (10 recordings)"), "{said}");
    assert_eq!(fs::read(place.join("session/fit/relay_high.csv")).unwrap(), before);
    let (_, said) = done(place, &format!("{suite} --seed 2 --force"));
    assert!(said.contains("log.csv is no recording of breakaway and stays"), "{said}");
    assert!(!place.join("session/fit/left_over.csv").exists() && place.join("session/fit/log.csv").exists());
    assert_ne!(fs::read(place.join("session/fit/relay_high.csv")).unwrap(), before);
    // One experiment may be added to a session.
    done(place, "run relay.toml -o session/fit");
}

/// An experiment's name is the name of a file in the folder, and nothing else.
#[test]
fn names_do_not_leave_the_folder() {
    let folder = files();
    let place = folder.path();
    for name in ["../outside", "/tmp/outside", "a/b", ""] {
        fs::write(place.join("away.toml"), RELAY.replace("\"relay\"\nduration", &format!("\"{name}\"\nduration")))
            .unwrap();
        let said = refused(place, 1, "run away.toml -o out/session");
        assert!(said.contains("cannot be the name of a file in out/session"), "{name}: {said}");
    }
    assert!(!place.join("out").exists() && !place.join("outside.csv").exists());
}
