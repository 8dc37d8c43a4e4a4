//! `breakaway device zero`, `home` and `jog`.

use std::time::Duration;

use breakaway_core::link::{Bounds, Command, Ended, Ending, Event, Message, Push};

use super::board::Board;
use super::documents::{Moved, Zeroed};
use crate::command::recording_args::{finite, positive};
use crate::device::{DeviceError, text};
use crate::interrupt::finish_first;

/// How long the board's next message is waited for before an interrupt is looked at.
const POLL: Duration = Duration::from_millis(50);

/// A push with a constant drive.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct PushArgs {
    /// Drive, in drive units; its sign is the direction. At most what mean_drive_max_code allows
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = finite)]
    pub drive: f64,
    /// Ends at this distance from the start, position units
    #[arg(long, value_name = "X", value_parser = positive)]
    pub distance: Option<f64>,
}

/// A time after which it ends.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct JogArgs {
    /// How.
    #[command(flatten)]
    pub push: PushArgs,
    /// Ends after this time, s
    #[arg(long = "for", value_name = "S", default_value_t = 0.5, value_parser = positive)]
    pub seconds: f64,
}

/// A stop, and what the position is there.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct HomeArgs {
    /// How.
    #[command(flatten)]
    pub push: PushArgs,
    /// Position at the stop, position units
    #[arg(long, value_name = "X", default_value_t = 0.0, allow_hyphen_values = true, value_parser = finite)]
    pub at: f64,
    /// Gives up after this time, s
    #[arg(long = "for", value_name = "S", default_value_t = 10.0, value_parser = positive)]
    pub seconds: f64,
}

/// What the present position is called.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct ZeroArgs {
    /// Position where it stands, position units
    #[arg(long, value_name = "X", default_value_t = 0.0, allow_hyphen_values = true, value_parser = finite)]
    pub at: f64,
}

impl Board {
    pub fn zero(&mut self, args: ZeroArgs) -> anyhow::Result<()> {
        let count = self.count(args.at)?;
        self.client.done(Command::Zero { count })?;
        let position = self.scale.position(count);
        let document = Zeroed { done: "zeroed", position };
        self.output.print(&document, |_| format!("zeroed: it stands at {position:.6} {}", self.scale.units.x))
    }

    pub fn jog(&mut self, args: JogArgs) -> anyhow::Result<()> {
        let push = self.push(args.push, args.seconds)?;
        let ended = self.moved(Command::Jog(push))?;
        self.tell("jogged", &ended)
    }

    pub fn home(&mut self, args: HomeArgs) -> anyhow::Result<()> {
        let push = self.push(args.push, args.seconds)?;
        let at = self.count(args.at)?;
        let ended = self.moved(Command::Home { push, at })?;
        match ended.ending {
            Ending::Homed => self.tell("homed", &ended),
            Ending::TimeUp => {
                anyhow::bail!("no stop within {} s: give it longer (`--for`), or the other way", args.seconds)
            }
            Ending::NoLimitCycle => {
                anyhow::bail!(
                    "it did not move: the drive is below break-away, or it stands at the stop (jog it away first)"
                )
            }
            other => {
                let settings = self.read_settings()?;
                anyhow::bail!("no stop was found: {}", text::ending(other, &self.scale, &settings))
            }
        }
    }

    fn push(&self, args: PushArgs, seconds: f64) -> Result<Push, DeviceError> {
        let code = self.scale.code("--drive", args.drive.abs())?;
        let travel_counts = args.distance.map_or(Ok(0), |distance| self.scale.counts("--distance", distance))?;
        let max_ticks = (seconds * self.scale.tick_hz).ceil().clamp(1.0, f64::from(u32::MAX)) as u32;
        let drive_code = if args.drive < 0.0 { -code } else { code };
        Ok(Push { drive_code, bounds: Bounds { max_ticks, drive_max_code: 0, travel_counts } })
    }

    fn count(&self, position: f64) -> Result<i32, DeviceError> {
        let counts = self.scale.counts("--at", position.abs())?.cast_signed();
        Ok(if position < 0.0 { -counts } else { counts })
    }

    /// Starts a push and waits for its end; Ctrl-C stops it.
    fn moved(&mut self, command: Command) -> anyhow::Result<Ended> {
        let interrupt = finish_first();
        self.client.done(command)?;
        let mut stopped = false;
        loop {
            if interrupt.requested() && !stopped {
                stopped = true;
                self.client.done(Command::Stop)?;
            }
            if let Some(Message::Event(Event::ExperimentEnded(ended))) = self.client.receive(POLL)? {
                return Ok(ended);
            }
        }
    }

    fn tell(&mut self, done: &'static str, ended: &Ended) -> anyhow::Result<()> {
        let position = self.scale.position(self.client.status()?.count);
        let settings = self.read_settings()?;
        let end = match ended.ending {
            Ending::NoLimitCycle => "it did not move".to_owned(),
            other => text::ending(other, &self.scale, &settings),
        };
        if let Ending::Fault(_) = ended.ending {
            anyhow::bail!("{end} (`breakaway device … fault` says why)");
        }
        let document = Moved { done, ending: end, position };
        self.output.print(&document, |moved| format!("{}: at {position:.6} {}", moved.ending, self.scale.units.x))
    }
}
