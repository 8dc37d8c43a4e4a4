//! From power-on to the first answer.

use breakaway_core::link::Command;

use crate::machine::board;

/// What `breakaway device --port PORT info` asks, on the emulated LPUART.
#[test]
fn it_boots_and_says_what_it_is() {
    needs_unicorn!();
    let mut bench = board();
    let info = bench.info();
    assert_eq!((info.board.as_str(), info.tick_hz), ("nucleo-g474re", 10_000));
    assert_eq!(bench.fault(), None);
    // It has started once, ticks, and drives nothing.
    assert_eq!(bench.machine.resets, 0);
    assert!(bench.machine.ticks.len() > 20);
    assert_eq!(bench.machine.bus().driven_at, 0);
}

/// A reboot by command is a reset by the program, after which it answers again.
#[test]
fn it_reboots_by_command() {
    needs_unicorn!();
    let mut bench = board();
    bench.done(Command::Reboot);
    bench.started();
    assert_eq!((bench.machine.resets, bench.fault()), (1, None));
}
