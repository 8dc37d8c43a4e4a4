//! `cargo xtask logs-test`: a measured recording, written in every format by the format's own package, gives the same model.
//!
//! The packages write by tests/logs/write_logs.py. The recording is the first seconds of EMPS, from `../shared/data` beside
//! the project, or from `BREAKAWAY_DATA`. It is copied to the target folder, not into the project.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::cross::target_folder;
use crate::environment::environment;
use crate::run::{cargo, root, run};

/// Rows of the recording: eight seconds.
const ROWS: usize = 8000;
/// The logs with the flags that name their columns, and how far a parameter may be off, in itself. Where the stamps are those of
/// the CSV file, nothing differs. Stamps in µs or since 1970 are rounded by up to 0.5 µs of 1 ms.
const LOGS: [(&str, &str, f64); 22] = [
    ("plain.npz", "", 0.0),
    ("packed.npz", "", 0.0),
    ("records.npy", "--time array.t --input array.u --position array.x", 0.0),
    ("v5.mat", "", 0.0),
    ("v7.mat", "--time log.t --input log.u --position log.x", 0.0),
    ("snappy.parquet", "", 0.0),
    ("gzip.parquet", "", 0.0),
    ("stamps.parquet", "--time time", 1e-6),
    ("sysid.wpilog", "--input voltage-motor-drive --position position-motor-drive", 1e-4),
    ("zstd.mcap", "--time header/stamp --input axis/effort --position axis/position", 1e-6),
    ("lz4.mcap", "--time header/stamp --input axis/effort --position axis/position", 1e-6),
    ("json.mcap", "--input /drive/voltage --position /encoder/position", 1e-6),
    ("protobuf.mcap", "--input axis/voltage --position axis/position", 1e-6),
    ("motor.ulg", "--input motor/u --position motor/x", 1e-4),
    ("split.csv", "--input effort[0] --position position[1]", 1e-6),
    ("comma.csv", "--time Zeit_ms", 1e-6),
    ("dates.csv", "--time time", 1e-4),
    ("zstd.parquet", "", 0.0),
    ("v73.mat", "--time log.t --input log.u --position log.x", 0.0),
    ("bag.db3", "--time header/stamp --input axis/effort --position axis/position", 1e-6),
    ("humble.db3", "--time header/stamp --input axis/effort --position axis/position", 1e-6),
    ("can.log", "--dbc can.dbc --input axis/voltage --position axis/position", 1e-6),
];

/// The flag of the file that says what frames hold. `look` needs it too.
const DESCRIPTION: &str = "--dbc";

/// Runs it all.
pub fn test() -> Result<()> {
    let folder = target_folder().join("logs-test");
    let python = environment(&target_folder().join("logs-venv"), &root().join("tests/logs/requirements.txt"))?;
    run(&mut cargo(["build", "--package", "breakaway"]))?;
    let breakaway = target_folder().join("debug").join(format!("breakaway{}", std::env::consts::EXE_SUFFIX));
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    fs::create_dir_all(&folder)?;
    let recording = folder.join("recording.csv");
    cut(&data().join("emps/emps_train.csv"), &recording)?;
    let mut write = Command::new(&python);
    run(write.arg(root().join("tests/logs/write_logs.py")).arg(&recording).arg(&folder))?;
    // In their folder the logs, and a description beside one, have names without a blank.
    let program = || {
        let mut program = Command::new(&breakaway);
        program.current_dir(&folder);
        program
    };
    let identified = |log: &str, flags: &str| -> Result<BTreeMap<String, f64>> {
        numbers(&json(program().args(["identify", log]).args(flags.split_whitespace()).arg("--json"))?)
    };
    let looked = |log: &str, flags: &str| {
        let description = flags.split_whitespace().take(if flags.starts_with(DESCRIPTION) { 2 } else { 0 });
        json(program().args(["look", log]).args(description).arg("--json"))
    };
    let wanted = identified("recording.csv", "")?;
    for (log, flags, tolerance) in LOGS {
        let found = identified(log, flags)?;
        for (name, value) in &wanted {
            let off = (found[name] / value - 1.0).abs();
            ensure!(off <= tolerance, "{log}: {name} is {} and not {value}, off by {off:e}", found[name]);
        }
        // The one command that `look` prints does the same.
        let looked = looked(log, flags)?;
        let command = looked["files"][0]["command"].as_str().with_context(|| format!("{log}: no command"))?;
        let words = command.split_whitespace().skip(3).collect::<Vec<_>>().join(" ").replace('\'', "");
        let again = identified(log, &words)?;
        ensure!(again == found, "{log}: `{command}` gives {again:?}, and not {found:?}");
        println!("{log}: {}", listed(&found));
    }
    let frames = serde_json::from_slice(&fs::read(folder.join("can.json"))?)?;
    let signals = compared(&frames, &looked("can.log", "--dbc can.dbc")?)?;
    ensure!(signals == 6, "{signals} signals were compared");
    println!("can.log: {signals} signals have the rows and the range that cantools decodes");
    let log = data().join("logs/px4_sample_log_small.ulg");
    let peer = json(Command::new(&python).arg(root().join("tests/logs/read_ulog.py")).arg(&log))?;
    let channels = compared(&peer, &json(Command::new(&breakaway).arg("look").arg(&log).arg("--json"))?)?;
    ensure!(channels > 500, "only {channels} channels were compared");
    println!("px4_sample_log_small.ulg: {channels} channels have the rows and the range that pyulog reads");
    println!("logs-test: {} files, each with the numbers of the CSV file: {}", LOGS.len(), listed(&wanted));
    Ok(())
}

/// Where the recordings are.
fn data() -> PathBuf {
    std::env::var_os("BREAKAWAY_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from)
}

/// Copies the first rows of a recording, with the columns t, u and x.
fn cut(from: &Path, to: &Path) -> Result<()> {
    let text = fs::read_to_string(from).with_context(|| format!("{}: set BREAKAWAY_DATA", from.display()))?;
    let mut out = "t,u,x\n".to_owned();
    for line in text.lines().skip(1).take(ROWS) {
        let fields: Vec<&str> = line.split(',').take(3).collect();
        let _ = writeln!(out, "{}", fields.join(","));
    }
    fs::write(to, out).with_context(|| to.display().to_string())
}

/// The JSON document of a command that must succeed.
fn json(command: &mut Command) -> Result<Value> {
    let done = command.output()?;
    ensure!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    Ok(serde_json::from_slice(&done.stdout)?)
}

/// The parameters of a document.
fn numbers(document: &Value) -> Result<BTreeMap<String, f64>> {
    let one = |name: &&str| {
        let value = document[name]["value"].as_f64().with_context(|| format!("{name} is missing"))?;
        Ok(((*name).to_owned(), value))
    };
    ["b", "c", "f1"].iter().map(one).collect()
}

fn listed(numbers: &BTreeMap<String, f64>) -> String {
    numbers.iter().map(|(name, value)| format!("{name} {value:.6}")).collect::<Vec<_>>().join(", ")
}

/// How many channels of a log were compared. Of those that another package reads, `look` lists each, with as many rows
/// and the same range.
fn compared(peer: &Value, looked: &Value) -> Result<usize> {
    let channels = looked["files"][0]["channels"].as_array().context("no channels")?;
    let own: BTreeMap<&str, &Value> = channels.iter().filter_map(|c| Some((c["name"].as_str()?, c))).collect();
    let mut compared = 0;
    for (name, peer) in peer.as_object().context("no channels of the other package")? {
        let Some(own) = own.get(name.as_str()) else {
            ensure!(name.contains("_padding"), "{name} is not listed");
            continue;
        };
        if let (Some(low), Some(high)) = (peer[1].as_f64(), peer[2].as_f64()) {
            ensure!(own["rows"] == peer[0], "{name}: {} rows, the other package has {}", own["rows"], peer[0]);
            ensure!(
                own["range"][0].as_f64() == Some(low) && own["range"][1].as_f64() == Some(high),
                "{name}: {own} {peer}"
            );
            compared += 1;
        }
    }
    Ok(compared)
}
