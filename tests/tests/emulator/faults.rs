//! The faults of docs/faults.md on the board's registers: the drive goes off within the stated ticks, the cause is kept.

use breakaway_core::link::{Command, Ending, Event, FaultCause, FaultRecord, Limit, Reply};
use breakaway_emulator::bench::{Bench, MS, TICK};

use crate::machine::{axis_with, relay, run_relay};

/// Ticks of a drive without motion that the tests allow: 0.2 s.
const FROZEN_TICKS: u32 = 2000;
/// Half a cycle of the relay experiment, ticks: until both relays push the same way (T = 0.73 s).
const HALF_CYCLE: u64 = 3660;

/// A relay experiment after its first cycle.
fn swing() -> Bench {
    let mut bench = axis_with(|settings| {
        settings.frozen_ticks = FROZEN_TICKS as _;
        settings.overrun_limit = 1;
        settings.command_timeout_ms = 500;
    });
    bench.done(Command::StreamOn { decimation: 10 });
    bench.done(relay(2.0, 1.5, 0));
    bench.run(800 * MS);
    assert!(bench.machine.bus().driven_at + 100 * MS > bench.now(), "it is not driven");
    bench
}

/// Breaks something: the last drive is within `ticks` of it, and half a period of the PWM, in which TIM1 acts. An accident
/// that takes time, a halt, is not driven through: a board that goes on has the same time from there.
fn breaks(bench: &mut Bench, ticks: u64, cause: FaultCause, accident: impl FnOnce(&mut Bench)) -> FaultRecord {
    let before = bench.now();
    accident(bench);
    let at = bench.now();
    let through = bench.machine.bus().driven_at.saturating_sub(before);
    assert!(through <= TICK / 4, "{cause:?}: driven for {} ticks through it", through as f64 / TICK as f64);
    bench.until("the fault", 2000, |bench| bench.ended().is_some());
    bench.run(20 * MS);
    let record = bench.fault().expect("a latched fault");
    assert_eq!(record.cause, cause, "{record:?}");
    assert!(bench.events.contains(&Event::FaultRaised(record)));
    assert_eq!(bench.ended().unwrap().ending, Ending::Fault(cause));
    let driven = bench.machine.bus().driven_at.saturating_sub(at);
    assert!(driven <= ticks * TICK + TICK / 4, "{cause:?}: driven for {} ticks more", driven as f64 / TICK as f64);
    let gap = bench.samples.windows(2).find(|pair| pair[1].tick != pair[0].tick + 10);
    assert!(gap.is_none(), "samples are missing: {gap:?}");
    record
}

#[test]
fn a_frozen_encoder_and_a_dead_channel() {
    needs_unicorn!();
    for dead_channel in [false, true] {
        let record =
            breaks(&mut swing(), u64::from(FROZEN_TICKS) + HALF_CYCLE + 2, FaultCause::EncoderFrozen, |bench| {
                let plant = &mut bench.machine.bus().plant;
                if dead_channel { plant.kill_channel() } else { plant.freeze() }
            });
        assert_eq!((record.value, record.limit), (FROZEN_TICKS as i32, FROZEN_TICKS as i32));
    }
}

/// The count jumps; and TIM2 says that both channels have changed at once. A fault that lasts is not cleared.
#[test]
fn an_encoder_that_jumps_and_one_with_a_transition_error() {
    needs_unicorn!();
    let record = breaks(&mut swing(), 2, FaultCause::EncoderJump, |bench| bench.machine.bus().plant.jump(5000));
    assert!(record.value > 4900, "{record:?}");
    let mut bench = swing();
    breaks(&mut bench, 2, FaultCause::EncoderError, |bench| bench.machine.bus().transition_error = true);
    assert!(matches!(bench.request(Command::ClearFault), Reply::Error(_)));
    bench.machine.bus().transition_error = false;
    bench.done(Command::ClearFault);
}

#[test]
fn a_reversed_encoder() {
    needs_unicorn!();
    let mut bench = axis_with(|_| {});
    bench.machine.bus().plant.reverse();
    let ended = run_relay(&mut bench, 2.0, 1.5, 40_000);
    assert_eq!(ended.ending, Ending::Fault(FaultCause::WrongDirection));
    // 86 of the 6283 counts of a revolution, as docs/faults.md has it: less than a tenth of a radian.
    assert!(bench.machine.bus().plant.position().abs() < 0.1);
}

/// A tick that starts 0.6 of a period late, and a core that a debugger halts for 20 ms. Halted, TIM1 stops by itself.
#[test]
fn a_late_tick_and_a_halted_core() {
    needs_unicorn!();
    breaks(&mut swing(), 2, FaultCause::TickOverrun, |bench| bench.machine.late = TICK * 6 / 10);
    breaks(&mut swing(), 0, FaultCause::TickOverrun, |bench| bench.machine.halt(20 * MS));
}

/// The last command came at most 0.1 s before the silence, which the board allows for 0.5 s.
#[test]
fn a_silent_host() {
    needs_unicorn!();
    let mut bench = swing();
    bench.alive = false;
    let record = breaks(&mut bench, 5002, FaultCause::LinkLost, |_| {});
    assert_eq!((record.value, record.limit), (500, 500));
}

/// TIM1 by itself: no tick is waited for. What lasts is not cleared.
#[test]
fn an_emergency_stop() {
    needs_unicorn!();
    let mut bench = swing();
    breaks(&mut bench, 0, FaultCause::EmergencyStop, |bench| bench.machine.emergency_stop(true));
    assert!(matches!(bench.request(Command::ClearFault), Reply::Error(_)));
    bench.machine.emergency_stop(false);
    bench.done(Command::ClearFault);
    assert_eq!(bench.fault(), None);
}

#[test]
fn a_supply_that_dips_and_a_core_that_locks_up() {
    needs_unicorn!();
    breaks(&mut swing(), 0, FaultCause::BreakInput, |bench| bench.machine.supply_dips());
    breaks(&mut swing(), 0, FaultCause::BreakInput, |bench| bench.machine.locks_up());
}

/// A limit ends the run, is no fault, and the next run may start.
#[test]
fn a_travel_limit() {
    needs_unicorn!();
    let mut bench = axis_with(|settings| settings.travel_max_counts = 300);
    let ended = run_relay(&mut bench, 2.0, 1.5, 0);
    assert!(matches!(ended.ending, Ending::Limit { limit: Limit::Travel, .. }), "{ended:?}");
    assert_eq!(bench.fault(), None);
    bench.run(5 * MS);
    assert!(bench.machine.bus().driven_at + 4 * MS < bench.now());
}

/// Each cause is provoked in this program, or cannot be on this board.
#[test]
fn every_fault_is_provoked() {
    let elsewhere = [
        (FaultCause::Supply, "the board does not measure the supply"),
        (FaultCause::DriveStage, "writing TIM1's registers cannot fail"),
        (FaultCause::ModelLost, "a record whose sum is right and whose model is none is in the storage's own test"),
        (FaultCause::NotFinite, "no command makes the image's controllers compute it"),
    ];
    let source = concat!(
        include_str!("current.rs"),
        include_str!("faults.rs"),
        include_str!("flash.rs"),
        include_str!("resets.rs")
    );
    for cause in FaultCause::ALL {
        let name = format!("FaultCause::{cause:?}");
        let named = source.matches(&format!("{name})")).count() + source.matches(&format!("{name},")).count();
        assert!(named > 0, "{name} is neither provoked nor listed");
        assert_eq!(
            elsewhere.iter().any(|(other, _)| *other == cause),
            source.contains(&format!("({name}, \"")),
            "{name}"
        );
    }
}
