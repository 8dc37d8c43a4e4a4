//! `--figures`: every figure as a drawing, a picture and a table, and never over what somebody else wrote.

use std::fs;
use std::path::Path;

use super::support::{breakaway, text};

const MODEL: &str = "base = { b = 0.02685, c = 0.11, f1 = 0.5 }\nunits = { u = \"V\", x = \"rad\" }\n";
const RELAY: &str = "name = \"relay\"\nduration_s = 2.0\nexcitation = { kind = \"relay\", h1 = 2.0, h2 = 1.5 }\n";

fn recording(place: &Path) {
    fs::write(place.join("model.toml"), MODEL).unwrap();
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    let line = ["simulate", "--model", "model.toml", "--experiment", "relay.toml", "-o", "rec.csv"];
    assert!(breakaway(place, &line).status.success());
}

/// Names of the files of a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn commands_write_every_figure_as_svg_png_and_csv() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    recording(place);
    // What the table's first column and some other column are.
    for (line, figures, columns) in [
        ("look rec.csv", 1, ["time (s)", "drive (V)"]),
        ("bode rec.csv", 1, ["frequency (Hz)", "coherence"]),
        ("sinefit rec.csv", 1, ["time (s)", "x: fitted sine (rad)"]),
        ("identify rec.csv", 1, ["time (s)", "position: simulated (rad)"]),
        ("track --model model.toml --reference sine:1,1 --duration 2", 2, ["time (s)", "drive: PID alone (V)"]),
    ] {
        let folder = place.join(line.split(' ').next().unwrap());
        let words: Vec<&str> = line.split(' ').chain(["--figures", folder.to_str().unwrap()]).collect();
        for again in ["first", "over its own"] {
            let run = breakaway(place, &words);
            assert!(run.status.success(), "{line}, {again}: {}", text(&run.stderr));
        }
        let names = names(&folder);
        assert_eq!(names.len(), 3 * figures, "{names:?}");
        for one in names.chunks(3) {
            assert_eq!(one[0].strip_suffix(".csv"), one[2].strip_suffix(".svg"), "{names:?}");
            assert_eq!(one[0].strip_suffix(".csv"), one[1].strip_suffix(".png"), "{names:?}");
            let svg = fs::read_to_string(folder.join(&one[2])).unwrap();
            assert!(svg.starts_with("<svg ") && svg.contains("<style>") && svg.contains("xmlns="), "{one:?}");
            let png = fs::read(folder.join(&one[1])).unwrap();
            // Twice the width of 800 pixels and of both margins, from the picture's head.
            let width = u32::from_be_bytes(png[16..20].try_into().unwrap());
            assert!(png.starts_with(b"\x89PNG") && width == 2 * 828, "{one:?}: {width}");
        }
        let tables: Vec<String> = names
            .iter()
            .filter(|name| name.strip_suffix(".csv").is_some())
            .map(|name| fs::read_to_string(folder.join(name)).unwrap())
            .collect();
        for column in columns {
            let header = |table: &String| table.lines().nth(1).unwrap().split(',').any(|name| name == column);
            assert!(tables.iter().any(header), "{line}: {column} in {:?}", tables[0].lines().nth(1));
        }
        assert!(tables.iter().all(|table| table.lines().count() > 80), "{line}");
    }
}

/// `--figure` writes what the name of its file ends in, over its own kind alone.
#[test]
fn one_figure_is_what_its_name_ends_in() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    recording(place);
    for command in ["look", "bode"] {
        for (file, begins) in [("f.png", &b"\x89PNG"[..]), ("f.svg", b"<svg "), ("f.CSV", b"# figure by breakaway")] {
            for again in ["first", "over its own"] {
                let run = breakaway(place, &[command, "rec.csv", "--figure", file]);
                assert!(run.status.success(), "{command} {file}, {again}: {}", text(&run.stderr));
            }
            assert!(fs::read(place.join(file)).unwrap().starts_with(begins), "{command} {file}");
        }
    }
    fs::write(place.join("mine.png"), "mine").unwrap();
    assert_eq!(breakaway(place, &["look", "rec.csv", "--figure", "mine.png"]).status.code(), Some(1));
    assert_eq!(fs::read(place.join("mine.png")).unwrap(), b"mine");
}

/// A file of somebody else with a figure's name is seen before the work, and stays.
#[test]
fn a_strange_file_is_not_written_over() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    recording(place);
    let folder = place.join("out");
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("figure-01-mine.csv"), "a,b\n1,2\n").unwrap();
    let run = breakaway(place, &["sinefit", "rec.csv", "--figures", "out"]);
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("is not a figure's table that breakaway wrote"), "{}", text(&run.stderr));
    assert!(text(&run.stdout).is_empty());
    assert_eq!(names(&folder), ["figure-01-mine.csv"]);
    // Beside it, under a name that is no figure's, there is room.
    fs::rename(folder.join("figure-01-mine.csv"), folder.join("mine.csv")).unwrap();
    assert!(breakaway(place, &["sinefit", "rec.csv", "--figures", "out"]).status.success());
    assert_eq!(fs::read_to_string(folder.join("mine.csv")).unwrap(), "a,b\n1,2\n");
    assert_eq!(names(&folder).len(), 4);
}
