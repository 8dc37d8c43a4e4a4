//! Measures the board's own image: instructions and cycles per tick. Prints `name = number` lines for `cargo xtask budget`.

use std::process::ExitCode;

use breakaway_core::link::{
    Adaptive, Bounds, Command, ControllerGains, ErrorRate, FULL_SCALE_CODE, Model, Reference, Relay, Reply, Settings,
    Track, Trajectory,
};
use breakaway_emulator::bench::Bench;
use breakaway_emulator::machine::TickCost;

/// Ticks of a relay experiment, and of one under control.
const RELAY_TICKS: u32 = 6000;
const TRACK_TICKS: u32 = 3000;

fn main() -> ExitCode {
    let mut bench = match Bench::start() {
        Ok(bench) => bench,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    bench.machine.count_constants();
    prepare(&mut bench);
    bench.machine.ticks.clear();
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
    let slow = bench.machine.slow_functions();
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
    numbers("any", &all);
    ExitCode::SUCCESS
}

/// The papers' axis, and full drive.
fn prepare(bench: &mut Bench) {
    let settings = Settings {
        position_per_count: 1e-3,
        drive_full_scale: 5.0,
        drive_max_code: (i32::from(FULL_SCALE_CODE) * 95 / 100) as i16,
        mean_drive_max_code: FULL_SCALE_CODE,
        travel_min_counts: -40_000,
        travel_max_counts: 40_000,
        speed_max_counts_per_s: 1_000_000,
        ..bench.settings()
    };
    bench.done(Command::SetSettings(settings));
    bench.done(Command::StreamOn { decimation: 10 });
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
