//! `breakaway virtual-board`.

use std::path::PathBuf;

use breakaway_core::link::{DriveUnit, FULL_SCALE_CODE, PositionUnit, Settings};
use schemars::JsonSchema;
use serde::Serialize;

use super::console;
use super::output::Output;
use super::recording_args::positive;
use super::run::papers_plant;
use crate::device::list;
use crate::device::virtual_board::{Injection, Machine, Options, VirtualBoard};
use crate::interrupt::finish_first;
use crate::model::Model;

/// Run the firmware on a virtual board: QEMU with a simulated plant, behind a pseudo-terminal
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway virtual-board --plant plant.toml
  breakaway run suite --port PORT -o session   # in another terminal, with PORT as printed

It runs until Ctrl-C. It needs the firmware's image and qemu-system-arm. `cargo xtask image` builds the image and fetches
QEMU; BREAKAWAY_IMAGE and BREAKAWAY_QEMU name others. Without --plant it simulates the reference plant of docs/theory.md,
section 2. The options set the board's settings: encoder step, drive at full scale, units of the plant. With --flash the
settings are kept, as on a real board.

Faults for tests: --inject TICK:FAULT, FAULT one of encoder-frozen, encoder-channel-dead, encoder-reversed,
encoder-jump=COUNTS, encoder-dead, tick-late=US,
break=NUMBER, emergency-stop, supply=MV, reset, garbage=BYTES, host-gone, link-noise=PPM (bytes of a million, either way),
corrupt-flash (TICK 0, with --flash), healed. TICK counts from the start.

JSON: port, board, tick_hz; printed when the board is ready.")]
pub struct Args {
    /// The plant to simulate, with any effects [default: the reference plant, docs/theory.md section 2]
    #[arg(long, value_name = "MODEL.toml")]
    pub plant: Option<PathBuf>,
    /// Control ticks per second
    #[arg(long, value_name = "HZ", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(10..=100_000))]
    pub tick_hz: u32,
    /// Position units per encoder count
    #[arg(long, value_name = "X", default_value_t = 0.001, value_parser = positive)]
    pub encoder_step: f64,
    /// Standard deviation of the position noise before the encoder, position units
    #[arg(long, value_name = "X", default_value_t = 0.0)]
    pub noise: f64,
    /// Drive units at full scale
    #[arg(long, value_name = "U", default_value_t = 5.0, value_parser = positive)]
    pub drive_full_scale: f64,
    /// Half of the travel, position units
    #[arg(long, value_name = "X", default_value_t = 40.0, value_parser = positive)]
    pub travel: f64,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Virtual time over real time at the most, or `max`
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = speed)]
    pub speed: f64,
    /// File of the flash's content [default: blank at every start]
    #[arg(long, value_name = "FILE")]
    pub flash: Option<PathBuf>,
    /// The firmware's image [default: built by `cargo xtask image`]
    #[arg(long, value_name = "ELF")]
    pub image: Option<PathBuf>,
    /// A fault at a tick; may be given several times
    #[arg(long, value_name = "TICK:FAULT")]
    pub inject: Vec<Injection>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    port: String,
    board: &'static str,
    tick_hz: u32,
}

fn speed(text: &str) -> Result<f64, String> {
    if text == "max" { Ok(f64::INFINITY) } else { positive(text).map_err(|error| format!("{error}, or `max`")) }
}

impl Args {
    /// Runs the board until Ctrl-C.
    ///
    /// # Errors
    /// The plant cannot be read, QEMU or the image is missing, QEMU ends.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let interrupt = finish_first();
        let model = self.plant.as_deref().map(Model::read).transpose()?.unwrap_or_else(papers_plant);
        let options = self.options(&model)?;
        let board = VirtualBoard::start(&options)?;
        // Only for being found: a board that is not is as good.
        let registered = list::register(&board.port);
        if let Err(error) = &registered {
            console::warn(format_args!("`breakaway device list` does not find the board: {error}"));
        }
        let document = Document { port: board.port.clone(), board: "mps2-an386", tick_hz: self.tick_hz };
        output.print(&document, |d| format!("virtual board at {} ({} Hz); Ctrl-C ends it", d.port, d.tick_hz))?;
        board.wait(|| !interrupt.requested())?;
        Ok(())
    }

    fn options(&self, model: &Model) -> anyhow::Result<Options> {
        let machine = Machine {
            base: model.base,
            effects: model.plant_effects()?,
            tick_hz: self.tick_hz,
            encoder_step: self.encoder_step,
            noise: self.noise,
            drive_full_scale: self.drive_full_scale,
            seed: self.seed,
        };
        machine.check()?;
        let mut settings = settings(&machine, model, self.travel);
        settings.command_timeout_ms = timeout_ms(settings.command_timeout_ms, self.speed);
        settings.validate().map_err(|field| anyhow::anyhow!("{} must be {}", field.name(), field.need()))?;
        Ok(Options {
            image: self.image.clone(),
            machine,
            settings,
            speed: self.speed,
            flash: self.flash.clone(),
            faults: self.inject.clone(),
            cable: false,
        })
    }
}

/// No machine runs the board faster than this, virtual over real time (6 is usual).
const FASTEST: f64 = 20.0;

/// The link's time-out on a board whose clock runs `speed` times as fast as its host's. It is the same in the host's
/// time, because a client sends a sign of life every 0.2 s of that.
fn timeout_ms(default_ms: u32, speed: f64) -> u32 {
    (f64::from(default_ms) * speed.clamp(1.0, FASTEST)).ceil() as u32
}

/// Settings of a board on this machine: its scales and units, its full drive, `travel` position units either way.
pub fn settings(machine: &Machine, model: &Model, travel: f64) -> Settings {
    let position_unit = PositionUnit::ALL.into_iter().find(|unit| unit.symbol() == model.units.x).unwrap_or_default();
    let drive_unit = DriveUnit::ALL.into_iter().find(|unit| unit.symbol() == model.units.u).unwrap_or_default();
    let travel_counts = (travel / machine.encoder_step).min(1e9) as i32;
    Settings {
        drive_max_code: FULL_SCALE_CODE,
        mean_drive_max_code: FULL_SCALE_CODE,
        travel_min_counts: -travel_counts,
        travel_max_counts: travel_counts,
        speed_max_counts_per_s: i32::MAX.unsigned_abs(),
        frozen_ticks: (machine.tick_hz / 2).max(1),
        frozen_drive_code: FULL_SCALE_CODE / 2,
        hysteresis_counts: 1,
        counts_per_revolution: 0,
        position_per_count: machine.encoder_step as f32,
        position_unit,
        drive_full_scale: machine.drive_full_scale as f32,
        drive_unit,
        ..Settings::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_out_keeps_up_with_the_clock() {
        assert_eq!([0.1, 1.0, 5.5, f64::INFINITY].map(|speed| timeout_ms(1000, speed)), [1000, 1000, 5500, 20_000]);
    }
}
