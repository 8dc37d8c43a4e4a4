//! `breakaway device`.

mod board;
pub(in crate::command) mod documents;
mod list;
mod motion;
mod stop;

use std::path::PathBuf;

use breakaway_core::link::{Command, Settings};

use board::Board;
use motion::{HomeArgs, JogArgs, ZeroArgs};

use super::UsageError;
use super::output::Output;
use super::port_args::PortArgs;
use crate::device::scale::Scale;
use crate::device::{Client, settings};
use crate::file::{FileKind, Target};
use crate::model::Model;

/// Read and command a board: identity, settings, model, faults
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway device --port /dev/ttyACM0 info
  breakaway device --port /dev/ttyACM0 settings set drive_full_scale=12 travel_max_counts=20000 --save
  breakaway device --port /dev/ttyACM0 model load model.toml
  breakaway device --port /dev/ttyACM0 home --drive=-1.2 --at=-0.5
  breakaway device --port /dev/ttyACM0 fault
  breakaway device list
  breakaway device stop                            # the only board that answers

`list` says hello at every serial port, all at once. Without --port the only board that answers is used.

Another breakaway process may hold the port. Then the identity, settings, model and faults can still be read. `stop`
tries three ways: through that process, over the port, and past a program that hangs and holds the port.

Settings and model hold until the next reset; `save` keeps them across resets. The position of the axis is not kept.
After a reset, a board with saved travel limits therefore runs only `home` and `jog` until it is homed or zeroed.")]
pub struct Args {
    /// The board.
    #[command(flatten)]
    pub port: PortArgs,
    /// What to do.
    #[command(subcommand)]
    pub action: Action,
}

/// What to do with the board.
#[derive(clap::Subcommand, Debug)]
pub enum Action {
    /// List the serial ports, and which of them answer
    List,
    /// Show the board, its firmware, tick and scales
    Info,
    /// Show what the board is doing
    Status,
    /// Limits, guards and scales
    Settings {
        /// What to do with them.
        #[command(subcommand)]
        action: Option<SettingsAction>,
    },
    /// Show the latched fault and the numbers that caused it
    Fault,
    /// Clear the latched fault
    Clear,
    /// The model it compensates with
    Model {
        /// What to do with it.
        #[command(subcommand)]
        action: ModelAction,
    },
    /// Identify from the relay experiments that were run on the board
    Identify,
    /// Keep settings and model across resets
    Save,
    /// Say what the position is where the axis stands; its travel limits count from there
    Zero(ZeroArgs),
    /// Push it gently against a stop, and say what the position is there
    Home(HomeArgs),
    /// Push it gently for a moment, out of the travel limits too where these are not zeroed
    Jog(JogArgs),
    /// Stop what is running; the drive goes to 0
    Stop,
    /// Reset it
    Reboot,
}

/// What to do with the settings.
#[derive(clap::Subcommand, Debug)]
pub enum SettingsAction {
    /// Show all, or the ones named
    Get {
        /// Names
        #[arg(value_name = "NAME")]
        names: Vec<String>,
    },
    /// Change them, all or none
    Set {
        /// Assignments
        #[arg(value_name = "NAME=VALUE", required = true)]
        assignments: Vec<String>,
        /// Keep them across resets
        #[arg(long)]
        save: bool,
    },
}

/// What to do with the model.
#[derive(clap::Subcommand, Debug)]
pub enum ModelAction {
    /// Load a model file; it holds until the next reset
    Load {
        /// The model
        #[arg(value_name = "M.toml")]
        file: PathBuf,
        /// Keep it across resets
        #[arg(long)]
        save: bool,
    },
    /// Keep the loaded model across resets
    Save,
    /// Read it back
    Get {
        /// File to write [default: standard output]
        #[arg(short, long, value_name = "M.toml")]
        output: Option<Target>,
    },
}

impl Args {
    /// Does it.
    ///
    /// # Errors
    /// The board cannot be reached, or refuses.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        // What can be wrong without a board is said without one.
        let loaded = match &self.action {
            Action::Model { action: ModelAction::Load { file, .. } } => Some(Model::read(file)?),
            _ => None,
        };
        if let Action::Settings { action: Some(SettingsAction::Set { assignments, .. }) } = &self.action {
            check(&mut Settings::default(), assignments)?;
        }
        let output = match &self.action {
            Action::Model { action: ModelAction::Get { output: Some(target) } } => {
                output.claim(&[(target, FileKind::Model)], &[])?
            }
            _ => output,
        };
        if matches!(self.action, Action::List) {
            return list::run(self.port.baud, output);
        }
        let port = self.port.resolve()?;
        if matches!(self.action, Action::Stop) {
            return stop::run(&port, self.port.baud, output);
        }
        let (client, info) = Client::connect(&port, self.port.baud)?;
        let scale = Scale::new(&info)?;
        let mut board = Board { client, info, scale, output };
        match self.action {
            Action::Info => board.info(),
            Action::Status => board.status(),
            Action::Settings { action: None } => board.settings_get(&[]),
            Action::Settings { action: Some(SettingsAction::Get { names }) } => board.settings_get(&names),
            Action::Settings { action: Some(SettingsAction::Set { assignments, save }) } => {
                board.settings_set(&assignments, save)
            }
            Action::Fault => board.fault(),
            Action::Clear => board.done(Command::ClearFault, "no fault is latched"),
            Action::Model { action: ModelAction::Load { save, .. } } => match loaded {
                Some(model) => board.model_load(&model, save),
                None => Ok(()),
            },
            Action::Model { action: ModelAction::Save } | Action::Save => {
                board.done(Command::Save, "settings and model are saved")
            }
            Action::Model { action: ModelAction::Get { output } } => board.model_get(output.as_ref()),
            Action::Identify => board.identify(),
            Action::Zero(args) => board.zero(args),
            Action::Home(args) => board.home(args),
            Action::Jog(args) => board.jog(args),
            Action::List | Action::Stop => Ok(()),
            Action::Reboot => board.done(Command::Reboot, "resetting"),
        }
    }
}

fn check(settings: &mut Settings, assignments: &[String]) -> Result<(), UsageError> {
    assignments.iter().try_for_each(|assignment| settings::set(settings, assignment)).map_err(UsageError)
}
