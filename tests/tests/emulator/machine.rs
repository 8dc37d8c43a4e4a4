//! A board with the papers' axis, its settings made for it.

use breakaway_core::link::{Bounds, Command, Ended, FULL_SCALE_CODE, Push, Reference, Relay, Settings};
use breakaway_emulator::bench::Bench;
use breakaway_rig::code;

/// As it leaves the factory.
pub fn board() -> Bench {
    Bench::start().unwrap_or_else(|error| panic!("{error}"))
}

/// With the axis's scales, and the power stage's full drive.
pub fn axis() -> Bench {
    axis_with(|_| {})
}

/// With settings changed.
pub fn axis_with(change: impl FnOnce(&mut Settings)) -> Bench {
    scaled(board(), change)
}

/// Settings for the axis, changed.
pub fn scaled(mut bench: Bench, change: impl FnOnce(&mut Settings)) -> Bench {
    let mut settings = Settings {
        position_per_count: 1e-3,
        drive_full_scale: 5.0,
        drive_max_code: (i32::from(FULL_SCALE_CODE) * 95 / 100) as i16,
        mean_drive_max_code: FULL_SCALE_CODE,
        travel_min_counts: -40_000,
        travel_max_counts: 40_000,
        speed_max_counts_per_s: 1_000_000,
        ..bench.settings()
    };
    change(&mut settings);
    bench.done(Command::SetSettings(settings));
    bench
}

/// A constant drive, V, for so many ticks.
pub fn push(volts: f64, ticks: u32) -> Command {
    Command::Jog(Push { drive_code: code(volts), bounds: Bounds { max_ticks: ticks, ..Bounds::default() } })
}

/// A dual relay of amplitudes in V, until it is stopped where `ticks` is 0.
pub fn relay(h1: f64, h2: f64, ticks: u32) -> Command {
    Command::StartRelay(Relay {
        h1_code: code(h1),
        h2_code: code(h2),
        hysteresis_counts: Some(1),
        reference: Reference::default(),
        until_settled: false,
        append: true,
        bounds: Bounds { max_ticks: ticks, ..Bounds::default() },
    })
}

/// A relay experiment to its end.
pub fn run_relay(bench: &mut Bench, h1: f64, h2: f64, ticks: u32) -> Ended {
    bench.events.clear();
    bench.done(relay(h1, h2, ticks));
    bench.until("the end of the relay experiment", 60_000, |bench| bench.ended().is_some());
    bench.ended().unwrap()
}
