//! `breakaway run`.

mod folder;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context;
use breakaway_core::link::{self, BAUD, Limit};
use breakaway_core::plant::Base;
use schemars::JsonSchema;
use serde::Serialize;

use super::output::Output;
use super::port_args::{self, MonitorArgs};
use super::progress;
use super::recording_args::positive;
use crate::device::experiment::{Outcome, Runner};
use crate::device::text;
use crate::file::{inside, make_folder};
use crate::identify::relay::{self, RelayReport};
use crate::interrupt::finish_first;
use crate::model::{BaseSe, Model};
use crate::recording::{Container, Units};
use crate::simulate::axis::Axis;
use crate::simulate::experiment::{Experiment, Sensor};
use crate::simulate::suite::{self, Machine, Role};

/// Run an experiment, or the standard suite, on the simulated plant or on a board
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway run suite --model model.toml -o session
  breakaway run relay.toml -o session
  breakaway run suite --port /dev/ttyACM0 -o session
  breakaway run relay.toml --format mcap -o session

Without --model it simulates the reference plant of docs/theory.md, section 2: b = 0.02685 V·s²/rad, c = 0.11 V·s/rad, f1 = 0.5 V. The suite finds
the break-away force first and sizes itself; recordings to fit go to DIR/fit, those to score to DIR/score. A folder
that holds a session already is refused; --force replaces that session.

On a board (--port) the board's tick, encoder step and limits apply, and a multisine consists of the multiples of from_hz.
Ctrl-C stops the axis. `breakaway monitor` in another terminal watches, --monitor shows the same in this one, and
`breakaway device stop` stops the axis from anywhere. If the board is lost, what was recorded until then is kept. Samples that are lost on the way are
cut out and counted (missing).

JSON: breakaway (of a suite), recordings (file, role, samples, ending; on a board also missing). A relay run ends settled, asymmetric (period_s,
omega, amplitude, bias, mean_drive, cycles, tolerance), no_limit_cycle (reason), timeout (cycles, last_change), limit_tripped
(limit, value), or not_judged (reason: the reference moves); ending.kind says which.")]
pub struct Args {
    /// An experiment file, or `suite`
    #[arg(value_name = "EXPERIMENT")]
    pub experiment: String,
    /// The plant to simulate [default: the reference plant, docs/theory.md section 2]
    #[arg(long, value_name = "M.toml", conflicts_with = "port")]
    pub model: Option<PathBuf>,
    /// Serial port or pseudo-terminal of a board to run on, instead of the simulated plant; `auto` is the only one that answers
    #[arg(long, value_name = "PORT")]
    pub port: Option<String>,
    /// The monitor beside it.
    #[command(flatten)]
    pub monitor: MonitorArgs,
    /// Baud rate of the port
    #[arg(long, value_name = "BAUD", default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(300..))]
    pub baud: u32,
    /// Folder for the recordings
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Form of the recordings
    #[arg(long, value_enum, default_value_t)]
    pub format: Container,
    /// Suite: largest drive, drive units
    #[arg(long, value_name = "U", default_value_t = 5.0, value_parser = positive)]
    pub drive_limit: f64,
    /// Suite: half of the travel, position units
    #[arg(long, value_name = "X", default_value_t = 5.0, value_parser = positive)]
    pub travel: f64,
    /// Suite: encoder step of the simulated axis, position units
    #[arg(long, value_name = "X", default_value_t = 0.001, value_parser = positive)]
    pub encoder_step: f64,
    /// Suite: standard deviation of the position noise, position units
    #[arg(long, value_name = "X", default_value_t = 0.0005, value_parser = positive)]
    pub noise: f64,
    /// Suite: control tick, s
    #[arg(long, value_name = "S", default_value_t = 0.001, value_parser = positive)]
    pub tick: f64,
    /// Suite: seed of noise and phases
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// The papers' plant, Gp = 10/(s(0.2685s + 1)), f1 = 0.5, f2 = 0.01 lumped into c (docs/theory.md, section 1).
pub fn papers_plant() -> Model {
    Model {
        base: Base { b: 0.02685, c: 0.11, f1: 0.5 },
        base_se: BaseSe::default(),
        units: Units { u: "V".into(), x: "rad".into() },
        effects: Vec::new(),
        provenance: vec!["the plant of the papers".into()],
    }
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    breakaway: Option<f64>,
    recordings: Vec<Entry>,
    #[serde(skip)]
    units: Units,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Entry {
    file: String,
    role: &'static str,
    samples: usize,
    ending: Option<RelayReport>,
    /// Samples lost between board and host.
    #[serde(skip_serializing_if = "Option::is_none")]
    missing: Option<u64>,
}

impl Args {
    /// Runs, and writes every recording whole.
    ///
    /// # Errors
    /// A file that cannot be read or written; an experiment or a plant that cannot be simulated.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let file = (self.experiment != "suite").then(|| self.named()).transpose()?;
        self.claim(file.as_ref(), output)?;
        self.monitor.check(self.port.as_deref())?;
        if let Some(port) = self.port.clone() {
            return self.run_on_board(&port, file, output);
        }
        let model = self.model.as_deref().map(Model::read).transpose()?.unwrap_or_else(papers_plant);
        let mut axis = Axis::new(model.base, &model.plant_effects()?, model.units.clone());
        let mut breakaway = None;
        let experiments = if let Some(experiment) = file {
            vec![(Role::Fit, experiment)]
        } else {
            let machine = self.machine();
            let found = suite::breakaway(&axis, &machine)?;
            breakaway = Some(found.force);
            self.clear()?;
            suite::suite(found.moved_at, &machine)
        };
        let bar = progress::bar("experiments", experiments.len() as u64);
        let mut recordings = Vec::new();
        for (role, experiment) in experiments {
            let run = axis.run(&experiment).with_context(|| experiment.name.clone())?;
            let (file, role) = self.place(breakaway.is_some(), role, &experiment.name)?;
            run.recording.write(&file)?;
            recordings.push(Entry {
                file: file.display().to_string(),
                role,
                samples: run.recording.t.len(),
                // The suite knows the axis by its break-away force only, as on a machine.
                ending: relay::ending(&run, &experiment, Some(breakaway.unwrap_or(model.base.f1))),
                missing: None,
            });
            bar.inc(1);
        }
        bar.finish_and_clear();
        output.print(&Document { breakaway, recordings, units: model.units }, table)
    }

    /// The experiment of a file.
    fn named(&self) -> anyhow::Result<Experiment> {
        let path: &Path = self.experiment.as_ref();
        anyhow::ensure!(
            path.exists(),
            "{}: no such file; EXPERIMENT is a TOML file, or the word `suite` for the standard experiments",
            path.display()
        );
        Ok(Experiment::read(path)?)
    }

    /// The file of a recording, and its role; the folder is made.
    fn place(&self, suite: bool, role: Role, name: &str) -> anyhow::Result<(PathBuf, &'static str)> {
        let (folder, role) = match (suite, role) {
            (false, _) => (self.output.clone(), "fit"),
            (true, Role::Fit) => (self.output.join("fit"), "fit"),
            (true, Role::Score) => (self.output.join("score"), "score"),
        };
        make_folder(&folder)?;
        Ok((inside(&folder, name, self.format.ending())?, role))
    }

    fn run_on_board(self, port: &str, file: Option<Experiment>, output: Output) -> anyhow::Result<()> {
        let interrupt = finish_first();
        let port = &port_args::found(port, self.baud)?;
        let mut runner = Runner::connect(port, self.baud)?;
        port_args::shared(runner.offer(), port);
        let screen = self.monitor.open(port, self.baud)?;
        let units = runner.scale.units.clone();
        let mut breakaway = None;
        let experiments = if let Some(experiment) = file {
            vec![(Role::Fit, experiment)]
        } else {
            let machine = self.machine_of_board(&runner);
            let spinner = progress::spinner();
            spinner.set_message("finding the break-away force");
            let found = suite::breakaway_by(&machine, |ramp| {
                let outcome = runner.run(ramp, &interrupt)?;
                outcome.error.map_or(Ok(outcome.run), Err)
            });
            spinner.finish_and_clear();
            let found = found?;
            breakaway = Some(found.force);
            self.clear()?;
            suite::suite(found.moved_at, &machine)
        };
        let bar = progress::bar("experiments", experiments.len() as u64);
        let mut recordings = Vec::new();
        for (role, experiment) in experiments {
            let outcome = runner.run(&experiment, &interrupt).with_context(|| experiment.name.clone())?;
            let (file, role) = self.place(breakaway.is_some(), role, &experiment.name)?;
            outcome.run.recording.write(&file)?;
            let samples = outcome.run.recording.t.len();
            if let Some(error) = outcome.error {
                let saved =
                    format!("the {samples} samples of {} until then are in {}", experiment.name, file.display());
                return Err(anyhow::Error::new(error).context(saved));
            }
            recordings.push(Entry {
                file: file.display().to_string(),
                role,
                samples,
                ending: board_ending(&outcome, breakaway),
                missing: Some(outcome.missing),
            });
            bar.inc(1);
        }
        bar.finish_and_clear();
        drop(screen);
        output.print(&Document { breakaway, recordings, units }, table)
    }

    /// The machine as the board allows it.
    fn machine_of_board(&self, runner: &Runner) -> Machine {
        let Runner { scale, settings, .. } = runner;
        let travel = f64::from(settings.travel_max_counts.saturating_sub(settings.travel_min_counts)) * scale.step;
        Machine {
            drive_limit: self.drive_limit.min(scale.drive(settings.drive_max_code.into())),
            // A quarter of the whole leaves the cycle room around a reference that reaches half of it.
            travel: self.travel.min(0.25 * travel),
            tick_s: scale.tick_s(),
            sensor: Sensor { encoder_step: scale.step, noise: 0.0, delay_ticks: 0 },
            seed: self.seed,
        }
    }

    fn machine(&self) -> Machine {
        Machine {
            drive_limit: self.drive_limit,
            travel: self.travel,
            tick_s: self.tick,
            sensor: Sensor { encoder_step: self.encoder_step, noise: self.noise, delay_ticks: 0 },
            seed: self.seed,
        }
    }
}

/// How a run on a board ended: its own word for limits, the host's judgement of the recording otherwise.
fn board_ending(outcome: &Outcome, f1: Option<f64>) -> Option<RelayReport> {
    match outcome.ended.map(|ended| ended.ending) {
        Some(link::Ending::Limit { limit, value }) if !matches!(limit, Limit::Travel | Limit::Bound) => {
            Some(RelayReport::LimitTripped { limit: text::limit_name(limit), value: f64::from(value) })
        }
        _ if outcome.missing > 0 => Some(RelayReport::NotJudged { reason: "samples are missing" }),
        _ => relay::ending(&outcome.run, &outcome.experiment, f1),
    }
}

fn table(document: &Document) -> String {
    let mut text = String::new();
    if let Some(force) = document.breakaway {
        let _ = writeln!(text, "break-away force {force:.4}");
    }
    for entry in &document.recordings {
        let _ = writeln!(text, "{:<6}{:>7} samples  {}", entry.role, entry.samples, entry.file);
        if let Some(missing @ 1..) = entry.missing {
            let _ = writeln!(text, "      {missing} samples are missing: the recording is cut there");
        }
        if let Some(ending) = &entry.ending {
            let _ = writeln!(text, "      {}", ending.text(&document.units));
        }
    }
    text
}
