//! The port of a board, as an argument.

use std::io::{self, IsTerminal};

use breakaway_core::link::BAUD;

use super::console::{self, Verbosity};
use super::{UsageError, monitor};
use crate::device::list::{self, Listed};
use crate::device::monitor::Beside;

/// Where the board is.
#[derive(clap::Args, Clone, Debug)]
pub struct PortArgs {
    /// Serial port or pseudo-terminal of the board, e.g. /dev/ttyACM0 [default: the only one that answers]
    #[arg(long, value_name = "PORT")]
    pub port: Option<String>,
    /// Baud rate; USB ports and pseudo-terminals ignore it
    #[arg(long, value_name = "BAUD", default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(300..))]
    pub baud: u32,
}

impl PortArgs {
    /// The port: the one that was named, or the only one that answers.
    ///
    /// # Errors
    /// As [`found`].
    pub fn resolve(&self) -> anyhow::Result<String> {
        found(self.port.as_deref().unwrap_or(AUTO), self.baud)
    }
}

/// What stands for the only port that answers.
const AUTO: &str = "auto";

/// A port that was named; for `auto` the only one that answers.
///
/// # Errors
/// None answers; a [`UsageError`] where several do.
pub fn found(port: &str, baud: u32) -> anyhow::Result<String> {
    if port != AUTO {
        return Ok(port.to_owned());
    }
    let ports = list::list(baud);
    let answers: Vec<&Listed> = ports.iter().filter(|listed| listed.answer.is_ok()).collect();
    match answers[..] {
        [one] => {
            console::note(format_args!("using {}", described(one)));
            Ok(one.port.clone())
        }
        [] if ports.is_empty() => {
            Err(anyhow::anyhow!("there is no serial port: plug the board in, or give --port PORT"))
        }
        [] => {
            let names: Vec<&str> = ports.iter().map(|listed| listed.port.as_str()).collect();
            Err(anyhow::anyhow!(
                "no board answers at {}: `breakaway device list` says why; or give --port PORT",
                names.join(", ")
            ))
        }
        _ => {
            let names: Vec<String> = answers.into_iter().map(described).collect();
            Err(UsageError(format!("several boards answer: {}. Say which with --port PORT", names.join("; "))).into())
        }
    }
}

fn described(listed: &Listed) -> String {
    let board = listed.answer.as_ref().map_or("", |answer| answer.board.as_str());
    let device = listed.device.as_ref().map_or(String::new(), |device| format!(", {device}"));
    format!("{} ({board}{device})", listed.port)
}

/// Says that a port is not shared; the command goes on without.
pub fn shared(offered: io::Result<()>, port: &str) {
    if let Err(error) = offered {
        console::warn(format_args!("no other process can watch {port}, as it cannot be shared: {error}"));
    }
}

/// The monitor beside a run.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct MonitorArgs {
    /// Show the live monitor meanwhile; needs a terminal
    #[arg(long)]
    pub monitor: bool,
}

/// The screen beside a run, and what is said on standard error after it.
#[derive(Debug)]
pub struct Screen {
    beside: Option<Beside>,
    before: Verbosity,
}

impl MonitorArgs {
    /// Checks that there is a terminal for it, before anything moves.
    ///
    /// # Errors
    /// A [`UsageError`].
    pub fn check(self, port: Option<&str>) -> Result<(), UsageError> {
        if self.monitor && port.is_none() {
            return Err(UsageError("--monitor shows a board: give --port PORT".to_owned()));
        }
        if self.monitor && !(io::stdout().is_terminal() && io::stdin().is_terminal()) {
            return Err(UsageError(
                "--monitor needs a terminal, and standard input or output is none: leave it out, and run `breakaway \
                 monitor` in a terminal"
                    .to_owned(),
            ));
        }
        Ok(())
    }

    /// Opens the screen, if it is asked for. Progress and warnings would be written across it.
    ///
    /// # Errors
    /// The port is not shared.
    pub fn open(self, port: &str, baud: u32) -> anyhow::Result<Screen> {
        let before = console::verbosity();
        if !self.monitor {
            return Ok(Screen { beside: None, before });
        }
        let beside = Beside::open(port, baud, monitor::is_plain())?;
        console::set(Verbosity::Quiet);
        Ok(Screen { beside: Some(beside), before })
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.beside = None;
        console::set(self.before);
    }
}
