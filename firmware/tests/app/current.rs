//! The motor's current: in the samples, and limited.

use breakaway_core::link::{Command, CommandError, Ending, FaultCause, Field, Limit, Reply, Settings};
use breakaway_firmware::board::Trip;
use breakaway_firmware::storage::Loaded;
use breakaway_rig::relay;

use crate::bench::{Bench, World, settings};

/// Ticks above the limit that end a run: 1 ms at 1 kHz.
const TICKS: u32 = 1;

/// A board that measures up to 3 A, its limit at 1 A, under way.
fn measured(current_ma: i32) -> Bench {
    let world = World { current_ma: Some(current_ma), current_range_ma: 3000, ..World::default() };
    let mut bench = Bench::on(world, Loaded::defaults(Settings { current_max_ma: 1000, ..settings() }));
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    bench
}

#[test]
fn every_sample_has_the_current_and_a_board_without_it_sends_none() {
    let mut bench = measured(-123);
    bench.steps(500);
    assert!(bench.samples.len() > 400);
    assert!(bench.samples.iter().all(|sample| sample.current_ma == Some(-123)));
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    bench.steps(300);
    assert!(bench.samples.len() > 200);
    assert!(bench.samples.iter().all(|sample| sample.current_ma.is_none()));
}

/// At the limit a run goes on; above it, either way, it ends. That is no fault, and the next run may start.
#[test]
fn the_current_limit_ends_the_run() {
    for above in [1001, -1001] {
        let mut bench = measured(1000);
        bench.steps(300);
        assert!(bench.world.0.borrow().enabled);
        bench.world.0.borrow_mut().current_ma = Some(above);
        bench.steps(TICKS);
        assert!(!bench.world.0.borrow().enabled, "driven for more than {TICKS} ticks at {above} mA");
        let ending = Ending::Limit { limit: Limit::Current, value: above };
        assert_eq!((bench.until_ended(10).ending, bench.fault()), (ending, None));
        bench.world.0.borrow_mut().current_ma = Some(0);
        assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    }
}

/// The board opens its bridge by itself at a level of its own, which follows the setting.
#[test]
fn an_over_current_is_a_fault_of_its_own() {
    let mut bench = measured(400);
    bench.steps(300);
    assert_eq!(bench.world.0.borrow().current_limit_ma, 1000);
    bench.world.0.borrow_mut().trip = Some(Trip::OverCurrent(1500));
    bench.steps(1);
    assert!(!bench.world.0.borrow().enabled);
    let fault = bench.fault().unwrap();
    assert_eq!((fault.cause, fault.value, fault.limit), (FaultCause::OverCurrent, 400, 1500));
    bench.world.0.borrow_mut().trip = None;
    assert_eq!(bench.command(Command::ClearFault), Reply::Done);
    let other = Settings { current_max_ma: 0, ..settings() };
    assert_eq!(bench.command(Command::SetSettings(other)), Reply::Done);
    assert_eq!(bench.world.0.borrow().current_limit_ma, 0);
}

/// A limit that nothing watches any more ends the run as a fault, within a tick. No other run starts before it measures again, or
/// the limit is taken back.
#[test]
fn a_limited_current_that_is_no_longer_measured_is_a_fault() {
    let mut bench = measured(400);
    bench.steps(300);
    bench.world.0.borrow_mut().current_ma = None;
    bench.steps(1);
    assert!(!bench.world.0.borrow().enabled);
    assert_eq!(bench.fault().map(|fault| (fault.cause, fault.limit)), Some((FaultCause::CurrentSensor, 1000)));
    assert_eq!(bench.command(Command::ClearFault), Reply::Done);
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    bench.steps(1);
    assert_eq!(bench.fault().map(|fault| fault.cause), Some(FaultCause::CurrentSensor));
    assert_eq!(bench.command(Command::ClearFault), Reply::Done);
    assert_eq!(bench.command(Command::SetSettings(settings())), Reply::Done);
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), Reply::Done);
    bench.steps(300);
    assert_eq!(bench.fault(), None);
}

#[test]
fn a_limit_above_what_is_measured_is_refused() {
    let mut bench = measured(0);
    assert_eq!(bench.command(Command::Stop), Reply::Done);
    let set = |current_max_ma| Command::SetSettings(Settings { current_max_ma, ..settings() });
    assert_eq!(bench.command(set(3001)), Reply::Error(CommandError::Settings(Field::CurrentMax)));
    assert_eq!(bench.command(set(3000)), Reply::Done);
}
