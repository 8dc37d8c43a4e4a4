use super::*;
use crate::control::{Controller, ControllerState, Pid, Sine, tune};
use crate::plant::effect::Kind;
use crate::plant::{Drive, Plant};
use crate::scalar::Q32;
extern crate std;
use std::vec::Vec;

const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
const TICK: f64 = 1e-3;
const STEP: f64 = core::f64::consts::TAU / 8000.0;

/// Drives and readings of a PID that follows a sine of 1 rad at 0.5 Hz, on a plant that changes at `change_s`.
struct Axis<'a> {
    before: Plant<'a, f64>,
    after: Plant<'a, f64>,
    change_s: f64,
    x: crate::plant::State<f64>,
    state: ControllerState<f64>,
    controller: Controller<f64>,
    sine: Sine<f64>,
    k: u32,
    pending: f64,
    noise: u32,
}

impl<'a> Axis<'a> {
    fn new(before: Plant<'a, f64>, after: Plant<'a, f64>, change_s: f64) -> Self {
        let gains = tune(BASE.b, BASE.c, 10.0, TICK, 1).unwrap();
        let controller = Controller::pid(Pid::new(&gains, TICK, 12.0).unwrap());
        Self {
            x: before.at_rest(0.0),
            before,
            after,
            change_s,
            state: ControllerState::start(&controller),
            controller,
            sine: Sine::new(1.0, 0.5, TICK).unwrap(),
            k: 0,
            pending: 0.0,
            noise: 1,
        }
    }

    /// Time, the drive applied up to the reading, the reading.
    fn step(&mut self) -> (f64, f64, f64) {
        let t = f64::from(self.k) * TICK;
        let u = self.pending;
        let plant = if t < self.change_s { &self.before } else { &self.after };
        plant.advance(&mut self.x, Drive { u: &[u], ts: TICK, t }, 1);
        // Half an encoder step of noise, so that a resting edge is not always the same.
        self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let dither = (f64::from(self.noise >> 8) / 16_777_216.0 - 0.5) * STEP;
        let reading = libm::round((self.x.x + dither) / STEP) * STEP;
        self.pending = self.controller.tick(&mut self.state, self.sine.at(self.k), reading).u;
        self.k += 1;
        (t, u, reading)
    }
}

fn watch<R: Fast>() -> DriftWatch<R> {
    DriftWatch::new(&BASE, &[], &DriftSettings::usual(60.0, 0.3, BASE.f1), TICK).unwrap()
}

fn plant(base: Base<f64>, effects: &[Effect<f64>]) -> Plant<'_, f64> {
    Plant { base, effects }
}

/// The alarms of a run, with their times.
fn alarms<R: Fast>(axis: &mut Axis<'_>, seconds: f64) -> Vec<(f64, ModelMismatch<R>)> {
    let watch = watch::<R>();
    let mut state = DriftState::default();
    let mut found = Vec::new();
    loop {
        let (t, u, x) = axis.step();
        if t >= seconds {
            return found;
        }
        if let Some(alarm) = watch.tick(&mut state, R::from_f64(u), R::from_f64(x)) {
            found.push((t, alarm));
        }
    }
}

/// A rise of f1 by 30 % is found within 2 s, as resistance of 0.15 V against the motion, in every number type.
#[test]
fn a_rise_of_friction_is_found_within_two_seconds() {
    fn check<R: Fast>() {
        for (rise, expected) in [(1.3, Direction::Resists), (0.7, Direction::Assists)] {
            let changed = Base { f1: rise * BASE.f1, ..BASE };
            // Calibration is over after 64 blocks of either direction.
            let mut axis = Axis::new(plant(BASE, &[]), plant(changed, &[]), 30.0);
            let found = alarms::<R>(&mut axis, 34.0);
            let (t, first) = found[0];
            std::println!("f1 times {rise}: {:.2} s after, {first:?}", t - 30.0);
            assert!((30.0..32.0).contains(&t), "{t}");
            assert_eq!(first.direction, expected);
            let missing = (rise - 1.0) * BASE.f1 * -f64::from(first.speed_sign);
            assert!((first.force.to_f64() / missing - 1.0).abs() < 0.3, "{first:?}");
        }
    }
    check::<f64>();
    check::<f32>();
    check::<Q32>();
}

/// What goes wrong in one direction, or at one place, is reported there.
#[test]
fn it_says_where() {
    // A load: in positive direction it resists, in negative it assists.
    let load = [Effect::new(Kind::ConstantLoad, &[0.15])];
    let mut axis = Axis::new(plant(BASE, &[]), plant(BASE, &load), 30.0);
    let found = alarms::<f64>(&mut axis, 36.0);
    assert!(found.len() >= 2, "{found:?}");
    for (_, alarm) in &found {
        let resists = alarm.direction == Direction::Resists;
        assert_eq!(resists, alarm.speed_sign > 0, "{alarm:?}");
        assert!(alarm.force < 0.0, "{alarm:?}");
    }
    // Friction that rises towards positive positions, and falls towards negative: with the motion's bins over −1..1,
    // resistance is found in the upper half, assistance in the lower.
    let uneven = [Effect::new(Kind::PositionFriction, &[0.5, 1.5, 0.0])];
    let mut axis = Axis::new(plant(BASE, &[]), plant(BASE, &uneven), 30.0);
    let found = alarms::<f64>(&mut axis, 50.0);
    assert!(!found.is_empty());
    for (_, alarm) in &found {
        assert_eq!(alarm.direction == Direction::Resists, alarm.position > 0.0, "{alarm:?}");
        assert_eq!(alarm.bin >= BINS / 2, alarm.position > 0.0);
    }
}

/// No false alarm in ten minutes of simulated running; the goal of less than one an hour is measured over ten hours by
/// `tests/examples/robustness.rs` (docs/robustness.md).
#[test]
fn it_is_quiet_while_the_model_holds() {
    let mut axis = Axis::new(plant(BASE, &[]), plant(BASE, &[]), 0.0);
    let found = alarms::<f64>(&mut axis, 600.0);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn wrong_settings_are_named() {
    let new = |settings: DriftSettings| DriftWatch::<f32>::new(&BASE, &[], &settings, TICK).err();
    let usual = DriftSettings::usual(60.0, 0.3, 0.5);
    assert_eq!(new(usual), None);
    assert_eq!(new(DriftSettings { bandwidth_rad_s: 501.0, ..usual }), Some(DriftError::Bandwidth));
    assert_eq!(new(DriftSettings { rest_speed: 0.0, ..usual }), Some(DriftError::RestSpeed));
    assert_eq!(new(DriftSettings { calibration: 7, ..usual }), Some(DriftError::Calibration));
    assert_eq!(new(DriftSettings { slack: f64::NAN, ..usual }), Some(DriftError::Threshold));
    assert_eq!(new(DriftSettings { smallest_scale: 0.0, ..usual }), Some(DriftError::Scale));
}
