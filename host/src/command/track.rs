//! `breakaway track`.

pub mod board;
pub(in crate::command) mod follow;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context;
use breakaway_core::control::{Controller, Setpoint};
use breakaway_core::link::BAUD;
use schemars::JsonSchema;
use serde::Serialize;

use super::UsageError;
use super::figures::FiguresArgs;
use super::output::Output;
use super::port_args::MonitorArgs;
use super::progress;
use super::recording_args::{not_negative, positive};
use super::tune::TuneArgs;
use crate::control::design::Design;
use crate::control::reference::Reference;
use crate::control::tracking::{Bench, Case, OnBoard, track};
use crate::file::{FileKind, Target, make_folder, write_whole};
use crate::model::Model;
use crate::recording::Units;
use crate::report::tracking;

/// Follow a reference in closed loop, with and without compensation, on the simulated plant or on a board
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway track --model model.toml --reference sine:1,0.25 --report track.html
  breakaway track --model identified.toml --plant true.toml --reference trapezoid:2,4,40 -o runs
  breakaway track --model discovered.toml --port /dev/ttyACM0 --reference sine:1,0.1 --report track.html
  planner | breakaway track --model discovered.toml --port /dev/ttyACM0 --follow -

The controller is the one that runs on the board, in its number type (f32). Four runs are compared. The first has the
PID alone, the second the PID with the base model (b, c, f1) compensated. The third compensates the whole model, if it has
effects, and the fourth is the adaptive law. The simulated plant is --plant, or the model itself. Errors are against the
true position, from --settle on.

A reference from a file must be smooth, because its second difference is the acceleration that is compensated. The
positions of a recorded encoder are not smooth.

On a board (--port) the board's tick, encoder step and limits apply, and errors are against its encoder. It follows a sine,
a trapezoid or an S-curve in the same four runs. The models are loaded for that, and the last one stays loaded until the
board is reset; `breakaway device save` keeps it. Ctrl-C stops the axis.

With --follow the board follows set-points as they are read, with one controller (--law). A line is `time_s,position` or
`time_s,position,velocity`, or with --rate a position alone. The first line is where the axis stands. A missing velocity is
the slope between the neighbours, so the line waits for the next one. Between two lines the reference is a cubic. The board
refuses what leaves its travel or its speed. A pipe may be faster than real time: it waits. If it is too slow, the axis
rests at the last position, and after --hold the run ends.

JSON: reference, plant, tick_s, duration_s, settle_s, runs (name, rms, peak, rms_steps, drive_rms, saturated), improvement (PID
alone over the whole model), units; of a board also missing (samples lost on the way) and mismatches (what its drift watch said: direction of
motion, speed_bin, position_bin, score, below 0 where the missing force resists), each per run. With --follow: source, law, set_points,
duration_s, rms, peak, rms_steps, drive_rms, saturated, dry (how often the set-points ran dry), missing, recording, units.")]
pub struct Args {
    /// The model to compensate and to tune from
    #[arg(long, value_name = "M.toml")]
    pub model: PathBuf,
    /// The controller [default: tuned from the model]
    #[arg(long, value_name = "C.toml")]
    pub controller: Option<PathBuf>,
    /// What to follow: sine:A,HZ, trapezoid:D,V,A[,REST], s_curve:D,V,A,J[,REST] or a FILE.csv
    #[arg(long, value_name = "REF", default_value = "sine:1,0.5")]
    pub reference: String,
    /// Set-points as they come.
    #[command(flatten)]
    pub follow: follow::FollowArgs,
    /// The monitor beside it.
    #[command(flatten)]
    pub monitor: MonitorArgs,
    /// Serial port or pseudo-terminal of a board that follows it, instead of the simulated plant; `auto` is the only one that answers
    #[arg(long, value_name = "PORT", conflicts_with_all = ["plant", "noise", "seed", "tick", "encoder_step"])]
    pub port: Option<String>,
    /// Baud rate of the port
    #[arg(long, value_name = "BAUD", default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(300..))]
    pub baud: u32,
    /// The plant to simulate [default: the model]
    #[arg(long, value_name = "TRUE.toml")]
    pub plant: Option<PathBuf>,
    /// How long to follow, s [default: ten periods, four strokes or the whole file]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub duration: Option<f64>,
    /// Time at the start in which errors are not counted, s [default: a fifth]
    #[arg(long, value_name = "S", value_parser = not_negative)]
    pub settle: Option<f64>,
    /// Standard deviation of the simulated position noise, position units
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = not_negative)]
    pub noise: f64,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for recordings and the figure
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Write the report to this file; `-` is standard output
    #[arg(long, value_name = "R.html")]
    pub report: Option<Target>,
    /// Figures.
    #[command(flatten)]
    pub figures: FiguresArgs,
    /// Tuning, unless a controller is given.
    #[command(flatten)]
    pub tuning: TuneArgs,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    reference: String,
    plant: String,
    tick_s: f64,
    duration_s: f64,
    settle_s: f64,
    runs: Vec<Row>,
    improvement: f64,
    units: Units,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Row {
    name: &'static str,
    rms: f64,
    peak: f64,
    /// In encoder steps; absent without an encoder.
    rms_steps: Option<f64>,
    drive_rms: f64,
    /// Share of the ticks.
    saturated: f64,
    #[serde(flatten)]
    board: Option<OnBoard>,
}

/// What is followed, for how long, from where on it counts.
#[derive(Clone, Debug)]
pub struct Course {
    /// What.
    pub reference: Reference,
    /// The same at each tick.
    pub points: Vec<Setpoint<f32>>,
    /// Time that does not count, s.
    pub settle: f64,
    /// The first sample that does.
    pub from: usize,
}

impl Course {
    /// A reference at a tick of `tick_s` s, of a sensible length and settled after a fifth unless they are given.
    ///
    /// # Errors
    /// A reference that is none; nothing left to count.
    pub fn new(reference: Reference, duration: Option<f64>, settle: Option<f64>, tick_s: f64) -> anyhow::Result<Self> {
        let duration = match duration {
            Some(duration) => duration,
            None => reference.duration_s(tick_s)?,
        };
        let ticks = (duration / tick_s).round();
        anyhow::ensure!(
            ticks <= 1e8,
            "--duration {duration:?} s is more than 10⁸ ticks of {tick_s:?} s: follow for less"
        );
        let ticks = ticks.max(8.0) as usize;
        let points = reference.points::<f32>(tick_s, ticks)?;
        let settle = settle.unwrap_or(0.2 * duration);
        let from = (settle / tick_s).round() as usize;
        anyhow::ensure!(from < ticks, "--settle {settle:?} leaves nothing of the {duration:?} s to count");
        Ok(Self { reference, points, settle, from })
    }
}

/// The axis that followed.
struct Followed<'a> {
    name: &'a str,
    measured: bool,
    units: &'a Units,
    bench: Bench,
}

impl Args {
    /// Tunes, follows, prints, writes recordings and report.
    ///
    /// # Errors
    /// A file that cannot be read or written; a loop that cannot be tuned or diverges.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        self.monitor.check(self.port.as_deref())?;
        if let Some(source) = &self.follow.follow {
            let Some(port) = &self.port else {
                return Err(UsageError(
                    "--follow needs a board (--port PORT); the simulated plant follows a file with --reference FILE.csv"
                        .to_owned(),
                )
                .into());
            };
            return follow::run(&self, source, port, output);
        }
        let output = self.claim(output)?;
        if let Some(port) = &self.port {
            return board::run(&self, port, output);
        }
        let model = Model::read(&self.model)?;
        let plant = self.plant.as_deref().map(Model::read).transpose()?;
        let plant_name =
            self.plant.as_ref().map_or_else(|| "the model itself".into(), |path| path.display().to_string());
        let plant = plant.unwrap_or_else(|| model.clone());
        let design = match &self.controller {
            Some(path) => Design::read(path)?,
            None => Design::new(&model, &self.tuning.request()).with_context(|| self.model.display().to_string())?,
        };
        let course = self.course(design.tick_s)?;
        let bench = Bench {
            tick_s: design.tick_s,
            delay_ticks: design.delay_ticks,
            encoder_step: self.tuning.encoder_step,
            noise: self.noise,
            drive_limit: design.drive_limit,
            seed: self.seed,
        };
        let controllers = controllers(&design, &model)?;
        let bar = progress::bar("loops", controllers.len() as u64);
        let mut cases = Vec::new();
        for (name, title, controller) in controllers {
            let tracked =
                track(&plant, &controller, &course.points, &bench, course.from).with_context(|| title.to_owned())?;
            cases.push(Case { name, title, tracked, board: None });
            bar.inc(1);
        }
        bar.finish_and_clear();
        let axis = Followed { name: &plant_name, measured: false, units: &model.units, bench };
        self.finish(&course, &cases, &axis, output)
    }

    /// Checks what is to be written.
    fn claim(&self, output: Output) -> anyhow::Result<Output> {
        let inputs = self.inputs();
        if let Some(folder) = &self.output {
            let folder = output.folder(folder, "a folder")?;
            let recordings = LAWS.map(|name| (folder.join(format!("{name}.csv")), FileKind::Recording));
            let figure = (folder.join(FIGURE), FileKind::Figure);
            for (path, kind) in recordings.into_iter().chain([figure]).filter(|(path, _)| path.exists()) {
                output.may_write(&path, kind, &inputs)?;
            }
        }
        self.figures.claim(output, &inputs)?;
        let targets: Vec<_> = self.report.iter().map(|target| (target, FileKind::Page)).collect();
        output.claim(&targets, &inputs)
    }

    /// The files that are read.
    fn inputs(&self) -> Vec<&Path> {
        let files = [Some(&self.model), self.controller.as_ref(), self.plant.as_ref()];
        files.into_iter().flatten().map(PathBuf::as_path).chain([Path::new(&self.reference)]).collect()
    }

    /// The reference at a tick of `tick_s` s.
    fn course(&self, tick_s: f64) -> anyhow::Result<Course> {
        Course::new(self.reference.parse()?, self.duration, self.settle, tick_s)
    }

    /// Writes recordings and report, prints.
    fn finish(&self, course: &Course, cases: &[Case], axis: &Followed<'_>, output: Output) -> anyhow::Result<()> {
        let Followed { name, measured, units, ref bench } = *axis;
        let reference = course.reference.to_string();
        let page = tracking::Story { cases, reference: &reference, plant: name, measured, units, bench };
        if let Some(folder) = &self.output {
            write_all(folder, cases, &page)?;
        }
        if let Some(target) = &self.report {
            target.write_text(&tracking::html(&page))?;
        }
        self.figures.write(output, &self.inputs(), || tracking::figures(&page))?;
        let rows = cases.iter().map(|case| row(case, bench)).collect::<Vec<_>>();
        let compensated = cases.iter().rfind(|case| case.name != LAWS[3]).map_or(f64::NAN, |case| case.tracked.rms());
        let document = Document {
            plant: name.to_owned(),
            tick_s: bench.tick_s,
            duration_s: course.points.len() as f64 * bench.tick_s,
            settle_s: course.settle,
            improvement: cases[0].tracked.rms() / compensated,
            runs: rows,
            units: units.clone(),
            reference,
        };
        output.print(&document, |document| table(document, cases, units))
    }
}

fn row(case: &Case, bench: &Bench) -> Row {
    let rms = case.tracked.rms();
    Row {
        name: case.name,
        rms,
        peak: case.tracked.peak(),
        rms_steps: (bench.encoder_step > 0.0).then(|| rms / bench.encoder_step),
        drive_rms: case.tracked.drive_rms(),
        saturated: case.tracked.saturated as f64 / case.tracked.error.len().max(1) as f64,
        board: case.board.clone(),
    }
}

/// Names of the laws that are compared, and of their recordings.
const LAWS: [&str; 4] = ["pid", "base", "model", "adaptive"];
/// Name of the figure beside them.
const FIGURE: &str = "error.svg";

/// The laws that are compared, in the order in which they are shown.
///
/// # Errors
/// What the core refuses.
pub fn controllers(
    design: &Design,
    model: &Model,
) -> anyhow::Result<Vec<(&'static str, &'static str, Controller<f32>)>> {
    let effects = model.plant_effects()?;
    let pid = Design { adaptive: false, compensate: false, ..design.clone() };
    let compensated = Design { compensate: true, ..pid.clone() };
    let mut all = vec![
        (LAWS[0], "PID alone", pid.controller_for(&model.base, &[])?),
        (LAWS[1], "base model compensated", compensated.controller_for(&model.base, &[])?),
    ];
    if !effects.is_empty() {
        all.push((LAWS[2], "whole model compensated", compensated.controller_for(&model.base, &effects)?));
    }
    let adaptive = Design { adaptive: true, ..compensated };
    all.push((LAWS[3], "adaptive law", adaptive.controller_for(&model.base, &effects)?));
    Ok(all)
}

fn write_all(folder: &Path, cases: &[Case], story: &tracking::Story<'_>) -> anyhow::Result<()> {
    make_folder(folder)?;
    for case in cases {
        case.tracked.recording.write(&folder.join(format!("{}.csv", case.name)))?;
    }
    let path = folder.join(FIGURE);
    let figure = tracking::errors(story).file();
    write_whole(&path, |out| out.write_all(figure.as_bytes()))
        .with_context(|| format!("cannot write the figure {}", path.display()))
}

fn table(document: &Document, cases: &[Case], units: &Units) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{} on {} for {:.4} s at a tick of {} s; errors from {:.4} s on, in {}:",
        document.reference, document.plant, document.duration_s, document.tick_s, document.settle_s, units.x
    );
    let _ = writeln!(text, "{:<26}{:>12}{:>12}{:>14}{:>12}", "", "rms", "peak", "encoder steps", "saturated");
    for (row, case) in document.runs.iter().zip(cases) {
        let steps = row.rms_steps.map_or_else(|| "–".into(), |steps| format!("{steps:.2}"));
        let _ = writeln!(
            text,
            "{:<26}{:>12.3e}{:>12.3e}{steps:>14}{:>10.1} %",
            case.title,
            row.rms,
            row.peak,
            100.0 * row.saturated
        );
        if let Some(OnBoard { missing, mismatches }) = &case.board {
            if *missing > 0 {
                let _ = writeln!(text, "  {missing} samples are missing");
            }
            for mismatch in mismatches {
                let _ = writeln!(text, "  {}", crate::device::text::mismatch(mismatch));
            }
        }
    }
    let _ = writeln!(text, "compensation divides the rms of the PID alone by {:.1}", document.improvement);
    text
}
