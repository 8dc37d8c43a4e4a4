//! Commands and runs.

use breakaway_core::excite::waveform::Shape;
use breakaway_core::link::{
    Bounds, Command, CommandError, Ending, FULL_SCALE_CODE, Field, Limit, Mode, OpenLoop, Reply, Settings,
};
use breakaway_rig::{code, relay};
use proptest::prelude::*;

use crate::bench::{Bench, settings};

#[test]
fn who_it_is_and_what_it_does() {
    let mut bench = Bench::new();
    let Reply::Info(info) = bench.command(Command::Hello) else { panic!() };
    assert_eq!((info.board.as_str(), info.tick_hz, info.drive_full_scale), ("bench", 1000, 5.0));
    assert_eq!(bench.command(Command::GetSettings), Reply::Settings(settings()));
    let wrong = Settings { jump_counts: 0, ..settings() };
    assert_eq!(bench.command(Command::SetSettings(wrong)), Reply::Error(CommandError::Settings(Field::JumpCounts)));
    assert_eq!(bench.command(Command::Save), Reply::Error(CommandError::Storage));
    let status = bench.status();
    assert_eq!((status.mode, status.drive_code, status.dropped, status.unsaved), (Mode::Idle, 0, 0, false));
}

#[test]
fn what_needs_rest_is_refused_during_a_run() {
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    let busy = Reply::Error(CommandError::Busy(Mode::Relay));
    bench.steps(50);
    for command in
        [Command::StartRelay(relay(1.0, 0.7, 0)), Command::SetSettings(settings()), Command::Save, Command::Identify]
    {
        assert_eq!(bench.command(command), busy);
    }
    assert_eq!(bench.command(Command::Stop), Reply::Done);
    assert_eq!(bench.until_ended(5).ending, Ending::Stopped);
    assert_eq!(bench.status().mode, Mode::Idle);
}

#[test]
fn a_relay_ends_when_its_cycle_has_settled_and_when_it_cannot() {
    let mut bench = Bench::new();
    let settled = breakaway_core::link::Relay { until_settled: true, ..relay(2.0, 1.5, 0) };
    assert_eq!(bench.command(Command::StartRelay(settled)), Reply::Done);
    assert!(matches!(bench.until_ended(20_000).ending, Ending::Settled { cycles } if cycles >= 4));
    // h1 + h2 = 0.4 V is below the break-away level of 0.5 V.
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::StartRelay(relay(0.2, 0.2, 0))), Reply::Done);
    let ended = bench.until_ended(300);
    assert_eq!(ended.ending, Ending::NoLimitCycle);
    assert_eq!(ended.ticks, 200, "as many as the settings say");
}

/// Limits end a run and are no fault; the sample after them has no drive.
#[test]
fn limits_are_not_faults() {
    let bound = Bounds { travel_counts: 400, ..Bounds::default() };
    let far = breakaway_core::link::Relay { bounds: bound, ..relay(2.0, 1.5, 0) };
    let narrow = Settings { travel_max_counts: 300, ..settings() };
    let slow = Settings { speed_max_counts_per_s: 2000, ..settings() };
    let cool = Settings { mean_drive_max_code: code(2.0), ..settings() };
    for (settings, command, expected) in [
        (settings(), far, Limit::Bound),
        (narrow, relay(2.0, 1.5, 0), Limit::Travel),
        (slow, relay(2.0, 1.5, 0), Limit::Speed),
        (cool, relay(2.5, 2.0, 0), Limit::MeanDrive),
    ] {
        let mut bench = Bench::with_memory([0; 8], settings);
        assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
        assert_eq!(bench.command(Command::StartRelay(command)), Reply::Done);
        let ended = bench.until_ended(20_000);
        assert!(matches!(ended.ending, Ending::Limit { limit, .. } if limit == expected), "{ended:?}");
        assert_eq!(bench.fault(), None);
        let at_end = bench.samples.iter().find(|sample| sample.tick == ended.tick).unwrap();
        assert_eq!((at_end.drive_code, at_end.mode), (0, Mode::Idle));
    }
}

/// A motor is blocked under a drive too small for the encoder's guard (frozen_drive_code, 25 %), by the default
/// settings. The mean over about a second passes 12.5 %.
#[test]
fn the_default_mean_drive_protects_a_stalled_motor() {
    let settings = Settings { position_per_count: settings().position_per_count, ..Settings::default() };
    let mut bench = Bench::with_memory([0; 8], settings);
    bench.world.0.borrow_mut().plant.base.f1 = 100.0;
    let blocked = OpenLoop {
        shape: Shape::Sine,
        amplitude_code: FULL_SCALE_CODE / 100 * 24,
        phase_step: (1 << 31) / 2000, // 0.25 Hz at 1 kHz
        centring_q16: 0,
        bounds: Bounds { max_ticks: 20_000, ..Bounds::default() },
    };
    assert_eq!(bench.command(Command::StartDrive(blocked)), Reply::Done);
    let ended = bench.until_ended(21_000);
    assert!(matches!(ended.ending, Ending::Limit { limit: Limit::MeanDrive, value: 4095..=4110 }), "{ended:?}");
    assert!(ended.ticks < 1500, "{ended:?}");
}

#[test]
fn a_current_limit_that_nothing_measures_is_refused() {
    let mut bench = Bench::new();
    let limited = Settings { current_max_ma: 2000, ..settings() };
    let refused = Reply::Error(CommandError::Settings(Field::CurrentMax));
    assert_eq!(bench.command(Command::SetSettings(limited)), refused);
    assert_eq!(bench.command(Command::GetSettings), Reply::Settings(settings()));
}

#[test]
fn an_open_loop_sine_is_what_was_asked_for() {
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    let sine = OpenLoop {
        shape: Shape::Sine,
        amplitude_code: code(2.0),
        phase_step: (1 << 31) / 125, // 4 Hz at 1 kHz
        centring_q16: 0,
        bounds: Bounds { max_ticks: 1000, ..Bounds::default() },
    };
    assert_eq!(bench.command(Command::StartDrive(sine)), Reply::Done);
    assert_eq!(bench.until_ended(1100).ending, Ending::TimeUp);
    let run: Vec<_> = bench.samples.iter().filter(|sample| sample.mode == Mode::Drive).collect();
    assert_eq!(run.len(), 1000);
    for (k, sample) in run.iter().enumerate() {
        let expected = 2.0 * (std::f64::consts::TAU * 4.0 * k as f64 / 1000.0).sin();
        // A drive code and the waveform's Q15 rounding.
        assert!((i32::from(sample.drive_code) - i32::from(code(expected))).abs() <= 2, "tick {k}: {sample:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Every way out of an experiment restores the limits it changed.
    #[test]
    fn limits_come_back(
        drive_max_code in 1..i16::MAX,
        travel in 1..3000_u32,
        max_ticks in 1..800_u32,
        how in 0..5,
    ) {
        let mut bench = Bench::new();
        let before = bench.limits();
        let bounds = Bounds { max_ticks, drive_max_code, travel_counts: travel };
        let run = breakaway_core::link::Relay { bounds, until_settled: how == 1, ..relay(2.0, 1.5, 0) };
        prop_assert_eq!(bench.command(Command::StartRelay(run)), Reply::Done);
        if bench.events.iter().all(|event| !matches!(event, breakaway_core::link::Event::ExperimentEnded(_))) {
            prop_assert!(bench.limits().drive_code <= drive_max_code);
        }
        match how {
            2 => drop(bench.command(Command::Stop)),
            3 => bench.world.0.borrow_mut().jump = 5000,
            4 => bench.world.0.borrow_mut().broken_drive = true,
            _ => {}
        }
        bench.until_ended(1000);
        prop_assert_eq!(bench.limits(), before);
        prop_assert_eq!(bench.world.0.borrow().drive, 0);
    }
}
