//! What a tick costs on the board's own image.

use breakaway_core::link::{Bounds, Command, Push};

use crate::machine::{axis, relay};

/// The same with the current loop.
#[test]
fn the_current_loop_runs_without_wait_states() {
    needs_unicorn!();
    let mut bench = crate::current::regulated();
    bench.done(relay(1.0, 0.5, 2000));
    bench.until("the end", 1000, |bench| bench.ended().is_some());
    let slow = bench.machine.slow_functions();
    assert!(slow.is_empty(), "the tick runs from flash: {slow:?}");
}

/// No tick executes code in flash: what it runs is in CCM SRAM (memory.x). The names are those of functions to be added there.
#[test]
fn the_tick_runs_without_wait_states() {
    needs_unicorn!();
    let mut bench = axis();
    bench.done(relay(2.0, 1.5, 3000));
    bench.until("the end", 1000, |bench| bench.ended().is_some());
    bench.events.clear();
    bench.done(Command::Jog(Push { drive_code: 3000, bounds: Bounds { max_ticks: 100, ..Bounds::default() } }));
    bench.until("the end", 1000, |bench| bench.ended().is_some());
    let slow = bench.machine.slow_functions();
    assert!(slow.is_empty(), "the tick runs from flash: {slow:?}");
}
