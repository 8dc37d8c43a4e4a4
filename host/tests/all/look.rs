//! `breakaway look`, and the logs that it and every other command read. The logs are the seeds of fuzz/corpus/log: 24 rows of
//! a made-up relay, written by the formats' own packages (tests/logs/write_logs.py).

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use breakaway::recording::formats::Log;
use breakaway::recording::{ReadOptions, Recording, Warning};
use proptest::prelude::*;
use serde_json::Value;

use crate::support::{breakaway, json, keys, text};

/// What a log's columns are called: its file, time, drive, position.
const LOGS: [(&str, Option<&str>, &str, &str); 20] = [
    ("plain.npz", None, "u", "x"),
    ("packed.npz", None, "u", "x"),
    ("records.npy", Some("array.t"), "array.u", "array.x"),
    ("v5.mat", None, "u", "x"),
    ("v7.mat", Some("log.t"), "log.u", "log.x"),
    ("v73.mat", Some("log.t"), "log.u", "log.x"),
    ("snappy.parquet", None, "u", "x"),
    ("gzip.parquet", None, "u", "x"),
    ("zstd.parquet", None, "u", "x"),
    ("stamps.parquet", Some("time"), "u", "x"),
    ("sysid.wpilog", None, "voltage-motor-drive", "position-motor-drive"),
    ("zstd.mcap", Some("header/stamp"), "axis/effort", "axis/position"),
    ("lz4.mcap", Some("header/stamp"), "axis/effort", "axis/position"),
    ("bag.db3", Some("header/stamp"), "axis/effort", "axis/position"),
    ("humble.db3", Some("header/stamp"), "axis/effort", "axis/position"),
    ("json.mcap", None, "/drive/voltage", "/encoder/position"),
    ("protobuf.mcap", None, "axis/voltage", "axis/position"),
    ("motor.ulg", None, "motor/u", "motor/x"),
    ("split.csv", None, "effort[0]", "position[1]"),
    ("comma.csv", Some("Zeit_ms"), "u", "x"),
];

fn seed(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/log").join(format!("seed-{name}"))
}

fn options(time: Option<&str>, drive: &str, position: &str) -> ReadOptions {
    ReadOptions {
        time: time.map(str::to_owned),
        input: Some(drive.to_owned()),
        position: Some(position.to_owned()),
        ..ReadOptions::default()
    }
}

/// Each log has the drive and the position of the first one, bit for bit. Its times are off by 1 µs at most, which is the
/// resolution of WPILOG and ULog; WPILOG also has no time 0.
#[test]
fn every_format_gives_the_same_recording() {
    let first = Recording::read(&seed("plain.npz"), &options(None, "u", "x")).unwrap();
    assert_eq!(first.t.len(), 24);
    for (name, time, drive, position) in LOGS {
        let read =
            Recording::read(&seed(name), &options(time, drive, position)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!((&read.u, &read.x), (&first.u, &first.x), "{name}");
        assert_eq!(read.t.len(), first.t.len(), "{name}");
        let off = read.t.iter().zip(&first.t).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= 1.001e-6, "{name}: {off}");
        assert!(!read.found.iter().any(|warning| matches!(warning, Warning::Joined { .. })), "{name}");
    }
    // A date is the same recording 1.7e9 s later.
    let dates = Recording::read(&seed("dates.csv"), &options(Some("time"), "u", "x")).unwrap();
    assert!((dates.t[23] - 1_700_000_000.0 - first.t[23]).abs() < 1e-6);
}

/// Guesses of `look` are the columns of `LOGS`, the command it prints works, and the document is that of its help.
#[test]
fn look_guesses_the_columns_of_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for (name, time, drive, position) in LOGS {
        fs::copy(seed(name), folder.path().join(name)).unwrap();
        let document = json(folder.path(), &["look", name]);
        assert_eq!(keys(&document), ["files", "schema_version", "version"]);
        let file = &document["files"][0];
        let wanted = ["channels", "command", "drive", "faults", "file", "format", "hints", "passed_over", "position"];
        assert_eq!(keys(file)[..9], wanted, "{name}");
        assert_eq!(keys(file)[9..], ["stamped", "time"], "{name}");
        let channel = |role: &str| file[role]["channel"].as_str().unwrap_or_default().to_owned();
        assert!(channel("drive").ends_with(drive) && channel("position").ends_with(position), "{name}: {file}");
        if let Some(time) = time {
            assert!(channel("time").ends_with(time), "{name}: {file}");
        }
        let command = file["command"].as_str().unwrap().replace('\'', "");
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        // 24 rows tell no inertia, but are read: what is refused is the estimate.
        let run = breakaway(folder.path(), &words);
        assert!(!text(&run.stderr).contains("no channel") && !text(&run.stderr).contains("no column"), "{command}");
    }
    let page = breakaway(folder.path(), &["look", "zstd.mcap", "--figure", "f.svg"]);
    assert!(text(&page.stdout).contains("← position") && text(&page.stdout).contains("breakaway identify zstd.mcap"));
    assert!(fs::read_to_string(folder.path().join("f.svg")).unwrap().starts_with("<svg "));
}

fn look_at(rows: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), rows).unwrap();
    json(folder.path(), &["look", "a.csv"])["files"][0].clone()
}

/// Faults are found, with their share, and the exit code is 0 all the same.
#[test]
fn look_says_what_is_wrong() {
    let csv = |row: &dyn Fn(f64) -> (f64, f64)| {
        let rows = (0..4000).map(|k| f64::from(k) * 1e-3).map(|t| (t, row(t)));
        let rows: Vec<String> = rows.map(|(t, (u, x))| format!("{t},{u},{x}")).collect();
        format!("time_s,voltage,angle\n{}\n", rows.join("\n"))
    };
    let kinds = |file: &Value| -> Vec<String> {
        file["faults"].as_array().unwrap().iter().map(|fault| fault["kind"].as_str().unwrap().to_owned()).collect()
    };
    let swing = |t: f64| (3.0 * t).sin();
    // x″ = -9·x: a drive of the acceleration's sign is right, one against it is not.
    assert_eq!(
        kinds(&look_at(&csv(&|t| (-swing(t) + 0.1 * (40.0 * t).sin(), swing(t) - 0.1 / 177.0 * (40.0 * t).sin())))),
        [""; 0]
    );
    let against = look_at(&csv(&|t| (swing(t) - 0.1 * (40.0 * t).sin(), swing(t) - 0.1 / 177.0 * (40.0 * t).sin())));
    assert_eq!(kinds(&against), ["inverted_sign"]);
    let constant = look_at(&csv(&|t| (0.5, swing(t))));
    assert_eq!(kinds(&constant)[0], "no_excitation");
    assert_eq!(constant["faults"][0]["share"], 1.0);
    let still = look_at(&csv(&|t| (swing(t), 0.25)));
    assert_eq!((kinds(&still)[0].as_str(), &still["faults"][0]["share"]), ("no_motion", &Value::from(1.0)), "{still}");
    // It moves for one of four seconds.
    let rest = look_at(&csv(&|t| (-swing(t), if t < 1.0 { (6.3 * t).sin() } else { 6.3_f64.sin() })));
    let share = rest["faults"].as_array().unwrap().iter().find(|f| f["kind"] == "standstill").unwrap();
    assert!((share["share"].as_f64().unwrap() - 0.75).abs() < 0.02, "{share}");
    // An encoder of 12 bits that rolls over: the command has the flag.
    let turns = look_at(&csv(&|t| (-swing(t), (2000.0 + 3000.0 * swing(t)).rem_euclid(4096.0).floor())));
    assert!(turns["command"].as_str().unwrap().contains("--wrap 4096"), "{turns}");
    assert!(turns["hints"][1].as_str().unwrap().contains("--counts-per-turn"), "{turns}");
}

/// A file that is known but not read says what to do; one that is nothing is refused.
#[test]
fn what_is_not_read_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes, says) in [
        ("v73.mat", b"MATLAB 7.3 MAT-file, Platform".as_slice(), "groups and arrays are not whole"),
        ("bag.db3", b"SQLite format 3\0rest", "SQLite does not find its tables whole"),
        ("frames.log", b"(1.0) can0 009#00\n", "--dbc"),
        ("old.bag", b"#ROSBAG V2.0\n", "mcap convert"),
        ("cut.mcap", b"\x89MCAP0\r\n\x01", "no channel `u`"),
        ("cut.npz", b"PK\x03\x04", "table of contents"),
    ] {
        fs::write(folder.path().join(name), bytes).unwrap();
        let run = breakaway(folder.path(), &["identify", name]);
        assert_eq!(run.status.code(), Some(1), "{name}");
        assert!(text(&run.stderr).contains(says), "{name}: {}", text(&run.stderr));
    }
}

/// Position and drive as doubles of 8 bytes, which hold all digits.
const DBC: &str = r#"VERSION ""

NS_ :

BS_:

BU_: drive

BO_ 9 encoder: 8 drive
 SG_ position : 0|64@1- (1,0) [0|0] "rad" Vector__XXX

BO_ 28 motor: 8 drive
 SG_ voltage : 0|64@1- (1,0) [0|0] "V" Vector__XXX

SIG_VALTYPE_ 9 position : 2;
SIG_VALTYPE_ 28 voltage : 2;
"#;

/// Frames of CAN, as candump and as SavvyCAN write them, have the numbers of the first log, bit for bit.
#[test]
fn frames_of_can_are_read_by_their_description() {
    let first = Recording::read(&seed("plain.npz"), &options(None, "u", "x")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("axis.dbc"), DBC).unwrap();
    let mut candump = String::new();
    let mut savvycan = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8\n".to_owned();
    for ((t, u), x) in first.t.iter().zip(&first.u).zip(&first.x) {
        for (id, value) in [(9, x), (28, u)] {
            let bytes = value.to_le_bytes().map(|byte| format!("{byte:02X}"));
            writeln!(candump, "({:.6}) can0 {id:03X}#{}", 1000.0 + t, bytes.concat()).unwrap();
            writeln!(savvycan, "{:.0},{id:08X},false,Rx,0,8,{},", 1e6 * t, bytes.join(",")).unwrap();
        }
    }
    for (name, log) in [("frames.log", candump), ("frames.csv", savvycan)] {
        fs::write(folder.path().join(name), log).unwrap();
        let described = ReadOptions {
            dbc: Some(folder.path().join("axis.dbc")),
            ..options(None, "motor/voltage", "encoder/position")
        };
        let read = Recording::read(&folder.path().join(name), &described).unwrap();
        assert_eq!((&read.u, &read.x), (&first.u, &first.x), "{name}");
        assert_eq!((read.units.u.as_str(), read.units.x.as_str()), ("V", "rad"), "{name}");
        let looked = json(folder.path(), &["look", name, "--dbc", "axis.dbc"]);
        let command = looked["files"][0]["command"].as_str().unwrap();
        assert!(command.contains("--input motor/voltage") && command.contains("--dbc axis.dbc"), "{command}");
    }
    fs::write(folder.path().join("axis.dbc"), "BO_ nonsense").unwrap();
    let refused = breakaway(folder.path(), &["look", "frames.log", "--dbc", "axis.dbc"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("axis.dbc: no description of CAN frames"), "{}", text(&refused.stderr));
}

/// Drive and position of an MCAP's two topics at different rates: the rows are the position's, and it is said.
#[test]
fn channels_of_two_clocks_are_joined_on_the_positions() {
    let bytes = fs::read(seed("json.mcap")).unwrap();
    let mut log = Log::read_from("a.mcap", bytes.as_slice()).unwrap();
    let group = log.groups.iter_mut().find(|group| group.name == "/drive").unwrap();
    let stamps: Vec<f64> = group.stamps_s.take().unwrap().iter().map(|t| t - 0.004).collect();
    group.stamps_s = Some(stamps);
    let read = Recording::from_log("a.mcap", &log, &options(None, "/drive/voltage", "/encoder/position")).unwrap();
    let [Warning::Joined { drive, position }] = read.found.as_slice() else { panic!("{:?}", read.found) };
    assert_eq!((drive.as_str(), position.as_str()), ("/drive/voltage", "/encoder/position"));
    // Six rows of 1, then six of -1: the change comes 4 ms before the row of 10 ms ends, which then has 0.2.
    assert_eq!(read.u[..5], [1.0; 5]);
    assert!((read.u[5] - (0.6 - 0.4)).abs() < 1e-9 && read.u[6] == -1.0, "{:?}", &read.u[..8]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// A log cut anywhere, or with any bytes changed, is read or refused, and nothing else. A stream that was cut has rows.
    #[test]
    fn damaged_logs_are_read_or_refused(which in 0..LOGS.len(), cut in 0.0..1.0_f64, flips in prop::collection::vec((0.0..1.0_f64, any::<u8>()), 0..4)) {
        let (name, time, drive, position) = LOGS[which];
        let mut bytes = fs::read(seed(name)).unwrap();
        let length = bytes.len();
        if cut < 0.5 {
            bytes.truncate((2.0 * cut * length as f64) as usize);
        }
        for (at, value) in flips {
            let at = (at * bytes.len() as f64) as usize;
            if let Some(byte) = bytes.get_mut(at) {
                *byte = value;
            }
        }
        let options = options(time, drive, position);
        if let Ok(read) = Recording::read_from("a.log", bytes.as_slice(), &options) {
            prop_assert!(read.t.len() >= 8 && read.t.len() == read.u.len() && read.t.len() == read.x.len());
            prop_assert!(read.t.windows(2).all(|w| w[0] < w[1]));
        }
        if let Ok(log) = Log::read_from("a.log", bytes.as_slice()) {
            let _ = breakaway::look::look_at("a.log", &log, &ReadOptions::default());
        }
    }
}

/// Streams that were cut in the middle give what was before, and say so.
#[test]
fn a_stream_that_was_cut_gives_what_was_before() {
    for name in ["sysid.wpilog", "motor.ulg", "json.mcap"] {
        let (_, time, drive, position) = LOGS.into_iter().find(|(log, ..)| *log == name).unwrap();
        let bytes = fs::read(seed(name)).unwrap();
        // Not the MCAP's index, which takes its second half.
        let kept = if name == "json.mcap" { bytes.len() * 2 / 5 } else { bytes.len() * 3 / 4 };
        let read = Recording::read_from(name, &bytes[..kept], &options(time, drive, position));
        match read {
            Ok(read) => {
                assert!((8..24).contains(&read.t.len()), "{name}: {}", read.t.len());
                assert!(matches!(read.found[0], Warning::EndsInRecord { .. }), "{name}: {:?}", read.found);
            }
            // The MCAP's one chunk is not whole, so that nothing of it is read.
            Err(error) => assert!(name == "json.mcap" && error.to_string().contains("no channel"), "{name}: {error}"),
        }
    }
}
