//! `cargo xtask bench --peers`: side by side with what people would use instead, into docs/benchmarks.md.
//!
//! Each part leaves a table in `target/peers/`; the page is `bench/peers/page.md` with the tables put in.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::cross::{self, target_folder};
use crate::environment::environment;
use crate::run::{answer, cargo, root, run};
use crate::{budget, qemu};

const PAGE: &str = "docs/benchmarks.md";
const TEMPLATE: &str = "bench/peers/page.md";
/// Seeds of the relay experiments: ten to tune the peer on, forty to compare.
const FRICTION_SEEDS: [&str; 2] = ["801", "850"];
/// Seeds of the blind cases, as `bench/peers/discovery.py` has them.
const BLIND: [&[&str]; 2] =
    [&["--sizes", "10,3", "--seeds", "891..893"], &["--sizes", "10", "--seeds", "1901..1913", "--effects", "none"]];

/// A part of the bench; its table has its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// PySINDy on blind cases (the longest: half an hour)
    Discovery,
    /// PySINDy and ten minutes of least squares on the real machines, beside the rows of docs/machines.csv
    Machines,
    /// scipy's `curve_fit` and IEEE 1057
    Sine,
    /// Least squares on filtered derivatives, and the papers' formulas
    Friction,
    /// scipy's `solve_ivp` and the crate `differential-equations`
    Simulate,
    /// idsp and CMSIS-DSP's PID on the virtual core
    Instructions,
}

const PARTS: [Part; 6] =
    [Part::Sine, Part::Friction, Part::Simulate, Part::Instructions, Part::Machines, Part::Discovery];
/// Methods on the real machines: the head of the column, and the file of rows that `bench/peers/machines.py` writes.
const ON_MACHINES: [(&str, &str); 4] = [
    ("PySINDy, weak form, as tuned on blind sessions", "machines_sindy.csv"),
    ("PySINDy, threshold by held-out data", "machines_sindy_held_out.csv"),
    ("ten minutes of least squares, a fall of 0.1", "machines_least_squares.csv"),
    ("the same, a fall of 0.5", "machines_least_squares_best.csv"),
];

impl Part {
    fn name(self) -> &'static str {
        match self {
            Self::Discovery => "discovery",
            Self::Machines => "machines",
            Self::Sine => "sine",
            Self::Friction => "friction",
            Self::Simulate => "simulate",
            Self::Instructions => "instructions",
        }
    }

    /// What runs on this machine's clock, beside the Python peers; instructions are counted on the virtual board instead.
    fn timed(self) -> Option<fn(&Bench) -> Result<()>> {
        match self {
            Self::Discovery => Some(Bench::discovery),
            Self::Machines => Some(Bench::machines),
            Self::Sine => Some(Bench::sine),
            Self::Friction => Some(Bench::friction),
            Self::Simulate => Some(Bench::simulate),
            Self::Instructions => None,
        }
    }
}

/// Where everything is.
struct Bench {
    python: PathBuf,
    folder: PathBuf,
    programs: PathBuf,
}

/// Runs the parts (all, if none is given) and writes the page, if every part has been run, now or before.
pub fn run_parts(parts: &[Part]) -> Result<()> {
    let parts = if parts.is_empty() { PARTS.as_slice() } else { parts };
    let folder = target_folder().join("peers");
    fs::create_dir_all(&folder)?;
    let timed = parts.iter().any(|part| part.timed().is_some());
    let bench = timed.then(|| Bench::new(folder.clone())).transpose()?;
    for part in parts {
        println!("\n==> {}", part.name());
        match (part.timed(), &bench) {
            (Some(timed), Some(bench)) => timed(bench)?,
            _ => instructions(&folder)?,
        }
    }
    page(&folder)
}

impl Bench {
    /// The peers' Python environment and our programs.
    fn new(folder: PathBuf) -> Result<Self> {
        let requirements = root().join("bench/peers/requirements.txt");
        let python = environment(&target_folder().join("peers-venv"), &requirements)?;
        run(&mut cargo(["build", "--release", "-p", "breakaway-bench", "-p", "breakaway-hidden", "--bins"]))?;
        run(&mut cargo([
            "build",
            "--release",
            "-p",
            "breakaway-tests",
            "--example",
            "blind",
            "--example",
            "machines",
        ]))?;
        Ok(Self { python, folder, programs: target_folder().join("release") })
    }

    /// One of our programs, on one core.
    fn ours(&self, name: &str) -> Command {
        let mut command = Command::new(self.programs.join(name));
        command.env("RAYON_NUM_THREADS", "1").current_dir(root());
        command
    }

    /// One of the peers' scripts, on one core.
    fn script(&self, name: &str) -> Command {
        let mut command = Command::new(&self.python);
        command.arg(root().join("bench/peers").join(name)).current_dir(root());
        command.envs(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"].map(|name| (name, "1")));
        command
    }

    fn discovery(&self) -> Result<()> {
        // Rows that are there already are kept: `rm -r target/peers` begins anew.
        let rows = self.folder.join("ours.csv");
        for cases in BLIND {
            run(self.ours("examples/blind").args(cases).args(["--jobs", "1", "--csv"]).arg(&rows))?;
        }
        let script = |what| {
            let mut command = self.script("discovery.py");
            command.arg(self.programs.join("hidden")).arg(&self.folder).arg(what);
            command
        };
        if !self.folder.join("chosen.json").exists() {
            run(&mut script("tune"))?;
        }
        run(&mut script("run"))?;
        run(&mut script("table"))
    }

    fn machines(&self) -> Result<()> {
        let ours = || self.ours("examples/machines");
        run(ours().arg("--export").arg(self.folder.join("machines")))?;
        run(self.script("machines.py").arg(&self.folder))?;
        let mut compare = ours();
        compare.args(["--compare", &format!("Breakaway={}", super::ROWS)]);
        for (name, file) in ON_MACHINES {
            compare.args(["--compare", &format!("{name}={}", self.folder.join(file).display())]);
        }
        let table = answer(&mut compare).context("the rows cannot be compared")?;
        fs::write(self.folder.join("machines.md"), table)?;
        Ok(())
    }

    fn sine(&self) -> Result<()> {
        run(self.script("sine.py").arg(&self.folder).arg("make"))?;
        run(self.ours("sine").arg(&self.folder))?;
        run(self.script("sine.py").arg(&self.folder).arg("table"))
    }

    fn friction(&self) -> Result<()> {
        run(self.ours("friction").arg(&self.folder).args(FRICTION_SEEDS))?;
        run(self.script("friction.py").arg(&self.folder))
    }

    fn simulate(&self) -> Result<()> {
        run(self.ours("simulate").arg(&self.folder).arg(&self.python))
    }
}

/// Counts on the virtual core: neither Python nor our programs are needed.
fn instructions(folder: &Path) -> Result<()> {
    let qemu = qemu::program()?;
    let toolchain = cross::install()?;
    cross::build(toolchain, &cross::PEERS)?;
    let counted = budget::run(&qemu, &cross::binary(&cross::PEERS, "peers"))?;
    let rows = [
        ("relay", "Breakaway, dual relay on counts (i32)"),
        ("sine_sums", "Breakaway, block phasors of the streaming sine fit (i32)"),
        ("relay_and_sums", "Breakaway, relay and block phasors"),
        ("pid", "Breakaway, PID: filtered derivative, saturation, integral frozen by it (f32)"),
        ("cmsis_pid", "CMSIS-DSP's `arm_pid_f32`, from its documentation: three terms, no limits (f32)"),
        ("idsp_pid_df1", "idsp 0.23, PID as clamped biquad, direct form 1 (f32)"),
        ("idsp_pid_df2t", "idsp 0.23, the same, direct form 2 transposed (f32)"),
    ];
    let ours = counted.get("pid").copied().context("the image counted no PID")?;
    let mut text = String::from("| call | instructions | over our PID |\n|---|---|---|\n");
    for (key, title) in rows {
        let tenths = counted.get(key).with_context(|| format!("the image counted no {key}"))?;
        let ratio = *tenths as f64 / ours as f64;
        writeln!(text, "| {title} | {:.1} | {ratio:.2} |", *tenths as f64 / 10.0)?;
    }
    println!("{text}");
    fs::write(folder.join("instructions.md"), text)?;
    Ok(())
}

/// The page, if every part has left its table.
fn page(folder: &Path) -> Result<()> {
    let mut page = fs::read_to_string(root().join(TEMPLATE)).context(TEMPLATE)?;
    let mut missing = Vec::new();
    for part in PARTS {
        match fs::read_to_string(folder.join(part.name()).with_extension("md")) {
            Ok(table) => page = page.replace(&format!("{{{{{}}}}}", part.name()), table.trim_end()),
            Err(_) => missing.push(part.name()),
        }
    }
    if !missing.is_empty() {
        println!("{PAGE} stays as it is: not run yet: {}", missing.join(", "));
        return Ok(());
    }
    let date = answer(Command::new("date").args(["-u", "+%Y-%m-%d"])).context("date")?;
    page = page.replace("{{date}}", &date).replace("{{machine}}", &machine());
    fs::write(root().join(PAGE), page).context(PAGE)?;
    println!("{PAGE} is written");
    Ok(())
}

/// The processor's own name, and the compiler.
fn machine() -> String {
    let text = fs::read_to_string(Path::new("/proc/cpuinfo")).unwrap_or_default();
    let model = text.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let compiler = answer(Command::new("rustc").arg("--version")).unwrap_or_default();
    format!("{}, one core; {compiler}", model.map_or("an unnamed processor", |(_, name)| name))
}
