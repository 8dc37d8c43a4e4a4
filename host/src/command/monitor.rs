//! `breakaway monitor`.

use std::io::IsTerminal;

use super::output::Output;
use super::port_args::PortArgs;
use crate::device::monitor;
use crate::interrupt::finish_first;

/// Watch a board live: position, drive, mode, rates, drops, faults
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway monitor --port /dev/ttyACM0
  breakaway monitor                                # the only board that answers

It also watches a port that another `run`, `track`, `capture` or `monitor` holds. There `s` stops what is running.

Keys: q quits, s stops what is running, c clears a fault, space freezes the curves. If the board is unplugged the monitor
waits for it and goes on when it is back. Needs a terminal of at least 80 × 24.")]
pub struct Args {
    /// The board.
    #[command(flatten)]
    pub port: PortArgs,
    /// Draw with plain characters, for terminals without Braille
    #[arg(long)]
    pub plain: bool,
}

impl Args {
    /// Shows the board until `q`.
    ///
    /// # Errors
    /// No terminal; the board cannot be reached at the start.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        if output.json || !std::io::stdout().is_terminal() {
            return Err(anyhow::anyhow!(
                "the monitor needs a terminal; `breakaway device --port {0} status --json` and `breakaway capture --port {0}` \
                 are for scripts",
                self.port.port.as_deref().unwrap_or("PORT")
            ));
        }
        let interrupt = finish_first();
        monitor::watch(&self.port.resolve()?, self.port.baud, self.plain || is_plain(), &interrupt)
    }
}

/// The Linux console has no Braille glyphs.
pub fn is_plain() -> bool {
    std::env::var("TERM").is_ok_and(|term| term == "linux")
}
