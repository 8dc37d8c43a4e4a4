//! The other pages, as their reader does them: a shell runs their lines in order, in one folder for each page. What the reader
//! has already is made first. README.md and the tutorial are in walk.rs, lines with a board in tests/tests/virtual_board.
#![cfg(unix)]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use super::walk::commands::{Program, lines, pages, root, shown};
use super::walk::{BOARD, done};

/// Pages that are walked elsewhere, or whose reader adds an effect to the program first.
const ELSEWHERE: [&str; 3] = ["README.md", "docs/tutorial.md", "docs/adding-an-effect.md"];
/// Pages that simulate a session are as quick with 250 samples per second.
const SMALLER: (&str, &str) = ("breakaway run suite", "breakaway run suite --tick 0.004");
const AXIS: &str = "base = { b = 0.02685, c = 0.11, f1 = 0.5 }\nunits = { u = \"V\", x = \"rad\" }\n\n\
                    [[effect]]\nname = \"cogging\"\nA = 0.2\nn = 7.0\nphi = 0.5\n";
const RELAY: &str = "name = \"relay\"\nduration_s = 40.0\nexcitation = { kind = \"relay\", h1 = 2.0, h2 = 1.5 }\n";
/// What ODrive's own file says of two of its frames.
const DBC: &str = r#"VERSION ""

BU_: ODrive

BO_ 9 Axis0_Get_Encoder_Estimates: 8 ODrive
 SG_ Pos_Estimate : 0|32@1- (1,0) [0|0] "rev" Vector__XXX
 SG_ Vel_Estimate : 32|32@1- (1,0) [0|0] "rev/s" Vector__XXX

BO_ 20 Axis0_Get_Iq: 8 ODrive
 SG_ Iq_Setpoint : 0|32@1- (1,0) [0|0] "A" Vector__XXX
 SG_ Iq_Measured : 32|32@1- (1,0) [0|0] "A" Vector__XXX

SIG_VALTYPE_ 9 Pos_Estimate : 1;
SIG_VALTYPE_ 9 Vel_Estimate : 1;
SIG_VALTYPE_ 20 Iq_Setpoint : 1;
SIG_VALTYPE_ 20 Iq_Measured : 1;
"#;

/// Makes `rec.csv` of the axis, and gives its rows.
fn recording(place: &Path) -> Vec<[f64; 3]> {
    fs::write(place.join("relay.toml"), RELAY).unwrap();
    fs::write(place.join("model.toml"), AXIS).unwrap();
    done(place, "breakaway simulate --model model.toml --experiment relay.toml -o rec.csv");
    let rows = fs::read_to_string(place.join("rec.csv")).unwrap();
    let numbers = |line: &str| -> Option<[f64; 3]> {
        let mut fields = line.split(',').map(|field| field.parse().ok());
        Some([fields.next()??, fields.next()??, fields.next()??])
    };
    rows.lines().filter_map(numbers).collect()
}

/// Writes the rows as frames of an ODrive, in candump's form, and their description.
fn frames(place: &Path, rows: &[[f64; 3]]) {
    let mut log = String::new();
    for [t, u, x] in rows {
        for (id, first) in [("009", x), ("014", u)] {
            let hex = |value: f64| (value as f32).to_le_bytes().map(|byte| format!("{byte:02X}")).concat();
            // Writing to a String cannot fail.
            let _ = writeln!(log, "({:.6}) can0 {id}#{}{}", 1.7e9 + t, hex(*first), hex(0.0));
        }
    }
    fs::write(place.join("frames.log"), log).unwrap();
    fs::write(place.join("axis.dbc"), DBC).unwrap();
}

/// Writes the rows as the states of two joints, of which the elbow moves.
fn joint_states(place: &Path, rows: &[[f64; 3]]) {
    let mut writer = mcap::Writer::new(fs::File::create(place.join("robot.mcap")).unwrap()).unwrap();
    let channel = writer.add_channel(0, "/joint_states", "json", &std::collections::BTreeMap::new()).unwrap();
    for (k, [t, u, x]) in rows.iter().enumerate() {
        let (sec, nanosec) = (t.floor(), (t.fract() * 1e9).round());
        let message = format!(
            "{{\"header\":{{\"stamp\":{{\"sec\":{sec},\"nanosec\":{nanosec}}}}},\"name\":[\"shoulder\",\"elbow\"],\
             \"position\":[0.5,{x}],\"effort\":[0.0,{u}]}}"
        );
        let log_time = (t * 1e9) as u64;
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: k as u32, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, message.as_bytes()).unwrap();
    }
    writer.finish().unwrap();
}

/// What the reader of a page has before its first line; false where it is somebody else's and not here.
fn prepare(page: &str, place: &Path) -> bool {
    match page {
        "docs/control.md" | "docs/formats.md" => {
            recording(place);
            done(place, "gzip -c rec.csv > LOG.csv.gz");
        }
        "docs/logs.md" => {
            let rows = recording(place);
            frames(place, &rows);
            joint_states(place, &rows);
        }
        "docs/fleet.md" => {
            fs::write(place.join("axis.toml"), AXIS).unwrap();
            fs::create_dir_all(place.join("machines/press-2")).unwrap();
            done(place, "breakaway run suite --model axis.toml --tick 0.004 -o machines/press-1");
            fs::copy(place.join("machines/press-1/fit/multisine.csv"), place.join("machines/press-2/monday.csv"))
                .unwrap();
        }
        "docs/case-studies.md" => {
            let data = std::env::var_os("BREAKAWAY_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from);
            for file in ["emps/emps_train.csv", "laas-motor/current-sine-2hz.csv"] {
                if fs::copy(data.join(file), place.join(Path::new(file).file_name().unwrap())).is_err() {
                    eprintln!("NOT RUN: {file} is not in {}", data.display());
                    return false;
                }
            }
        }
        // The session that the page takes from a board.
        "docs/virtual-board.md" | "docs/board-pico2.md" => {
            fs::write(place.join("axis.toml"), AXIS).unwrap();
            done(place, "breakaway run suite --model axis.toml --tick 0.004 -o session");
        }
        _ => {}
    }
    true
}

/// Command lines of a page that a test can run, whole: what stands before a pipe belongs to them.
fn runnable(page: &str, text: &str) -> Vec<String> {
    let own = lines(page, text).into_iter().filter(|line| line.program == Program::Breakaway);
    let own = own.map(|line| (line.index, format!("breakaway {}", line.arguments)));
    let piped = text.lines().enumerate().filter(|(_, row)| row.starts_with("    ") && row.contains(" | breakaway "));
    let mut all: Vec<_> = own.chain(piped.map(|(index, row)| (index, row.trim().to_owned()))).collect();
    all.sort();
    let boardless = |line: &String| !line.split(' ').any(|word| BOARD.contains(&word));
    all.into_iter().map(|(_, line)| line.replacen(SMALLER.0, SMALLER.1, 1)).filter(boardless).collect()
}

#[test]
fn every_page_does_what_it_says() {
    let mut ran = 0;
    for (page, text) in pages().iter().filter(|(page, _)| !ELSEWHERE.contains(&page.as_str())) {
        let lines = runnable(page, text);
        let folder = tempfile::tempdir().unwrap();
        if lines.is_empty() || !prepare(page, folder.path()) {
            continue;
        }
        for (_, name, content) in shown(text) {
            fs::write(folder.path().join(name), content).unwrap();
        }
        for line in &lines {
            done(folder.path(), line);
        }
        ran += lines.len();
    }
    assert!(ran >= 18, "only {ran} lines were run");
}

/// The one command that reads a stranger's log, on frames of a real layout: what `look` prints gives the axis.
#[test]
fn frames_of_an_odrive_become_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let rows = recording(folder.path());
    frames(folder.path(), &rows);
    let looked = super::support::json(folder.path(), &["look", "frames.log", "--dbc", "axis.dbc"]);
    let command = looked["files"][0]["command"].as_str().unwrap().replace('\'', "");
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    let found = super::support::json(folder.path(), &words);
    let same = super::support::json(folder.path(), &["identify", "rec.csv"]);
    let b = |document: &serde_json::Value| document["b"]["value"].as_f64().unwrap();
    assert!((b(&found) / b(&same) - 1.0).abs() < 1e-3, "{command}: {found}, and not {same}");
}
