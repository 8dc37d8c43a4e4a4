//! Resets in the middle of a run: what happens to the outputs, and what is told after it.

use breakaway_core::link::{Command, FaultCause, Reply};
use breakaway_emulator::bench::{Bench, MS, TICK};

use crate::machine::{axis, relay};

/// A relay experiment under way, and an accident after which the board starts again. The fault is told, nothing is driven, and
/// nothing runs before it is cleared.
fn restarts(cause: FaultCause, within: u64, accident: impl FnOnce(&mut Bench)) {
    let mut bench = axis();
    bench.done(relay(2.0, 1.5, 0));
    bench.run(300 * MS);
    let at = bench.now();
    accident(&mut bench);
    bench.started();
    assert_eq!(bench.machine.resets, 1, "{cause:?}");
    bench.run(20 * MS);
    let driven = bench.machine.bus().driven_at.saturating_sub(at);
    assert!(driven <= within, "{cause:?}: driven for {} µs more", driven / 170);
    assert_eq!(bench.fault().map(|record| record.cause), Some(cause));
    assert!(matches!(bench.request(relay(2.0, 1.5, 0)), Reply::Error(_)));
    bench.done(Command::ClearFault);
    assert_eq!(bench.fault(), None);
}

/// The reset pin. The pins float until the next start has set them up: the power stage's inputs are pulled down.
#[test]
fn a_reset_while_driving() {
    needs_unicorn!();
    restarts(FaultCause::ResetWhileDriven, TICK / 4, |bench| bench.machine.reset());
}

/// 5 ms by the nominal LSI, and the period of the PWM.
#[test]
fn ticks_that_stop() {
    needs_unicorn!();
    restarts(FaultCause::Watchdog, 5 * MS + TICK, |bench| bench.machine.ticks_stop());
}

/// The handler opens all switches before it resets: microseconds.
#[test]
fn a_hard_fault() {
    needs_unicorn!();
    restarts(FaultCause::Panic, TICK / 4, |bench| bench.machine.hard_fault());
}

/// TIM1 by itself, and the interrupt that is not masked.
#[test]
fn a_crystal_that_stops() {
    needs_unicorn!();
    restarts(FaultCause::Panic, TICK / 4, |bench| bench.machine.crystal_stops());
}
