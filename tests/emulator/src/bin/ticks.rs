//! Measures the board's own image: instructions and cycles per tick. Prints `name = number` lines for `cargo xtask budget`.

use std::process::ExitCode;

use breakaway_core::link::{
    Adaptive, Bounds, Command, ControllerGains, DriveUnit, ErrorRate, FULL_SCALE_CODE, Model, Reference, Relay, Reply,
    Settings, Track, Trajectory,
};
use breakaway_emulator::bench::Bench;
use breakaway_emulator::machine::TickCost;
use breakaway_emulator::unicorn::NoUnicorn;
use breakaway_emulator::winding::Winding;

/// Ticks of a relay experiment, and of one under control.
const RELAY_TICKS: u32 = 6000;
const TRACK_TICKS: u32 = 3000;

/// A winding for the papers' axis.
const WINDING: Winding = Winding { resistance: 2.0, inductance: 2e-3, back_emf: 0.05, supply: 5.0, current: 0.0 };

fn main() -> ExitCode {
    match measure() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn measure() -> Result<(), NoUnicorn> {
    let mut bench = Bench::start()?;
    prepare(&mut bench, volts);
    let mut all = Vec::new();
    let mut relays = Vec::new();
    for (h1, h2) in [(2.0, 1.5), (1.0, 0.7)] {
        relays.extend(run(&mut bench, relay(h1, h2), RELAY_TICKS, &mut all));
    }
    let identified = bench.request(Command::Identify);
    assert!(matches!(identified, Reply::Identified(_)), "{identified:?}");
    bench.done(Command::LoadModel(Model { b: 0.027, c: 0.11, f1: 0.5, effects: heapless::Vec::new() }));
    bench.done(Command::Save);
    let adaptive = run(&mut bench, track(), TRACK_TICKS, &mut all);
    all.append(&mut bench.machine.ticks);
    let mut slow = bench.machine.slow_functions();
    // The same with the drive in A: each tick closes the current loop too.
    let mut bench = Bench::with_winding(WINDING)?;
    prepare(&mut bench, amperes);
    bench.done(Command::LoadModel(Model { b: 0.0135, c: 0.03, f1: 0.25, effects: heapless::Vec::new() }));
    let regulated = run(&mut bench, track(), TRACK_TICKS, &mut all);
    all.append(&mut bench.machine.ticks);
    slow.extend(bench.machine.slow_functions());
    let numbers = |what: &str, ticks: &[TickCost]| {
        let of = |field: fn(&TickCost) -> u64| {
            let sum: u64 = ticks.iter().map(field).sum();
            (sum / ticks.len().max(1) as u64, ticks.iter().map(field).max().unwrap_or(0))
        };
        let (mean, worst) = of(|tick| tick.instructions);
        println!("nucleo_{what}_tick_mean = {mean}");
        println!("nucleo_{what}_tick_worst = {worst}");
        let (mean, worst) = of(|tick| tick.cycles);
        println!("nucleo_{what}_cycles_mean = {mean}");
        println!("nucleo_{what}_cycles_worst = {worst}");
        // Whatever is not in CCM SRAM is named.
        assert_eq!(of(|tick| tick.from_flash).1, 0, "from flash: {slow:?}");
    };
    numbers("relay", &relays);
    numbers("adaptive", &adaptive);
    numbers("regulated", &regulated);
    numbers("any", &all);
    Ok(())
}

/// The drive in V, of 5 V at full duty.
fn volts(settings: Settings) -> Settings {
    Settings { drive_full_scale: 5.0, ..settings }
}

/// The drive in A, of what is measured, by the current loop of the winding.
fn amperes(settings: Settings) -> Settings {
    Settings {
        drive_unit: DriveUnit::Ampere,
        drive_full_scale: 2.9,
        supply_v: WINDING.supply as f32,
        motor_resistance_ohm: WINDING.resistance as f32,
        motor_inductance_h: WINDING.inductance as f32,
        ..settings
    }
}

/// The papers' axis, full drive, and ticks that are counted from now on.
fn prepare(bench: &mut Bench, drive: fn(Settings) -> Settings) {
    bench.machine.count_constants();
    let settings = Settings {
        position_per_count: 1e-3,
        drive_max_code: (i32::from(FULL_SCALE_CODE) * 95 / 100) as i16,
        mean_drive_max_code: FULL_SCALE_CODE,
        travel_min_counts: -40_000,
        travel_max_counts: 40_000,
        speed_max_counts_per_s: 1_000_000,
        ..bench.settings()
    };
    bench.done(Command::SetSettings(drive(settings)));
    bench.done(Command::StreamOn { decimation: 10 });
    bench.machine.ticks.clear();
}

/// One run; its ticks but the first, which takes the order, and those after its end. All of them go to `all`.
fn run(bench: &mut Bench, command: Command, ticks: u32, all: &mut Vec<TickCost>) -> Vec<TickCost> {
    bench.events.clear();
    all.append(&mut bench.machine.ticks);
    bench.done(command);
    bench.until("the end of the run", 10_000, |bench| bench.ended().is_some());
    let taken = std::mem::take(&mut bench.machine.ticks);
    let ended = bench.ended().map_or(0, |ended| ended.ticks);
    assert_eq!(ended, ticks, "{:?}", bench.events);
    all.extend(&taken);
    // The order came at the start of these, the end is told within two milliseconds.
    let first = taken.len().saturating_sub(ticks as usize);
    taken[first.min(20)..taken.len().saturating_sub(first)].to_vec()
}

fn relay(h1: f64, h2: f64) -> Command {
    let code = |volts: f64| (volts / 5.0 * f64::from(FULL_SCALE_CODE)) as i16;
    Command::StartRelay(Relay {
        h1_code: code(h1),
        h2_code: code(h2),
        hysteresis_counts: Some(1),
        reference: Reference::default(),
        until_settled: false,
        append: true,
        bounds: Bounds { max_ticks: RELAY_TICKS, ..Bounds::default() },
    })
}

/// The adaptive law along a sine, with compensation: the longest of the ticks under control.
fn track() -> Command {
    Command::StartTrack(Track {
        trajectory: Trajectory::Sine { amplitude: 1.0, period_s: 2.0 },
        controller: ControllerGains::Adaptive(Adaptive {
            kv: 0.5,
            lambda1: 10.0,
            lambda2: 5.0,
            delta: 0.5,
            error_rate: ErrorRate { filter_s: 1e-3, observer_rad_s: 500.0 },
            rates: [0.1; 5],
        }),
        feed_forward: true,
        compensation: true,
        bounds: Bounds { max_ticks: TRACK_TICKS, ..Bounds::default() },
    })
}
