//! Time and memory of `breakaway identify` and `breakaway discover` from ten seconds to an hour and from 1 to 64 recordings:
//! `scale BREAKAWAY DOCS` writes `DOCS/scale.md` and its figures.
//!
//! Every point is a process of its own on files of its own, as a user runs it: reading the CSV counts.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use breakaway::file::write_whole;
use breakaway::recording::Units;
use breakaway::report::figure::{Figure, Ink, Series, Strip, stack_over};
use breakaway::simulate::axis::Axis;
use breakaway::simulate::experiment::{Excitation, Experiment, Sensor};
use breakaway_core::plant::{Base, Effect, Kind};
use breakaway_tests::markdown::wrapped;

/// The papers' plant (docs/theory.md, section 1), and what its model will miss.
const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const HIDDEN: (Kind, [f64; 2]) = (Kind::Stribeck, [0.2, 0.5]);
/// Lengths of a single recording, s, and numbers of recordings of [`EACH_S`].
const LENGTHS_S: [f64; 6] = [10.0, 40.0, 160.0, 640.0, 1800.0, 3600.0];
const COUNTS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];
const EACH_S: f64 = 10.0;
/// How often the memory of the process is looked at; its peak is kept by the kernel, so nothing falls between.
const LOOK: Duration = Duration::from_millis(20);

/// What one command took.
#[derive(Clone, Copy)]
struct Cost {
    seconds: f64,
    peak_mb: f64,
}

/// One point of a curve.
struct Point {
    x: f64,
    file_mb: f64,
    identify: Cost,
    discover: Cost,
    said: String,
}

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [program, docs] = arguments.as_slice() else { bail!("usage: scale BREAKAWAY DOCS") };
    let folder = std::env::temp_dir().join(format!("breakaway-scale-{}", std::process::id()));
    let lengths = LENGTHS_S.iter().map(|length_s| point(program, &folder, *length_s, &[*length_s]));
    let lengths: Vec<Point> = lengths.collect::<Result<_>>()?;
    let counts = COUNTS.iter().map(|count| point(program, &folder, *count as f64, &vec![EACH_S; *count]));
    let counts: Vec<Point> = counts.collect::<Result<_>>()?;
    let figures = [
        ("scale-length", figure("From ten seconds to an hour", ("length of the recording", "s"), &lengths)),
        ("scale-count", figure("From 1 to 64 recordings", ("recordings of 10 s", ""), &counts)),
    ];
    for (name, figure) in &figures {
        write_whole(&docs.join(format!("images/{name}.svg")), |out| out.write_all(figure.file().as_bytes()))?;
    }
    write_whole(&docs.join("scale.md"), |out| out.write_all(wrapped(&page(&lengths, &counts)).as_bytes()))?;
    Ok(())
}

/// Writes recordings of the given lengths, and runs both commands on them.
fn point(program: &Path, folder: &Path, x: f64, lengths_s: &[f64]) -> Result<Point> {
    fs::create_dir_all(folder)?;
    let mut files = Vec::new();
    for (seed, length_s) in lengths_s.iter().enumerate() {
        let file = folder.join(format!("multisine{seed}.csv"));
        let experiment = Experiment {
            name: format!("multisine{seed}"),
            tick_s: 1e-3,
            duration_s: *length_s,
            seed: seed as u64 + 1,
            drive_limit: 10.0,
            travel_limit: f64::INFINITY,
            excitation: Excitation::Multisine { amplitude: 3.0, from_hz: 0.25, to_hz: 16.0, centring: 1.0 },
            sensor: Sensor { noise: 5e-4, ..Sensor::default() },
        };
        let effects = [Effect::new(HIDDEN.0, &HIDDEN.1)];
        let run = Axis::new(BASE, &effects, Units::default()).run(&experiment).map_err(|e| anyhow::anyhow!("{e}"))?;
        run.recording.write(&file)?;
        files.push(file);
    }
    let bytes = files.iter().map(|file| fs::metadata(file).map(|m| m.len())).sum::<std::io::Result<u64>>()?;
    let (identify, _) = cost(folder, Command::new(program).args(["identify", "--json"]).args(&files))?;
    let (discover, answer) = cost(folder, Command::new(program).args(["discover", "--json"]).args(&files))?;
    fs::remove_dir_all(folder)?;
    let sentence = answer.lines().find_map(|line| line.trim().strip_prefix("\"sentence\": \"")).unwrap_or("");
    let said = sentence.split(". ").next().unwrap_or("").to_owned();
    println!(
        "{x}: identify {:.2} s, discover {:.2} s, {:.0} MB; {said}",
        identify.seconds, discover.seconds, discover.peak_mb
    );
    Ok(Point { x, file_mb: bytes as f64 / 1e6, identify, discover, said })
}

/// Runs a command to its end; its time, its largest memory, and what it printed.
fn cost(folder: &Path, command: &mut Command) -> Result<(Cost, String)> {
    let output = folder.join("answer.json");
    let began = Instant::now();
    let mut child = command.stdout(fs::File::create(&output)?).stderr(Stdio::null()).spawn().context("breakaway")?;
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut peak_mb = 0.0f64;
    let ended = loop {
        peak_mb = peak_mb.max(high_water_mb(&status).unwrap_or(0.0));
        if let Some(ended) = child.try_wait()? {
            break ended;
        }
        sleep(LOOK);
    };
    let seconds = began.elapsed().as_secs_f64();
    let answer = fs::read_to_string(&output)?;
    if !ended.success() {
        bail!("{command:?} ended with {ended}");
    }
    Ok((Cost { seconds, peak_mb }, answer))
}

/// Peak resident memory of a process so far, as Linux keeps it.
fn high_water_mb(status: &Path) -> Option<f64> {
    let text = fs::read_to_string(status).ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kb| kb / 1024.0)
}

fn figure(title: &str, along: (&'static str, &'static str), points: &[Point]) -> Figure {
    let column = |value: fn(&Point) -> f64| points.iter().map(value).collect::<Vec<f64>>();
    let x = column(|p| p.x);
    let (identify, discover) = (column(|p| p.identify.seconds), column(|p| p.discover.seconds));
    let (identify_mb, discover_mb) = (column(|p| p.identify.peak_mb), column(|p| p.discover.peak_mb));
    let strip = |quantity, unit, discover, identify| Strip {
        quantity,
        unit,
        height: 150.0,
        series: vec![
            Series { ink: Ink::After, label: "discover", y: discover },
            Series { ink: Ink::Before, label: "identify", y: identify },
        ],
        band: None,
        held: false,
    };
    let strips = [strip("time", "s", &discover, &identify), strip("memory", "MB", &discover_mb, &identify_mb)];
    Figure::new(title, "Time and peak memory.", |width| stack_over(width, along, &x, &strips))
}

fn page(lengths: &[Point], counts: &[Point]) -> String {
    let mut out = String::from(
        "# Scale

Written by `cargo xtask bench --scale`. The recordings are multisines at 1 kHz of the papers' plant with Stribeck friction, in CSV files.
Every point is a process of its own. Discovery simulates at most 120 segments to fit and 80 to score, taken evenly over the session,
and its report says so. The judge of the forces takes stretches of together 100 000 samples, evenly over the session. Beyond some
minutes of data the time therefore grows with reading and smoothing alone, and so does the memory.

## One recording

![time and memory over the length of a recording](images/scale-length.svg)

",
    );
    table(&mut out, "length, s", lengths);
    out.push_str(
        "\n## Many recordings of 10 s\n\n![time and memory over the number of recordings](images/scale-count.svg)\n\n",
    );
    table(&mut out, "recordings", counts);
    out
}

fn table(out: &mut String, first: &str, points: &[Point]) {
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "| {first} | files, MB | identify, s | identify, MB | discover, s | discover, MB | discover said |\n|---|---|---|---|---|---|---|"
    );
    for p in points {
        let _ = writeln!(
            out,
            "| {} | {:.1} | {:.2} | {:.0} | {:.2} | {:.0} | {} |",
            p.x, p.file_mb, p.identify.seconds, p.identify.peak_mb, p.discover.seconds, p.discover.peak_mb, p.said
        );
    }
}
