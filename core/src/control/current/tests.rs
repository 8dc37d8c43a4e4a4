//! What the current loop does to a winding, whose current between ticks is in closed form.

extern crate std;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::scalar::Q32;

const TICK_S: f64 = 1e-4;
/// From the reading to the middle of the hold: a quarter of a tick until the voltage changes, and half of one.
const DELAY_S: f64 = 0.75 * TICK_S;
/// 2 Ω, 2 mH: a = 0.905.
const WINDING: Winding = Winding { resistance: 2.0, inductance: 2e-3 };

fn designed<R: Real>(winding: Winding) -> CurrentLoop<R> {
    CurrentLoop::new(&winding, 0.0, TICK_S, DELAY_S, 1.0, 1.0).unwrap()
}

/// Currents at the ticks after a step of the reference, in a voltage of at most ±`limit`. The voltage takes hold a
/// quarter of a tick after the reading. `back_emf` is added from the middle on.
fn step<R: Real>(design: Winding, truth: Winding, reference: f64, limit: f64, back_emf: f64) -> Vec<f64> {
    let control = designed::<R>(design);
    let mut state = CurrentLoopState::default();
    let (mut i, mut held) = (0.0_f64, 0.0);
    let mut currents = Vec::new();
    let pole = |share: f64| libm::exp(-truth.resistance * share * TICK_S / truth.inductance);
    for k in 0..400 {
        currents.push(i);
        let u = control.drive(&mut state, R::from_f64(reference), R::from_f64(i)).to_f64();
        let applied = u.clamp(-limit, limit);
        if applied == u {
            control.update(&mut state);
        } else {
            control.cut(&mut state, R::from_f64(applied - u));
        }
        let against = if k < 200 { 0.0 } else { back_emf };
        for (volts, share) in [(held, 0.25), (applied, 0.75)] {
            let end = (volts - against) / truth.resistance;
            i = end + (i - end) * pole(share);
        }
        held = applied;
    }
    currents
}

/// kp and ki are those of the module's equation, with the winding's own a.
#[test]
fn it_is_the_formula() {
    let bandwidth = 1500.0;
    let control = CurrentLoop::<f64>::new(&WINDING, bandwidth, TICK_S, DELAY_S, 1.0, 1.0).unwrap();
    let a = libm::exp(-0.1);
    let ki = bandwidth * TICK_S * 2.0;
    assert!((control.integral / ki - 1.0).abs() < 1e-12);
    assert!((control.proportional / (a * ki / (1.0 - a)) - 1.0).abs() < 1e-12);
    // Slow beside L/R, kp is ωc·L to the order of R·Ts/L.
    assert!((control.proportional / (bandwidth * 2e-3) - 1.0).abs() < 0.06);
    // In codes of 5 V/32767 and in mA.
    let scaled = CurrentLoop::<f64>::new(&WINDING, bandwidth, TICK_S, DELAY_S, 32_767.0 / 5.0, 1000.0).unwrap();
    assert!((scaled.proportional / control.proportional - 32.767 / 5.0).abs() < 1e-9);
}

/// The largest bandwidth has 60° of phase. The step overshoots by at most a twelfth. It is within 1 % after 3 ms, 20
/// of the loop's time constants. A back-EMF E makes an error of at most E/kp, which decays with L/R, and with ωc where
/// that is slower.
#[test]
fn a_step_is_followed_at_any_inductance_and_a_back_emf_is_made_up_for() {
    for inductance in [2e-2, 2e-3, 2e-4, 2e-5] {
        let winding = Winding { inductance, ..WINDING };
        let currents = step::<f64>(winding, winding, 0.5, f64::INFINITY, 0.3);
        let left = 0.3 / designed::<f64>(winding).proportional * libm::exp(-200.0 * TICK_S * 2.0 / inductance);
        let peak = currents[..200].iter().copied().fold(0.0, f64::max);
        assert!(peak < 0.5 * (1.0 + 1.0 / 12.0), "{inductance} H: {peak}");
        assert!(currents[30..200].iter().all(|i| (i - 0.5).abs() < 0.005), "{inductance} H: {:?}", &currents[..30]);
        assert!((currents[399] - 0.5).abs() < 1.1 * left + 1e-9, "{inductance} H: {}, {left}", currents[399]);
    }
}

/// From R alone the loop is ten times as slow, and stays stable for an L/R of ten delays.
#[test]
fn from_the_resistance_alone_it_is_slower_and_stable() {
    let blind = Winding { inductance: 0.0, ..WINDING };
    for inductance in [2e-5, 2e-4, 10.0 * DELAY_S * 2.0] {
        let currents = step::<f64>(blind, Winding { inductance, ..WINDING }, 0.5, f64::INFINITY, 0.0);
        assert!((currents[399] - 0.5).abs() < 0.005, "{inductance} H: {}", currents[399]);
        assert!(currents.iter().all(|i| *i < 0.5 * 1.25), "{inductance} H");
    }
}

/// At a voltage that only just suffices the integral does not wind up: after it the current does not overshoot more
/// than without a limit. A reversal that is cut for some ticks has none of the slow pole a behind it. After 20 ticks 1
/// % is left, as of one that is not cut.
#[test]
fn the_integral_goes_back_by_what_is_cut_off() {
    let free = step::<f64>(WINDING, WINDING, 0.5, f64::INFINITY, 0.0);
    let cut = step::<f64>(WINDING, WINDING, 0.5, 1.1, 0.0);
    let peak = |currents: &[f64]| currents.iter().copied().fold(0.0, f64::max);
    assert!(peak(&cut) <= peak(&free) + 1e-9, "{} {}", peak(&cut), peak(&free));
    assert!((cut[199] - 0.5).abs() < 1e-6);
    let reversed = step::<f64>(WINDING, WINDING, 1.8, 6.0, 0.0);
    assert!(reversed[30..200].iter().all(|i| (i / 1.8 - 1.0).abs() < 0.01), "{:?}", &reversed[..40]);
    // What cannot be reached is not asked for ever more: the integral goes to what is applied, within 70 time constants.
    let control = designed::<f64>(WINDING);
    let mut state = CurrentLoopState::default();
    for _ in 0..1000 {
        let u = control.drive(&mut state, 2.0, 0.5);
        control.cut(&mut state, 1.0 - u);
    }
    assert!((state.integral - 1.0).abs() < 1e-9, "{}", state.integral);
}

/// The same step in f64, f32 and Q32: f32 has 24 bits of currents and voltages of about 1, Q32 2.3e-10.
#[test]
fn scalars_agree() {
    let exact = step::<f64>(WINDING, WINDING, 0.5, 3.0, 0.3);
    for (found, allowed) in
        [(step::<f32>(WINDING, WINDING, 0.5, 3.0, 0.3), 1e-6), (step::<Q32>(WINDING, WINDING, 0.5, 3.0, 0.3), 1e-8)]
    {
        for (found, exact) in found.iter().zip(&exact) {
            assert!((found - exact).abs() < allowed, "{found} {exact}");
        }
    }
}

#[test]
fn what_is_no_winding_or_no_bandwidth_is_refused() {
    let made = |winding, bandwidth, tick_s, delay_s| {
        CurrentLoop::<f32>::new::<f64>(&winding, bandwidth, tick_s, delay_s, 1.0, 1.0).err()
    };
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            made(Winding { resistance: wrong, ..WINDING }, 0.0, TICK_S, DELAY_S),
            Some(CurrentLoopError::Resistance)
        );
        assert_eq!(made(WINDING, 0.0, wrong, DELAY_S), Some(CurrentLoopError::Tick));
        assert_eq!(made(WINDING, 0.0, TICK_S, wrong), Some(CurrentLoopError::Tick));
    }
    for wrong in [-1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            made(Winding { inductance: wrong, ..WINDING }, 0.0, TICK_S, DELAY_S),
            Some(CurrentLoopError::Inductance)
        );
        assert_eq!(made(WINDING, wrong, TICK_S, DELAY_S), Some(CurrentLoopError::Bandwidth));
    }
    let largest = WINDING.largest_bandwidth(DELAY_S);
    assert_eq!(made(WINDING, largest, TICK_S, DELAY_S), None);
    assert_eq!(made(WINDING, 1.01 * largest, TICK_S, DELAY_S), Some(CurrentLoopError::Bandwidth));
}

/// The share of `reference` by which the current goes past it, and that it misses in the last 50 ticks.
fn past_and_missed(currents: &[f64], reference: f64) -> (f64, f64) {
    let shares = || currents[..200].iter().map(|i| i / reference - 1.0);
    (shares().fold(0.0, f64::max), shares().skip(150).map(f64::abs).fold(0.0, f64::max))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// Windings of 10 mΩ to 100 Ω, with L/R of 0.01 to 1000 ticks (1 µs to 0.1 s). With its own numbers a step goes
    /// past by at most a twelfth, and is reached to 1e-6. A back-EMF of a tenth of R·i leaves 2e-4 of i after 20 ms at
    /// the most. Its error 0.1·R·i/(ωc·L) decays with L/R. The product is the largest where L/R is these 20 ms.
    #[test]
    fn any_winding_is_driven(log_r in -2.0..2.0_f64, log_tau in -2.0..3.0_f64, amperes in 0.05..50.0_f64) {
        let resistance = libm::pow(10.0, log_r);
        let winding = Winding { resistance, inductance: resistance * libm::pow(10.0, log_tau) * TICK_S };
        let currents = step::<f64>(winding, winding, amperes, f64::INFINITY, 0.1 * resistance * amperes);
        let (past, missed) = past_and_missed(&currents, amperes);
        prop_assert!(past < 1.0 / 12.0 && missed < 1e-6, "past by {past}, missed by {missed}");
        prop_assert!((currents[399] / amperes - 1.0).abs() < 3e-4, "{}", currents[399]);
    }

    /// A name plate may be off by up to 30 % in R and L, either way. The current still settles, to 1 %, and goes past
    /// by less than 40 %.
    #[test]
    fn a_name_plate_may_be_off(log_tau in -1.0..2.0_f64, r in 0.7..1.3_f64, l in 0.7..1.3_f64) {
        let inductance = 2.0 * libm::pow(10.0, log_tau) * TICK_S;
        let truth = Winding { resistance: 2.0, inductance };
        let plate = Winding { resistance: 2.0 * r, inductance: inductance * l };
        let (past, missed) = past_and_missed(&step::<f64>(plate, truth, 0.5, f64::INFINITY, 0.0), 0.5);
        prop_assert!(past < 0.4 && missed < 0.01, "past by {past}, missed by {missed}");
    }

    /// A bridge of 1.05 to 3 times R·i cuts the voltage off. The current goes past by no more than without a limit,
    /// and settles.
    #[test]
    fn a_cut_voltage_winds_nothing_up(log_tau in -1.0..1.0_f64, headroom in 1.05..3.0_f64) {
        let winding = Winding { resistance: 2.0, inductance: 2.0 * libm::pow(10.0, log_tau) * TICK_S };
        let (free, _) = past_and_missed(&step::<f64>(winding, winding, 0.5, f64::INFINITY, 0.0), 0.5);
        let (past, missed) = past_and_missed(&step::<f64>(winding, winding, 0.5, headroom, 0.0), 0.5);
        prop_assert!(past <= free + 1e-9 && missed < 1e-6, "past by {past} of {free}, missed by {missed}");
    }
}
