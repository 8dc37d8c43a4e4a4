//! `breakaway track --follow`: a reference as it is read.

use std::path::{Path, PathBuf};

use anyhow::Context;
use breakaway_core::link::Message;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Args, board};
use crate::command::UsageError;
use crate::command::output::Output;
use crate::command::port_args;
use crate::command::recording_args::positive;
use crate::control::design::Design;
use crate::device::DeviceError;
use crate::device::capture::Capture;
use crate::device::experiment::{FollowRun, FollowTotals, Runner, pid};
use crate::device::model::to_wire;
use crate::device::set_points;
use crate::file::{FileKind, make_folder};
use crate::interrupt::finish_first;
use crate::model::Model;
use crate::recording::Units;

/// Name of the recording in the folder.
const RECORDING: &str = "follow.csv";

/// Set-points as they come.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Set-points")]
pub struct FollowArgs {
    /// Follow set-points from this file while it is read, on a board; `-` is standard input
    #[arg(long, value_name = "FILE", conflicts_with_all = ["reference", "duration", "settle", "report", "figures"])]
    pub follow: Option<PathBuf>,
    /// Set-points per second: a line is then `position` or `position,velocity`
    #[arg(long, value_name = "HZ", value_parser = positive, requires = "follow")]
    pub rate: Option<f64>,
    /// Who follows [default: model]
    #[arg(long, value_enum, requires = "follow")]
    pub law: Option<Law>,
    /// Set-points that wait on the board before it moves, 1 to 31; more bridge longer pauses of the pipe
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=31))]
    pub ahead: u8,
    /// How long the axis rests at the last set-point where none come, before the run ends, s
    #[arg(long, value_name = "S", default_value_t = 0.5, value_parser = positive)]
    pub hold: f64,
}

/// Who follows.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    /// The PID alone
    Pid,
    /// The PID with the base model compensated
    Base,
    /// The PID with the whole model compensated
    Model,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    source: String,
    law: Law,
    set_points: u64,
    duration_s: f64,
    rms: f64,
    peak: f64,
    rms_steps: f64,
    drive_rms: f64,
    saturated: f64,
    dry: u32,
    missing: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    recording: Option<String>,
    units: Units,
}

/// Follows, prints, records.
///
/// # Errors
/// A file; a line that is no set-point or that the board refuses; whatever board and link report.
pub fn run(args: &Args, source: &Path, port: &str, output: Output) -> anyhow::Result<()> {
    let recording = args.output.as_ref().map(|folder| folder.join(RECORDING));
    if let (Some(folder), Some(file)) = (&args.output, &recording) {
        output.folder(folder, "a folder")?;
        if file.exists() {
            output.may_write(file, FileKind::Recording, &[&args.model, source])?;
        }
    }
    if args.monitor.monitor && source.as_os_str() == "-" {
        let text = "--monitor reads keys from standard input, as --follow - does its set-points: watch with `breakaway \
                    monitor` in another terminal";
        return Err(UsageError(text.to_owned()).into());
    }
    let interrupt = finish_first();
    let model = Model::read(&args.model)?;
    let controller = args.controller.as_deref().map(Design::read).transpose()?;
    let port = &port_args::found(port, args.baud)?;
    let mut runner = Runner::connect(port, args.baud)?;
    port_args::shared(runner.offer(), port);
    let design = board::design(args, &model, controller, &runner)?;
    let law = args.follow.law.unwrap_or(Law::Model);
    let followed = match law {
        Law::Model => model.clone(),
        Law::Pid | Law::Base => Model { effects: Vec::new(), ..model.clone() },
    };
    let wire = to_wire(&followed, &runner.scale)?;
    let run = FollowRun {
        model: &wire,
        compensate: law != Law::Pid,
        controller: pid(&design.gains),
        drive_limit: design.drive_limit,
        ahead: args.follow.ahead,
        hold_s: args.follow.hold,
    };
    let source = set_points::read(source, args.follow.rate).with_context(|| source.display().to_string())?;
    let mut capture = match (&args.output, &recording) {
        (Some(folder), Some(file)) => {
            make_folder(folder)?;
            Some(Capture::create(file, runner.info(), runner.scale.clone(), 1, None)?)
        }
        _ => None,
    };
    let screen = args.monitor.open(port, args.baud)?;
    let result = runner.follow_set_points(&run, &source, &interrupt, &mut |message| {
        if let (Message::Samples(batch), Some(capture)) = (message, &mut capture) {
            capture.push(batch, port)?;
        }
        Ok::<(), DeviceError>(())
    });
    drop(screen);
    let ended = result.as_ref().map_or_else(|error| format!("{error:#}"), |_| "the last set-point".to_owned());
    let kept = capture.map(|capture| capture.finish(&ended)).transpose()?.unwrap_or(false);
    let totals = result?;
    let recording = recording.filter(|_| kept).map(|file| file.display().to_string());
    let document = document(&source.name, law, &totals, &runner, recording);
    output.print(&document, text)
}

fn document(source: &str, law: Law, totals: &FollowTotals, runner: &Runner, recording: Option<String>) -> Document {
    let scale = &runner.scale;
    let samples = totals.samples.max(1) as f64;
    let steps = (totals.squares / samples).sqrt();
    let ticks = totals.ended.map_or(0, |ended| ended.ticks);
    Document {
        source: source.to_owned(),
        law,
        set_points: totals.set_points,
        duration_s: scale.time(ticks.into()),
        rms: steps * scale.step,
        peak: f64::from(totals.peak) * scale.step,
        rms_steps: steps,
        drive_rms: scale.drive(1) * (totals.drive_squares / samples).sqrt(),
        saturated: totals.ended.map_or(0.0, |ended| f64::from(ended.saturated) / f64::from(ended.ticks.max(1))),
        dry: totals.dry,
        missing: totals.missing,
        recording,
        units: scale.units.clone(),
    }
}

fn text(document: &Document) -> String {
    let Document { source, set_points, duration_s, rms, peak, rms_steps, dry, missing, recording, units, .. } =
        document;
    let x = &units.x;
    let followed = format!(
        "{set_points} set-points of {source} followed in {duration_s:.3} s: error rms {rms:.3e} {x} ({rms_steps:.2} encoder \
         steps), peak {peak:.3e} {x}"
    );
    let dry = (*dry > 0).then(|| format!("they ran dry {dry} times, and the axis rested meanwhile"));
    let missing = (*missing > 0).then(|| format!("{missing} samples are missing"));
    let written = recording.as_ref().map(|recording| format!("written to {recording}"));
    let parts: Vec<String> = [Some(followed), dry, missing, written].into_iter().flatten().collect();
    parts.join("; ")
}
