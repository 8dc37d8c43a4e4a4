//! The motor's current: in the samples, and limited.

use breakaway_core::link::{
    Bounds, Command, CommandError, DriveUnit, Ending, FaultCause, Field, Limit, Mode, Push, Reply, Settings,
};
use breakaway_firmware::board::{RETAINED_WORDS, Trip};
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

/// A winding behind the bridge, which is at its drive code for a tick.
struct Winding {
    resistance: f64,
    inductance: f64,
    supply: f64,
    current: f64,
}

impl Winding {
    const MOTOR: Self = Self { resistance: 2.0, inductance: 4e-3, supply: 5.0, current: 0.0 };

    /// One tick of board and winding; the current, mA, as the board has it from now on.
    fn step(&mut self, bench: &mut Bench) -> i32 {
        bench.steps(1);
        let volts = f64::from(bench.world.0.borrow().drive) / 32_767.0 * self.supply;
        let end = volts / self.resistance;
        self.current = end + (self.current - end) * (-1e-3 * self.resistance / self.inductance).exp();
        let milliamperes = (1000.0 * self.current).round() as i32;
        bench.world.0.borrow_mut().current_ma = Some(milliamperes);
        milliamperes
    }
}

/// Settings of a drive in A: 3 A at full scale.
fn amperes() -> Settings {
    Settings {
        drive_unit: DriveUnit::Ampere,
        drive_full_scale: 3.0,
        supply_v: 5.0,
        motor_resistance_ohm: 2.0,
        motor_inductance_h: 4e-3,
        ..settings()
    }
}

/// Drive codes of half an ampere.
const HALF: i16 = 5461;

/// A push of half an ampere, whose bridge has so many volts.
fn pushed(supply: f64) -> (Bench, Winding) {
    let world = World { current_ma: Some(0), current_range_ma: 3000, ..World::default() };
    let mut bench = Bench::on(world, Loaded::defaults(Settings { supply_v: supply as f32, ..amperes() }));
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    let bounds = Bounds { max_ticks: 150, ..Bounds::default() };
    assert_eq!(bench.command(Command::Jog(Push { drive_code: HALF, bounds })), Reply::Done);
    (bench, Winding { supply, ..Winding::MOTOR })
}

/// With 60° of phase the step overshoots by less than a twelfth. It is there after ten time constants of the loop, 1.9
/// ms each, to a mA of the reading and one of the drive code. What is recorded as drive is the current that was asked
/// for.
#[test]
fn the_current_loop_follows_a_step() {
    let (mut bench, mut winding) = pushed(5.0);
    let currents: Vec<i32> = (0..100).map(|_| winding.step(&mut bench)).collect();
    assert!(currents.iter().all(|now| *now < 542), "{currents:?}");
    assert!(currents[20..].iter().all(|now| (now - 500).abs() <= 2), "{currents:?}");
    bench.steps(5);
    let driven: Vec<_> = bench.samples.iter().filter(|sample| sample.mode == Mode::Drive).collect();
    // The last ones wait for their batch to be full.
    assert!(driven.len() > 70, "{}", driven.len());
    assert!(driven.iter().all(|sample| sample.drive_code == HALF), "{driven:?}");
}

/// 0.8 V into 2 Ω are 0.4 A, whatever is asked for: that is what is recorded.
#[test]
fn where_the_voltage_does_not_suffice_the_measured_current_is_recorded() {
    let (mut bench, mut winding) = pushed(0.8);
    (0..100).for_each(|_| {
        winding.step(&mut bench);
    });
    let sample = bench.samples.last().copied().unwrap();
    assert!((sample.current_ma.unwrap() - 400).abs() <= 1, "{sample:?}");
    let recorded = f64::from(sample.drive_code) / 32_767.0 * 3000.0;
    assert!((recorded - 400.0).abs() < 2.0, "{recorded} mA of {sample:?}");
}

#[test]
fn a_current_loop_that_cannot_be_closed_is_refused() {
    let mut bench = Bench::new();
    let set = |bench: &mut Bench, settings| bench.command(Command::SetSettings(settings));
    let refused = |field| Reply::Error(CommandError::Settings(field));
    assert_eq!(set(&mut bench, amperes()), refused(Field::DriveUnit));
    let mut bench = measured(0);
    assert_eq!(bench.command(Command::Stop), Reply::Done);
    assert_eq!(set(&mut bench, Settings { motor_resistance_ohm: 0.0, ..amperes() }), refused(Field::Resistance));
    assert_eq!(set(&mut bench, Settings { drive_full_scale: 3.1, ..amperes() }), refused(Field::DriveMax));
    assert_eq!(
        set(&mut bench, Settings { current_bandwidth_hz: 200.0, ..amperes() }),
        refused(Field::CurrentBandwidth)
    );
    assert_eq!(set(&mut bench, Settings { motor_inductance_h: 0.0, ..amperes() }), Reply::Done);
    assert_eq!(set(&mut bench, amperes()), Reply::Done);
    // Settings from the flash of a board whose amplifier is gone: nothing starts.
    let mut bench = Bench::loaded([0; RETAINED_WORDS], Loaded::defaults(amperes()));
    assert_eq!(bench.command(Command::StartRelay(relay(2.0, 1.5, 0))), refused(Field::DriveUnit));
}

/// A simulated machine may have its drive in A, as its model has. It closes no loop, and refuses to be told of a winding.
#[test]
fn a_simulated_machine_takes_a_drive_in_amperes_as_it_is() {
    let world = World { simulated: true, ..World::default() };
    let mut bench = Bench::on(world, Loaded::defaults(settings()));
    let machine = Settings { motor_resistance_ohm: 0.0, ..amperes() };
    assert_eq!(bench.command(Command::SetSettings(machine)), Reply::Done);
    let push = Push { drive_code: HALF, bounds: Bounds { max_ticks: 10, ..Bounds::default() } };
    assert_eq!(bench.command(Command::Jog(push)), Reply::Done);
    bench.steps(5);
    assert_eq!(bench.world.0.borrow().drive, HALF);
    bench.steps(20);
    let refused = Reply::Error(CommandError::Settings(Field::DriveUnit));
    assert_eq!(bench.command(Command::SetSettings(amperes())), refused);
}

/// Without a reading there is no loop, whether or not the current is limited.
#[test]
fn a_current_loop_without_a_reading_is_a_fault() {
    let (mut bench, mut winding) = pushed(5.0);
    (0..50).for_each(|_| {
        winding.step(&mut bench);
    });
    bench.world.0.borrow_mut().current_ma = None;
    bench.steps(1);
    assert!(!bench.world.0.borrow().enabled);
    assert_eq!(bench.fault().map(|fault| fault.cause), Some(FaultCause::CurrentSensor));
}
