//! `breakaway models add`: a card from a model and its recordings, which passes its check.

use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

use super::super::UsageError;
use super::super::export::MotorArgs;
use super::super::output::Output;
use super::super::recording_args::{RecordingArgs, positive};
use crate::file::{FileKind, Target, shown};
use crate::fit::{Candidate, session};
use crate::model::Model;
use crate::models::card::{Constants, Data, File, Head, HeldOut, Range};
use crate::models::{Card, CardError, check, held_out};
use crate::recording::Recording;

/// Arguments of `add`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The model, as identify or discover wrote it
    #[arg(value_name = "M.toml")]
    pub model: PathBuf,
    /// The recordings that it was made from; the last third of each is held out
    #[arg(value_name = "REC", required = true)]
    pub recordings: Vec<PathBuf>,
    /// Short name of the card: a-z, 0-9 and -
    #[arg(long)]
    pub name: String,
    /// What the machine is
    #[arg(long, value_name = "TEXT")]
    pub machine: String,
    /// Who recorded it, and where the recordings are
    #[arg(long, value_name = "TEXT")]
    pub source: String,
    /// Licence of the recordings, or that none is stated
    #[arg(long, value_name = "TEXT")]
    pub licence: String,
    /// The command that gives the model again [default: the one of the model's comments, or discover]
    #[arg(long, value_name = "COMMAND")]
    pub repeat: Option<String>,
    /// Length of the held-out windows, s; shorter where no model follows the motion for so long
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = positive)]
    pub window: f64,
    /// Folder that the card's file names are under [default: the working folder]
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// The card to write; `-` is standard output
    #[arg(short, long, value_name = "CARD.toml")]
    pub output: Target,
    /// Motor and gear.
    #[command(flatten)]
    pub motor: MotorArgs,
    /// Columns and rows.
    #[command(flatten)]
    pub columns: ColumnArgs,
}

/// Columns and rows, without what the motor's arguments have.
#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "Recording")]
pub struct ColumnArgs {
    /// Column of time [default: t]
    #[arg(long, value_name = "COL")]
    pub time: Option<String>,
    /// Column of the applied drive [default: u]
    #[arg(long, value_name = "COL")]
    pub input: Option<String>,
    /// Column of the position [default: x]
    #[arg(long, value_name = "COL")]
    pub position: Option<String>,
    /// Only rows whose column has this value; may be repeated
    #[arg(long = "where", value_name = "COL=VALUE")]
    pub select: Vec<crate::recording::Selection>,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
pub(in crate::command) struct Document {
    version: &'static str,
    card: String,
    name: String,
    held_out: HeldOut,
}

impl Args {
    pub(super) fn run(self, output: Output) -> anyhow::Result<()> {
        let read: Vec<&Path> = self.recordings.iter().chain([&self.model]).map(PathBuf::as_path).collect();
        let output = output.claim(&[(&self.output, FileKind::Card)], &read)?;
        let card = self.card()?;
        let faults = check::faults(&card);
        if !faults.is_empty() {
            return Err(CardError::Faults { name: card.head.name, faults }.into());
        }
        self.output.write_text(&card.to_toml())?;
        let document = Document {
            version: super::VERSION,
            card: self.output.to_string(),
            name: card.head.name.clone(),
            held_out: card.held_out,
        };
        let x = &card.model.units.x;
        output.print(&document, |document| {
            let HeldOut { rmse, standstill_rmse, windows, window_s } = document.held_out;
            format!(
                "{}: card {} is written; held out over {windows} windows of {window_s} s it errs by {rmse:.3e} {x}, and an axis \
                 that stands still by {standstill_rmse:.3e} {x}",
                document.card, document.name
            )
        })
    }

    fn card(&self) -> anyhow::Result<Card> {
        let mut model = Model::read(&self.model)?;
        let columns = &self.columns;
        let reader = RecordingArgs {
            time: columns.time.clone(),
            input: columns.input.clone(),
            position: columns.position.clone(),
            select: columns.select.clone(),
            counts_per_turn: self.motor.counts_per_turn,
            ..RecordingArgs::default()
        };
        let mut found = reader.read_session(&self.recordings)?;
        if let Some(radians) = found.recordings.first().and_then(Recording::radians_per_unit) {
            model.in_radians(radians);
        }
        found.in_radians();
        let file = found.hashes.iter().map(|(name, sha256)| {
            let path = Path::new(name);
            let under = self.data.as_deref().and_then(|folder| path.strip_prefix(folder).ok());
            let name = under.unwrap_or(path).to_string_lossy().into_owned();
            File { name, sha256: sha256.clone() }
        });
        let candidate = Candidate { base: model.base, effects: model.plant_effects()? };
        let score = held_out::score(&candidate, &found.recordings, self.window)
            .with_context(|| format!("no window of {} s is held out; give a shorter --window", self.window))?;
        let options = reader.options();
        let text = |name: &str| name.to_owned();
        if self.motor.motor.is_some() {
            return Err(
                UsageError("--motor names another card; give this one's constants themselves".to_owned()).into()
            );
        }
        Ok(Card {
            head: Head {
                name: self.name.clone(),
                machine: self.machine.clone(),
                source: self.source.clone(),
                repeat: self.repeat.clone().unwrap_or_else(|| repeat(&self.recordings, columns)),
            },
            data: Data {
                licence: self.licence.clone(),
                time: text(options.time_column()),
                input: text(options.input_column()),
                position: text(options.position_column()),
                select: columns.select.iter().map(ToString::to_string).collect(),
                file: file.collect(),
            },
            motor: Constants {
                motor_constant: self.motor.motor_constant,
                resistance: self.motor.resistance,
                supply: self.motor.supply,
                gear: self.motor.gear,
                drive_gain: self.motor.drive_gain,
                counts_per_turn: self.motor.counts_per_turn,
            },
            range: range(&found.recordings),
            held_out: HeldOut {
                window_s: self.window,
                windows: score.windows,
                rmse: score.rmse,
                standstill_rmse: score.standstill_rmse,
            },
            model,
        })
    }
}

/// The discovery of the recordings, as a command line.
fn repeat(recordings: &[PathBuf], columns: &ColumnArgs) -> String {
    let mut words = vec!["breakaway discover".to_owned()];
    words.extend(recordings.iter().map(|path| shown(path)));
    let named = [("--time", &columns.time), ("--input", &columns.input), ("--position", &columns.position)];
    words.extend(named.iter().filter_map(|(flag, column)| Some(format!("{flag} {}", column.as_ref()?))));
    words.extend(columns.select.iter().map(|condition| format!("--where {condition}")));
    words.push("-o model.toml".to_owned());
    words.join(" ")
}

/// Where the recordings were; the speed is the smoothed motion's.
fn range(recordings: &[Recording]) -> Range {
    let tracks = session(recordings);
    let all = |of: fn(&crate::fit::MeasuredMotion) -> &[f64]| tracks.iter().flat_map(of).copied();
    let positions = all(|track| &track.x);
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, value| most.max(value.abs()));
    Range {
        position: [positions.clone().fold(f64::INFINITY, f64::min), positions.fold(f64::NEG_INFINITY, f64::max)],
        speed: largest(&mut all(|track| &track.vs)),
        drive: largest(&mut all(|track| &track.u)),
    }
}
