//! Zero, home and jog: what travel limits count from.

use breakaway_core::link::{Bounds, Command, CommandError, Ending, Field, Limit, Mode, Push, Reply, Settings};
use breakaway_firmware::storage::Loaded;
use breakaway_rig::{code, relay};

use crate::bench::{Bench, settings};

/// Limits of the machine, saved at a time when the axis was at zero; the board starts with the axis somewhere else.
fn saved() -> Bench {
    let settings = Settings { travel_min_counts: -1000, travel_max_counts: 3000, ..settings() };
    Bench::loaded([0; 8], Loaded { zero_needed: true, ..Loaded::defaults(settings) })
}

fn push(volts: f64, max_ticks: u32) -> Push {
    Push { drive_code: code(volts), bounds: Bounds { max_ticks, ..Bounds::default() } }
}

#[test]
fn saved_travel_limits_ask_for_a_zero() {
    let mut bench = saved();
    let run = || Command::StartRelay(relay(2.0, 1.5, 20));
    assert_eq!(bench.command(run()), Reply::Error(CommandError::NotZeroed));
    assert!(bench.status().zero_needed && !bench.world.0.borrow().enabled);
    // Another setting changes nothing of it; other limits count as the axis does now.
    let Reply::Settings(settings) = bench.command(Command::GetSettings) else { panic!() };
    let slower = Settings { speed_max_counts_per_s: 9000, ..settings };
    assert_eq!(bench.command(Command::SetSettings(slower)), Reply::Done);
    assert_eq!(bench.command(run()), Reply::Error(CommandError::NotZeroed));
    let narrower = Settings { travel_max_counts: 900, ..slower };
    assert_eq!(bench.command(Command::SetSettings(narrower)), Reply::Done);
    assert!(!bench.status().zero_needed);
    assert_eq!(bench.command(run()), Reply::Done);
    // Zeroed where it stands.
    let mut bench = saved();
    assert_eq!(bench.command(Command::Zero { count: 2000 }), Reply::Done);
    let status = bench.status();
    assert_eq!((status.count, status.zero_needed, bench.fault()), (2000, false, None));
    assert_eq!(bench.command(run()), Reply::Done);
    // 1000 counts are left to the limit.
    assert_eq!(bench.command(Command::Zero { count: 0 }), Reply::Error(CommandError::Busy(Mode::Relay)));
    bench.until_ended(30);
    bench.events.clear();
    assert_eq!(bench.command(Command::Jog(push(1.0, 4000))), Reply::Done);
    let ended = bench.until_ended(4100);
    assert!(matches!(ended.ending, Ending::Limit { limit: Limit::Travel, value: 3001..=3010 }), "{ended:?}");
    // Coasting on it leaves the limits; a jog leads back, and no other way.
    bench.steps(500);
    assert!(bench.status().count > 3000);
    assert_eq!(bench.command(run()), Reply::Error(CommandError::OutsideTravel));
    assert_eq!(bench.command(Command::Jog(push(1.0, 10))), Reply::Error(CommandError::OutsideTravel));
    bench.events.clear();
    assert_eq!(bench.command(Command::Jog(push(-1.0, 1500))), Reply::Done);
    bench.until_ended(1600);
    assert!(bench.status().count < 3000);
}

/// A stop at +2 rad, as a hard spring: 2000 counts from where the count starts. It is called 3000.
#[test]
fn homing_finds_the_stop() {
    let mut bench = saved();
    {
        let axis = &mut bench.world.0.borrow_mut().plant;
        axis.stop = Some(2.0);
    }
    assert_eq!(bench.command(Command::Home { push: push(1.0, 10_000), at: 3000 }), Reply::Done);
    let ended = bench.until_ended(10_000);
    assert_eq!((ended.mode, ended.ending), (Mode::Drive, Ending::Homed));
    bench.steps(5);
    let status = bench.status();
    // Pressed against the stop by 0.5 V and let go.
    assert!((status.count - 3000).abs() <= 2 && !status.zero_needed, "{status:?}");
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 20))), Reply::Done);
}

#[test]
fn a_push_that_moves_nothing_or_finds_nothing_ends() {
    // 0.3 V are below break-away.
    let mut bench = saved();
    assert_eq!(bench.command(Command::Home { push: push(0.3, 10_000), at: 0 }), Reply::Done);
    assert_eq!(bench.until_ended(1000).ending, Ending::NoLimitCycle);
    assert!(bench.status().zero_needed);
    bench.events.clear();
    assert_eq!(bench.command(Command::Home { push: push(1.0, 300), at: 0 }), Reply::Done);
    assert_eq!(bench.until_ended(400).ending, Ending::TimeUp);
    assert!(bench.status().zero_needed);
    // More than the motor stands for ever is refused.
    let mut bench = Bench::with_memory([0; 8], Settings { mean_drive_max_code: code(0.9), ..settings() });
    let refused = Reply::Error(CommandError::Range(Field::PushDrive));
    assert_eq!(bench.command(Command::Jog(push(-1.0, 300))), refused);
    assert_eq!(bench.command(Command::Home { push: push(1.0, 300), at: 0 }), refused);
}

/// A board whose limits nobody has saved does not ask.
#[test]
fn limits_of_the_board_ask_for_no_zero() {
    let mut bench = Bench::new();
    assert!(!bench.status().zero_needed);
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 20))), Reply::Done);
}
