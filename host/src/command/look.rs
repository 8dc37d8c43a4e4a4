//! `breakaway look`.

use std::path::PathBuf;

use serde::Serialize;

#[cfg(feature = "command")]
use super::UsageError;
use super::figures::FiguresArgs;
#[cfg(feature = "command")]
use super::figures::{kind_of, write_one};
#[cfg(feature = "command")]
use super::output::Output;
use super::recording_args::RecordingArgs;
use crate::file::Target;
#[cfg(feature = "command")]
use crate::file::shown;
#[cfg(feature = "command")]
use crate::look::look;
use crate::look::{Fault, Guess, Look, Summary};
use crate::recording::formats::Format;
use crate::report::look as report;

/// List what is in a log, guess time, drive and position, say what is wrong, print the command to identify
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway look robot.mcap
  breakaway look session/*.csv --json
  breakaway look bench.npz --position theta --figure bench.svg
  breakaway look session/*.csv --figures figures

Formats: CSV, MCAP, WPILOG, ULog, npz and npy, MAT, HDF5, Parquet, bags of ROS 2, CAN logs; each packed by gzip or not. The first bytes of a
file tell its format. What a flag names is not guessed. The exit code is 0 also where faults are found.

JSON: version, files (file, format, channels (name, unit, rows, rate_hz, range, texts), time, drive, position (channel,
reason; null where none was found), stamped (by the file itself), faults (kind, share, text), hints, passed_over, command).")]
pub struct Args {
    /// Logs of any format
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Draw drive and position of one file, as SVG, or as what the name ends in: `.png`, `.csv`; `-` is standard output
    #[arg(long, value_name = "F.svg")]
    pub figure: Option<Target>,
    /// Figures.
    #[command(flatten)]
    pub figures: FiguresArgs,
    /// Columns and rows.
    #[command(flatten)]
    pub columns: RecordingArgs,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
struct ChannelJson<'a> {
    name: &'a str,
    unit: Option<&'a str>,
    rows: usize,
    rate_hz: Option<f64>,
    range: Option<(f64, f64)>,
    texts: &'a [String],
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
struct GuessJson<'a> {
    channel: &'a str,
    reason: &'a str,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
struct FileJson<'a> {
    file: &'a str,
    format: Format,
    channels: Vec<ChannelJson<'a>>,
    time: Option<GuessJson<'a>>,
    stamped: bool,
    drive: Option<GuessJson<'a>>,
    position: Option<GuessJson<'a>>,
    faults: &'a [Fault],
    hints: &'a [String],
    passed_over: &'a [String],
    command: Option<String>,
}

/// The JSON document.
#[derive(Debug, Serialize, schemars::JsonSchema)]
pub struct Document<'a> {
    version: &'static str,
    files: Vec<FileJson<'a>>,
}

impl<'a> From<&'a Summary> for ChannelJson<'a> {
    fn from(channel: &'a Summary) -> Self {
        let Summary { name, unit, rows, rate_hz, range, texts, .. } = channel;
        Self { name, unit: unit.as_deref(), rows: *rows, rate_hz: *rate_hz, range: *range, texts }
    }
}

impl<'a> From<&'a Look> for FileJson<'a> {
    fn from(look: &'a Look) -> Self {
        let guess = |guess: &'a Option<Guess>| {
            guess.as_ref().map(|guess| GuessJson { channel: &guess.channel, reason: &guess.reason })
        };
        Self {
            file: &look.file,
            format: look.format,
            channels: look.channels.iter().map(ChannelJson::from).collect(),
            time: guess(&look.guesses.time),
            stamped: look.guesses.stamped,
            drive: guess(&look.guesses.drive),
            position: guess(&look.guesses.position),
            faults: &look.faults,
            hints: &look.hints,
            passed_over: &look.passed_over,
            command: report::command(look),
        }
    }
}

impl<'a> Document<'a> {
    /// Of what was seen in each file.
    pub fn new(looks: &'a [Look]) -> Self {
        Self { version: env!("CARGO_PKG_VERSION"), files: looks.iter().map(FileJson::from).collect() }
    }
}

#[cfg(feature = "command")]
impl Args {
    /// Looks at each file and prints what it saw.
    ///
    /// # Errors
    /// A file that cannot be read as a log at all, or a figure that cannot be written.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let inputs: Vec<_> = self.files.iter().map(PathBuf::as_path).collect();
        let targets: Vec<_> = self.figure.iter().map(|target| (target, kind_of(target))).collect();
        let output = output.claim(&targets, &inputs)?;
        if self.figure.is_some() && self.files.len() > 1 {
            return Err(UsageError("--figure draws one file; give one, or --figures DIR".to_owned()).into());
        }
        self.figures.claim(output, &inputs)?;
        let mut looks = Vec::new();
        for path in &self.files {
            looks.push(look(path, &shown(path), &self.columns.options())?);
        }
        if let (Some(target), Some(look)) = (&self.figure, looks.first()) {
            let Some(recording) = &look.recording else {
                let why = look.faults.first().map_or("", |fault| fault.text.as_str());
                return Err(anyhow::anyhow!("{}: there is nothing to draw: {why}", look.file));
            };
            write_one(target, &report::figure(look, recording))?;
        }
        // A file without a drive or a position has nothing to draw, and its faults say so.
        let drawn = |look: &Look| look.recording.as_ref().map(|recording| report::figure(look, recording));
        self.figures.write(output, &inputs, || looks.iter().filter_map(drawn).collect())?;
        output.print(&Document::new(&looks), |_| looks.iter().map(report::page).collect::<Vec<_>>().join("\n"))
    }
}
