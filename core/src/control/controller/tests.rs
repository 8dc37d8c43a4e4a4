use super::*;
use crate::control::{Adaptation, Estimates, Sine, tune};
use crate::plant::effect::{Effect, Kind};
use crate::plant::{Base, Drive, Plant};
use crate::scalar::Q32;
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const TICK: f64 = 1e-3;

fn adaptive<R: Fast>(rate: f64) -> Adaptive<R> {
    let gains = tune(BASE.b, BASE.c, 10.0, TICK, 1).unwrap();
    let start = Estimates { b: BASE.b, c: BASE.c, f1: BASE.f1, f: 0.0 };
    let adaptation = Adaptation::normalised(&start, rate, 7.0, 50.0, 0.5);
    Adaptive::new(&gains, &adaptation, &start, TICK, 1, 12.0).unwrap()
}

fn pid<R: Fast>() -> Pid<R> {
    Pid::new(&tune(BASE.b, BASE.c, 10.0, TICK, 1).unwrap(), TICK, 12.0).unwrap()
}

fn compensator<R: Fast>(effects: &[Effect<f64>]) -> Compensator<R> {
    Compensator::new(&BASE, effects).unwrap().with_lead(1.5 * TICK).unwrap()
}

/// A loop on the plant with friction and cogging, an encoder of 1e-3 rad and a tick of delay; drives and positions.
fn run<R: Fast>(controller: &Controller<R>, ticks: u32) -> Vec<[f64; 2]> {
    let effects = [Effect::new(Kind::Cogging, &[0.1, 7.0, 1.0])];
    let plant = Plant { base: BASE, effects: &effects };
    let mut motion = plant.at_rest(0.0);
    let mut state = ControllerState::start(controller);
    let sine = Sine::<R>::new(1.0, 1.0, TICK).unwrap();
    let mut pending = 0.0;
    (0..ticks)
        .map(|k| {
            let reading = libm::round(motion.x / 1e-3) * 1e-3;
            let command = controller.tick(&mut state, sine.at(k), R::from_f64(reading)).unwrap();
            let u = pending;
            pending = command.u.to_f64();
            plant.advance(&mut motion, Drive { u: &[u], ts: TICK, t: f64::from(k) * TICK }, 4);
            [pending, motion.x]
        })
        .collect()
}

/// Off is absent, bit by bit, with either law, in every number type.
#[test]
fn a_compensator_that_is_off_is_not_there() {
    fn check<R: Fast>() {
        let effects = [Effect::new(Kind::Cogging, &[0.1, 7.0, 1.0]), Effect::new(Kind::DeadZone, &[0.2])];
        for controller in [Controller::pid(pid::<R>()), Controller::adaptive(adaptive::<R>(5.0))] {
            let off = controller.with_compensator(compensator(&effects));
            let (absent, present) = (run(&controller, 2000), run(&off, 2000));
            assert!(absent.iter().zip(&present).all(|(a, b)| a.map(f64::to_bits) == b.map(f64::to_bits)));
            // The comparison can fail: on is different.
            let on = controller.with_compensator(compensator(&effects).on());
            assert!(run(&on, 2000) != absent);
        }
    }
    check::<f64>();
    check::<f32>();
    check::<Q32>();
}

/// The whole controller in f32 and Q32 against f64: tracking errors agree to 2 % of their RMS. (Trajectories of single
/// ticks differ by an encoder step wherever a rounding falls the other way.)
#[test]
fn scalars_agree() {
    fn rms<R: Fast>(adapting: bool) -> f64 {
        let effects = [Effect::new(Kind::Cogging, &[0.1, 7.0, 1.0])];
        let law = if adapting { Controller::adaptive(adaptive::<R>(5.0)) } else { Controller::pid(pid::<R>()) };
        let path = run(&law.with_compensator(compensator(&effects).on()), 6000);
        let sum: f64 = path
            .iter()
            .enumerate()
            .skip(1000)
            .map(|(k, [_, x])| {
                let e = libm::sin(core::f64::consts::TAU * (k as f64 + 1.0) * TICK) - x;
                e * e
            })
            .sum();
        libm::sqrt(sum / 5000.0)
    }
    for adapting in [false, true] {
        let exact = rms::<f64>(adapting);
        std::println!("adapting {adapting}: {exact:.3e} {:.3e} {:.3e}", rms::<f32>(adapting), rms::<Q32>(adapting));
        assert!((rms::<f32>(adapting) / exact - 1.0).abs() < 0.02 && (rms::<Q32>(adapting) / exact - 1.0).abs() < 0.02);
        // Meaningful: the error is small beside the amplitude.
        assert!(exact < 0.02, "{exact}");
    }
}

/// A drive past the limit is cut to it, and the integral goes back.
#[test]
fn the_limit_holds() {
    let controller = Controller::pid(pid::<f32>());
    let mut state = ControllerState::start(&controller);
    let far = Setpoint { x: 100.0, v: 0.0, a: 0.0 };
    let command = controller.tick(&mut state, far, 0.0);
    assert_eq!(command, Some(LimitedDrive { u: 12.0, saturated: true }));
    let back = state.pid.integral;
    assert!(back < 0.0 && back.is_finite());
}

/// What is no finite number, in the reference or in the reading, is no drive: neither 0 nor the limit.
#[test]
fn what_is_not_finite_is_no_drive() {
    let rest = Setpoint { x: 0.0, v: 0.0, a: 0.0 };
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for law in [Controller::pid(pid::<f32>()), Controller::adaptive(adaptive::<f32>(5.0))] {
            let controller = law.with_compensator(compensator(&[]).on());
            for (reference, x) in [
                (rest, bad),
                (Setpoint { x: bad, ..rest }, 0.0),
                (Setpoint { v: bad, ..rest }, 0.0),
                (Setpoint { a: bad, ..rest }, 0.0),
            ] {
                let mut state = ControllerState::start(&controller);
                assert!(controller.tick(&mut state, rest, 0.0).is_some());
                assert_eq!(controller.tick(&mut state, reference, x), None, "{reference:?} at {x}");
            }
        }
    }
}

/// Whatever the step and the limit, the axis arrives, and overshoots by less than a twentieth of the step and three
/// counts. With the integral frozen it was 18 % of a step of 2 rad at 3 V and 20 Hz.
#[test]
fn a_step_that_saturates_does_not_overshoot() {
    const STEP: f64 = 1e-3;
    let plant = Plant { base: BASE, effects: &[] };
    for (hz, size, limit) in
        [(8.0, 1.0, 3.0), (8.0, 1.0, 6.0), (10.0, 0.3, 2.0), (20.0, 2.0, 3.0), (5.0, 3.0, 2.0), (8.0, 10.0, 6.0)]
    {
        let gains = tune(BASE.b, BASE.c, hz, TICK, 1).unwrap();
        let start = Estimates { b: BASE.b, c: BASE.c, f1: BASE.f1, f: 0.0 };
        let adaptation = Adaptation::normalised(&start, 1.0, 7.0, 50.0, 0.5);
        let pid = Pid::<f32>::new(&gains, TICK, limit).unwrap().with_rest_band(STEP);
        let law = Adaptive::<f32>::new(&gains, &adaptation, &start, TICK, 1, limit).unwrap();
        for controller in [Controller::pid(pid), Controller::adaptive(law)] {
            let mut motion = plant.at_rest(0.0);
            let mut state = ControllerState::start(&controller);
            let (mut u, mut saturated, mut most) = (0.0, 0, 0.0_f64);
            for k in 0..4000 {
                let reading = libm::round(motion.x / STEP) * STEP;
                let step = Setpoint { x: size as f32, v: 0.0, a: 0.0 };
                let command = controller.tick(&mut state, step, reading as f32).unwrap();
                plant.advance(&mut motion, Drive { u: &[u], ts: TICK, t: f64::from(k) * TICK }, 2);
                u = f64::from(command.u);
                saturated += u32::from(command.saturated);
                most = most.max(motion.x - size);
            }
            std::println!(
                "{hz} Hz, {size} rad, {limit} V: {saturated} ticks saturated, over by {most:.4}, ends {:.4}",
                motion.x
            );
            assert!(saturated > 20 && most < 0.05 * size + 3.0 * STEP, "{hz} {size} {limit}: {most}");
            assert!((motion.x - size).abs() < 0.02 * size, "{hz} {size} {limit}: {}", motion.x);
        }
    }
}

proptest! {
    #[test]
    fn nothing_panics(x in any::<f32>(), r in any::<f32>(), v in any::<f32>(), a in any::<f32>()) {
        let effects = [Effect::new(Kind::Stribeck, &[0.1, 0.1, 1.5]), Effect::new(Kind::LoadFriction, &[0.3])];
        for controller in [Controller::pid(pid::<f32>()), Controller::adaptive(adaptive::<f32>(5.0))] {
            let controller = controller.with_compensator(compensator(&effects).on());
            let mut state = ControllerState::start(&controller);
            for _ in 0..3 {
                let command = controller.tick(&mut state, Setpoint { x: r, v, a }, x);
                prop_assert!(command.is_none_or(|command| command.u.abs() <= 12.0));
            }
        }
    }
}

/// Counted from an origin, cogging is where it is: the same as its phase advanced by n·origin.
#[test]
fn an_origin_moves_the_effects_of_the_position() {
    let origin = 0.37;
    let gains = |phase: f64| {
        Controller::pid(pid::<f64>())
            .with_compensator(compensator(&[Effect::new(Kind::Cogging, &[0.2, 7.0, phase])]).on())
    };
    let (moved, there) = (gains(1.0), gains(1.0 + 7.0 * origin));
    let (mut a, mut b) = (ControllerState::start(&moved), ControllerState::start(&there));
    let sine = Sine::<f64>::new(1.0, 1.0, TICK).unwrap();
    let mut largest: f64 = 0.0;
    for k in 0..1000 {
        let without = moved.tick(&mut { a }, sine.at(k), 0.01).unwrap().u;
        let with = moved.tick_from(&mut a, sine.at(k), 0.01, origin).unwrap().u;
        let expected = there.tick(&mut b, sine.at(k), 0.01).unwrap().u;
        // The table's sine is good to 1e-6 of the amplitude.
        assert!((with - expected).abs() < 1e-6, "{k}: {with}, {expected}");
        largest = largest.max((with - without).abs());
    }
    assert!(largest > 0.2, "the origin changes nothing: {largest}");
}
