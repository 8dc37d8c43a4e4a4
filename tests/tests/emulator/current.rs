//! The motor's current: from the winding through amplifier, ADC and comparators, on the board's registers.

use breakaway::identify::estimate::{identify, mechanical};
use breakaway::recording::{Recording, Units};
use breakaway_core::link::{Command, DriveUnit, Ending, FaultCause, Limit, Reply, Sample, Settings};
use breakaway_emulator::bench::{Bench, MS, TICK};
use breakaway_emulator::winding::Winding;

use crate::machine::{relay, scaled};

/// A winding for the papers' axis: 2 Ω, 2 mH, 50 mV·s/rad of the c of 110. It has a ripple of 15 mA at 20 kHz from 5 V.
const WINDING: Winding = Winding { resistance: 2.0, inductance: 2e-3, back_emf: 0.05, supply: 5.0, current: 0.0 };
/// A code of the ADC, mA.
const CODE_MA: f64 = 1.611;
/// Half a period of the PWM: the emulation's step.
const HALF_PERIOD: u64 = TICK / 4;

/// The axis with a winding, its settings made for it and changed.
pub fn wound(change: impl FnOnce(&mut Settings)) -> Bench {
    wound_by(WINDING, change)
}

fn wound_by(winding: Winding, change: impl FnOnce(&mut Settings)) -> Bench {
    let bench = Bench::with_winding(winding).unwrap_or_else(|error| panic!("{error}"));
    scaled(bench, change)
}

/// A constant drive that moves nothing: what flows after 20 time constants is u/R. The samples have it to a code of the ADC, as offset
/// and reading are rounded, and 1 mA. The dead time shifts the pulse by 0.25 µs, which makes 1.1 mA more. The ripple of 20 mA is none of it.
#[test]
fn the_sample_in_the_middle_of_the_pulse_is_the_mean_current() {
    needs_unicorn!();
    let winding = Winding { inductance: 1e-3, back_emf: 0.0, ..WINDING };
    for volts in [0.2, -0.2, 0.45] {
        let mut bench = wound_by(winding, |_| {});
        assert_eq!(bench.info().current_range_ma, 2900);
        bench.done(Command::StreamOn { decimation: 1 });
        bench.done(crate::machine::push(volts, 400));
        bench.until("the end", 200, |bench| bench.ended().is_some());
        bench.run(5 * MS);
        let steady: Vec<Sample> =
            bench.samples.iter().copied().filter(|sample| sample.drive_code != 0).skip(100).collect();
        assert!(steady.len() > 250, "{}", steady.len());
        for sample in &steady {
            let applied = f64::from(sample.drive_code) / 32_767.0 * 5.0;
            let (expected, found) = (1000.0 * applied / winding.resistance, f64::from(sample.current_ma.unwrap()));
            assert!((found - expected).abs() < CODE_MA + 2.1, "{volts} V: {found} mA, expected {expected}");
        }
        // Off, nothing flows.
        assert!(bench.samples.last().unwrap().current_ma.unwrap().abs() < 3);
    }
}

/// An amplifier whose middle is off by 2 % is measured at the start; by 6 %, or with a wire off, it is none.
#[test]
fn the_offset_is_measured_and_an_implausible_one_is_no_measurement() {
    needs_unicorn!();
    for (offset, cut, measured) in [
        (0.066, [false; 2], true),
        (-0.066, [false; 2], true),
        (0.2, [false; 2], false),
        (0.0, [true, false], false),
        (0.0, [false, true], false),
    ] {
        let mut bench = Bench::with_amplifier(WINDING, offset, cut).unwrap_or_else(|error| panic!("{error}"));
        let range = bench.info().current_range_ma;
        assert_eq!(range > 0, measured, "{offset} V, {cut:?}");
        bench.done(Command::StreamOn { decimation: 10 });
        bench.run(20 * MS);
        let expected = measured.then_some(0);
        assert!(bench.samples.iter().all(|sample| sample.current_ma.map(|now| now / 2) == expected), "{offset} V");
        let settings = Settings { current_max_ma: 1000, ..bench.settings() };
        assert_eq!(matches!(bench.request(Command::SetSettings(settings)), Reply::Done), measured);
    }
}

/// A short circuit of the winding during a run: the comparators open the bridge within half a period of the PWM, either way.
#[test]
fn an_over_current_opens_the_bridge_within_the_period() {
    needs_unicorn!();
    for volts in [0.4, -0.4] {
        let mut bench = wound(|settings| settings.current_max_ma = 1000);
        bench.done(crate::machine::push(volts, 5000));
        bench.run(50 * MS);
        assert!(bench.machine.bus().driven_at + TICK > bench.now());
        let at = bench.now();
        // Of 0.1 Ω and 2 µH little is left: 0.4 V drives 4 A, which are 1.5 A after 9 µs.
        let winding = bench.machine.bus().winding.as_mut().unwrap();
        (winding.resistance, winding.inductance) = (0.1, 2e-6);
        bench.until("the fault", 100, |bench| bench.ended().is_some());
        let driven = bench.machine.bus().driven_at.saturating_sub(at);
        // The step under way, and the one in which the level is reached.
        assert!(driven <= 2 * HALF_PERIOD, "driven for {} µs more", driven / 170);
        let fault = bench.fault().unwrap();
        assert_eq!((fault.cause, fault.limit), (FaultCause::OverCurrent, 1500));
        assert_eq!(bench.ended().unwrap().ending, Ending::Fault(FaultCause::OverCurrent));
        // It is gone, and can be cleared; the emergency stop is another fault.
        bench.run(MS);
        bench.done(Command::ClearFault);
        bench.machine.emergency_stop(true);
        bench.machine.emergency_stop(false);
        bench.run(MS);
        assert_eq!(bench.fault(), None);
    }
}

/// Above the setting and below the comparators' level for 10 ticks: the run ends, and is no fault.
#[test]
fn the_limit_of_the_current_ends_the_run() {
    needs_unicorn!();
    let mut bench = wound(|settings| settings.current_max_ma = 200);
    bench.done(Command::StreamOn { decimation: 1 });
    // 0.45 V into 2 Ω are 219 mA with the dead time: below 300.
    bench.done(crate::machine::push(0.5, 5000));
    bench.until("the end", 100, |bench| bench.ended().is_some());
    let ended = bench.ended().unwrap();
    let Ending::Limit { limit: Limit::Current, value } = ended.ending else { panic!("{ended:?}") };
    assert!((201..260).contains(&value), "{value} mA");
    assert_eq!(bench.fault(), None);
    bench.run(5 * MS);
    let above = bench.samples.iter().filter(|sample| sample.current_ma.is_some_and(|now| now > 200)).count();
    assert!((10..=13).contains(&above), "{above} ticks above the limit");
}

/// One of the two wires comes off during a run with a limit: a fault after three ticks.
#[test]
fn a_wire_that_comes_off_is_a_fault_of_the_sensor() {
    needs_unicorn!();
    for wire in [0, 1] {
        let mut bench = wound(|settings| settings.current_max_ma = 1000);
        bench.done(relay(0.9, 0.8, 0));
        bench.run(100 * MS);
        let at = bench.now();
        // Of the level below, the comparator sees more: then it is an over-current, and as safe.
        bench.machine.bus().analog.cut[wire] = true;
        bench.until("the fault", 100, |bench| bench.ended().is_some());
        let driven = bench.machine.bus().driven_at.saturating_sub(at);
        assert!(driven <= 4 * TICK, "driven for {} ticks more", driven as f64 / TICK as f64);
        let cause = bench.fault().unwrap().cause;
        assert_eq!(cause, [FaultCause::CurrentSensor, FaultCause::OverCurrent][wire], "wire {wire}");
    }
}

/// Full scale of a drive in A.
const FULL_A: f64 = 2.9;

/// The axis with its drive in A, by the current loop of the winding's name plate.
pub fn regulated() -> Bench {
    wound(|settings| {
        settings.drive_unit = DriveUnit::Ampere;
        settings.drive_full_scale = FULL_A as f32;
        settings.supply_v = WINDING.supply as f32;
        settings.motor_resistance_ohm = WINDING.resistance as f32;
        settings.motor_inductance_h = WINDING.inductance as f32;
    })
}

/// As the drive in V that has the same code.
fn as_volts(amperes: f64) -> f64 {
    amperes / FULL_A * 5.0
}

/// 0.2 A are below break-away. The loop has 833 Hz. Within ten of its time constants, 2 ms, the current is there to a code of the ADC
/// and a half. It does not overshoot by more than a twelfth.
#[test]
fn the_current_loop_follows_a_step() {
    needs_unicorn!();
    for amperes in [0.2, -0.2] {
        let mut bench = regulated();
        bench.done(Command::StreamOn { decimation: 1 });
        bench.done(crate::machine::push(as_volts(amperes), 400));
        bench.until("the end", 200, |bench| bench.ended().is_some());
        bench.run(5 * MS);
        let run: Vec<Sample> = bench.samples.iter().copied().filter(|sample| sample.drive_code != 0).collect();
        assert!(run.len() > 350, "{}", run.len());
        let currents: Vec<f64> =
            run.iter().map(|sample| f64::from(sample.current_ma.unwrap()) / (1000.0 * amperes)).collect();
        println!("{:?}", &currents[..25]);
        assert!(currents.iter().all(|share| *share < 1.0 + 1.0 / 12.0 + 0.012), "{:?}", &currents[..30]);
        assert!(
            currents[20..].iter().all(|share| (share - 1.0).abs() < 1.5 * CODE_MA / 200.0),
            "{:?}",
            &currents[20..40]
        );
        assert!(bench.fault().is_none());
    }
}

/// A relay experiment in A, with the back-EMF of a moving axis against the loop. 3 ms after each reversal the current is what is recorded as
/// drive, to 5 %. The back-EMF rises by at most 5 V·s⁻¹, which a loop of 5200 rad/s follows to 1 mA.
#[test]
fn a_relay_experiment_is_driven_by_currents() {
    needs_unicorn!();
    let mut bench = regulated();
    bench.done(Command::StreamOn { decimation: 1 });
    bench.done(relay(as_volts(0.6), as_volts(0.3), 8000));
    bench.until("the end", 1500, |bench| bench.ended().is_some());
    assert_eq!(bench.ended().unwrap().ending, Ending::TimeUp);
    let run: Vec<Sample> = bench.samples.iter().copied().filter(|sample| sample.drive_code != 0).collect();
    let mut settled = 0;
    for window in run.windows(31) {
        if window.iter().all(|sample| sample.drive_code == window[0].drive_code) {
            let asked = f64::from(window[30].drive_code) / 32_767.0 * 1000.0 * FULL_A;
            let found = f64::from(window[30].current_ma.unwrap());
            assert!((found - asked).abs() < 0.05 * asked.abs(), "{found} mA of {asked}");
            settled += 1;
        }
    }
    assert!(settled > 5000, "{settled}");
    let turned = run.iter().map(|sample| sample.count.abs()).max().unwrap();
    // It turns by some 60 mrad: the back-EMF has both signs, and is up to a tenth of R·i.
    assert!(turned > 40, "{turned} counts");
}

/// The limit and the comparators hold with the current loop too. 0.5 A against a limit of 0.4 A ends the run after 1 ms. A winding
/// that is shorted opens the bridge within the two steps, as under a voltage.
#[test]
fn the_limits_of_the_current_hold_under_the_current_loop() {
    needs_unicorn!();
    let mut bench = regulated();
    let settings = Settings { current_max_ma: 400, ..bench.settings() };
    bench.done(Command::SetSettings(settings));
    bench.done(crate::machine::push(as_volts(0.5), 5000));
    bench.until("the end", 100, |bench| bench.ended().is_some());
    let Ending::Limit { limit: Limit::Current, value } = bench.ended().unwrap().ending else { panic!("no limit") };
    // Between the limit and the half an ampere with its overshoot.
    assert!((401..545).contains(&value), "{value} mA");
    assert_eq!(bench.fault(), None);
    bench.events.clear();
    bench.done(crate::machine::push(as_volts(0.2), 5000));
    bench.run(20 * MS);
    let at = bench.now();
    assert!(bench.machine.bus().driven_at + TICK > at);
    let winding = bench.machine.bus().winding.as_mut().unwrap();
    // The 0.4 V of the tick under way are 0.6 A, which is the comparators' level, after 2 µs.
    (winding.resistance, winding.inductance) = (0.1, 2e-6);
    bench.until("the fault", 100, |bench| bench.ended().is_some());
    assert_eq!(bench.ended().unwrap().ending, Ending::Fault(FaultCause::OverCurrent));
    let driven = bench.machine.bus().driven_at.saturating_sub(at);
    assert!(driven <= 2 * HALF_PERIOD, "driven for {} µs more", driven / 170);
}

/// From what the board streams of a relay experiment in V: R and Ke of the winding, and with them the viscous friction. The dead time
/// of 0.25 µs in 50 takes 0.5 % of the voltage where the current is largest: that is R's bar, and twice it Ke's. The friction is c of
/// 3 s less Ke: within its three standard errors.
#[test]
fn resistance_and_back_emf_are_in_what_the_board_streams() {
    needs_unicorn!();
    let mut bench = wound(|_| {});
    bench.done(Command::StreamOn { decimation: 1 });
    let recordings = [(2.0, 1.5), (1.0, 0.7)].map(|(h1, h2)| {
        bench.events.clear();
        bench.samples.clear();
        bench.done(relay(h1, h2, 15_000));
        bench.until("the end", 2000, |bench| bench.ended().is_some());
        bench.run(5 * MS);
        let run: Vec<Sample> = bench.samples.iter().copied().filter(|sample| sample.drive_code != 0).collect();
        assert!(run.windows(2).all(|pair| pair[1].tick == pair[0].tick + 1) && run.len() > 14_000);
        let column = |of: fn(&Sample) -> f64| run.iter().map(of).collect();
        Recording {
            t: column(|sample| 1e-4 * f64::from(sample.tick)),
            u: column(|sample| 5.0 * f64::from(sample.drive_code) / 32_767.0),
            x: column(|sample| 1e-3 * f64::from(sample.count)),
            current: column(|sample| 1e-3 * f64::from(sample.current_ma.unwrap())),
            encoder_step: Some(1e-3),
            units: Units { u: "V".into(), x: "rad".into() },
            ..Recording::default()
        }
    });
    let identified = identify(&recordings).unwrap();
    let found = identified.winding.unwrap();
    let viscous = mechanical(identified.best.c, found.back_emf);
    println!("{found:?}, c {:?}, viscous {viscous:?}", identified.best.c);
    let inductance = found.inductance.unwrap();
    assert!((found.resistance.value / WINDING.resistance - 1.0).abs() < 0.005, "{found:?}");
    assert!((found.back_emf.value / WINDING.back_emf - 1.0).abs() < 0.01, "{found:?}");
    // Too large by R times the delay from the sample to the voltage, at most half a tick.
    let more = inductance.value - WINDING.inductance;
    assert!((0.0..WINDING.resistance * 50e-6).contains(&more), "{inductance:?}");
    assert!((viscous.value - 0.11 + WINDING.back_emf).abs() < 3.0 * viscous.se, "{viscous:?}");
}
