//! What every command that reads recordings takes: standard input, gzip, a window of time; and how much it says.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::support::{breakaway, json, text};

const MODEL: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";
const RELAY: &str =
    "name = \"rec\"\nduration_s = 8.0\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n[sensor]\nnoise = 1e-3\n";

/// A folder with `model.toml`, `relay.toml`, and a recording of 8 s as `rec.csv` and `rec.csv.gz`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    fs::write(place.join("model.toml"), MODEL).unwrap();
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    json(place, &["simulate", "--model", "model.toml", "--experiment", "relay.toml", "-o", "rec.csv"]);
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&fs::read(place.join("rec.csv")).unwrap()).unwrap();
    fs::write(place.join("rec.csv.gz"), packed.finish().unwrap()).unwrap();
    folder
}

/// Runs `breakaway` with a file on its standard input.
fn fed(folder: &Path, input: &str, arguments: &[&str]) -> Output {
    let input = Stdio::from(fs::File::open(folder.join(input)).unwrap());
    Command::new(env!("CARGO_BIN_EXE_breakaway")).current_dir(folder).args(arguments).stdin(input).output().unwrap()
}

/// A document without what names the file and the time taken.
fn result(run: &Output) -> serde_json::Value {
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    let mut document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    document["seconds"] = serde_json::Value::Null;
    document["provenance"] = serde_json::Value::Null;
    document
}

/// The same bytes give the same result, whether they come from a file, packed, or on standard input, packed or not.
#[test]
fn a_recording_comes_from_a_file_packed_or_on_standard_input() {
    let folder = folder();
    let place = folder.path();
    for command in [&["identify"][..], &["sinefit"]] {
        let run = |name: &str, input: &str| result(&fed(place, input, &[command, &[name, "--json"]].concat()));
        let plain = run("rec.csv", "model.toml");
        assert_eq!(run("rec.csv.gz", "model.toml"), plain, "{command:?}");
        assert_eq!(run("-", "rec.csv"), plain, "{command:?}");
        assert_eq!(run("-", "rec.csv.gz"), plain, "{command:?}");
    }
    let model = fed(place, "rec.csv", &["identify", "-", "-o", "-"]);
    assert!(text(&model.stdout).contains("# from standard input"), "{}", text(&model.stdout));
}

/// The provenance of what came on standard input has the hash of its bytes, which `sha256sum` of the file shows.
#[test]
fn a_discovery_on_standard_input_knows_what_it_read() {
    let folder = folder();
    let place = folder.path();
    let hash = |run: Output| {
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let input = &document["provenance"]["inputs"][0];
        (input["file"].as_str().unwrap().to_owned(), input["sha256"].as_str().unwrap().to_owned())
    };
    let file = hash(fed(place, "model.toml", &["discover", "rec.csv.gz", "--json"]));
    let standard = hash(fed(place, "rec.csv.gz", &["discover", "-", "--json"]));
    let expected = breakaway::fleet::hash::hash(&place.join("rec.csv.gz")).unwrap();
    assert_eq!(file, ("rec.csv.gz".to_owned(), expected.clone()));
    assert_eq!(standard, ("standard input".to_owned(), expected));
}

/// A model may come on standard input; standard input is read once.
#[test]
fn models_come_on_standard_input_and_nothing_comes_twice() {
    let folder = folder();
    let place = folder.path();
    let arguments = ["simulate", "--model", "-", "--experiment", "relay.toml", "-o", "-"];
    let run = fed(place, "model.toml", &arguments);
    assert_eq!(text(&run.stdout), fs::read_to_string(place.join("rec.csv")).unwrap());
    let wrong = fed(place, "rec.csv", &["tune", "-"]);
    assert_eq!(wrong.status.code(), Some(1));
    let message = text(&wrong.stderr);
    assert!(message.starts_with("error: standard input is a recording (CSV), not a model"), "{message}");
    for twice in [&["identify", "-", "-"][..], &["discover", "-", "--holdout", "-"]] {
        let run = fed(place, "rec.csv", twice);
        assert_eq!(run.status.code(), Some(2));
        assert_eq!(text(&run.stderr), "error: `-` is given more than once; standard input can be read once\n");
    }
}

/// A packed file that is cut off is refused: what is there of it is no whole recording.
#[test]
fn a_packed_file_that_is_cut_off_is_refused() {
    let folder = folder();
    let whole = fs::read(folder.path().join("rec.csv.gz")).unwrap();
    fs::write(folder.path().join("half.csv.gz"), &whole[..whole.len() / 2]).unwrap();
    let run = breakaway(folder.path(), &["identify", "half.csv.gz"]);
    assert_eq!(run.status.code(), Some(1));
    let message = text(&run.stderr);
    assert!(message.starts_with("error: half.csv.gz: cannot be read: "), "{message}");
}

/// `--from` and `--to` take out the same rows as an editor would; what they cannot take out has a message of its own.
#[test]
fn a_window_of_time_is_as_good_as_a_shorter_file() {
    let folder = folder();
    let place = folder.path();
    let whole = fs::read_to_string(place.join("rec.csv")).unwrap();
    let inside = |line: &&str| {
        let t = line.split(',').next().and_then(|t| t.parse::<f64>().ok());
        t.is_none_or(|t| (2.0..=6.5).contains(&t))
    };
    fs::write(place.join("cut.csv"), whole.lines().filter(inside).collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let window = ["--from", "2", "--to", "6.5", "--json"];
    for command in ["identify", "sinefit", "discover"] {
        let windowed = result(&breakaway(place, &[&[command, "rec.csv"][..], &window].concat()));
        let mut cut = result(&breakaway(place, &[command, "cut.csv", "--json"]));
        let text = cut.to_string().replace("cut,", "rec,");
        cut = serde_json::from_str(&text).unwrap();
        assert_eq!(windowed, cut, "{command}");
        let nothing = breakaway(place, &[command, "rec.csv", "--from", "20"]);
        assert_eq!(nothing.status.code(), Some(1));
        assert_eq!(
            text_of_error(&nothing),
            "error: rec.csv: no row from 20 s to inf s; the recording runs from 0 s to 7.999 s\n"
        );
        let reversed = breakaway(place, &[command, "rec.csv", "--from", "3", "--to", "-2"]);
        assert_eq!(
            (reversed.status.code(), text_of_error(&reversed)),
            (Some(2), "error: --from 3 is not before --to -2\n")
        );
    }
}

fn text_of_error(run: &Output) -> &str {
    text(&run.stderr)
}

/// `--quiet` leaves errors alone on standard error, `-v` has a line for each step, and neither changes the result.
#[test]
fn quiet_says_errors_alone_and_verbose_says_each_step() {
    let folder = folder();
    let place = folder.path();
    // A row written twice is warned of.
    let whole = fs::read_to_string(place.join("rec.csv")).unwrap();
    let mut lines: Vec<&str> = whole.lines().collect();
    lines.insert(1000, lines[1000]);
    fs::write(place.join("twice.csv"), lines.join("\n") + "\n").unwrap();
    let run = |more: &[&str]| breakaway(place, &[&["discover", "twice.csv", "--json"][..], more].concat());
    let (normal, quiet, verbose) = (run(&[]), run(&["--quiet"]), run(&["-v"]));
    assert_eq!(result(&quiet), result(&normal));
    assert_eq!(result(&verbose), result(&normal));
    assert!(text(&normal.stderr).starts_with("warning: twice.csv: "), "{}", text(&normal.stderr));
    assert_eq!(text(&quiet.stderr), "");
    let said = text(&verbose.stderr);
    for step in ["twice.csv: 8000 rows, 0.000 s to 7.999 s", "judging the measured forces", "fitting the base model"] {
        assert!(said.contains(step), "{said}");
    }
    let missing = breakaway(place, &["identify", "no.csv", "--quiet"]);
    assert_eq!(text(&missing.stderr), "error: no.csv: no such file; check the path\n");
    assert_eq!(breakaway(place, &["identify", "rec.csv", "-q", "-v"]).status.code(), Some(2));
}

/// Each of five recordings has a row that is written twice. Three warnings are shown, and that more are left out; all five
/// with `-v`, and in the JSON document.
#[test]
fn of_many_like_warnings_three_are_shown() {
    let folder = folder();
    let place = folder.path();
    let whole = fs::read_to_string(place.join("rec.csv")).unwrap();
    let files = ["1.csv", "2.csv", "3.csv", "4.csv", "5.csv"];
    for (i, file) in files.iter().enumerate() {
        // Each file ends elsewhere, because samples that are given twice are refused.
        let mut lines: Vec<&str> = whole.lines().collect();
        lines.insert(1000, lines[1000]);
        lines.truncate(8000 - 10 * i);
        fs::write(place.join(file), lines.join("\n") + "\n").unwrap();
    }
    let run = |more: &[&str]| breakaway(place, &[&["identify"][..], &files, more].concat());
    let warned = |run: &Output| text(&run.stderr).matches("warning: ").count();
    let normal = run(&[]);
    assert_eq!(warned(&normal), 3);
    let left_out = "further warnings of this kind are left out; -v shows them\n";
    assert!(text(&normal.stderr).contains(left_out), "{}", text(&normal.stderr));
    assert_eq!(warned(&run(&["-v"])), 5);
    // Of three none is left out.
    let three = breakaway(place, &[&["identify"][..], &files[..3]].concat());
    assert!(warned(&three) == 3 && !text(&three.stderr).contains(left_out), "{}", text(&three.stderr));
    let document = run(&["--json"]);
    let remarks = result(&document)["remarks"].as_array().unwrap().len();
    let of_the_files = text(&document.stdout).matches("the time stamp of the row before is repeated").count();
    assert!(of_the_files == 5 && remarks >= 5, "{}", text(&document.stdout));
}
