//! The coordinates that predict a missing force.

use breakaway_core::plant::Base;

use super::*;
use crate::fit::Candidate;
use crate::recording::Recording;

const BASE: Base<f64> = Base { b: 0.02, c: 0.05, f1: 0.1 };

/// 20 s at 1 kHz of an axis. `drive` gives u of time, position and velocity, and `arrives` what of it moves the axis at
/// a position.
fn recording(drive: fn(f64, f64, f64) -> f64, arrives: fn(f64, f64) -> f64) -> Recording {
    let (mut x, mut v) = (0.0, 0.0_f64);
    let mut recording = Recording::default();
    for k in 0..20_000 {
        let t = 1e-3 * f64::from(k);
        let u = drive(t, x, v);
        recording.t.push(t);
        recording.u.push(u);
        recording.x.push(x);
        for _ in 0..10 {
            let force = arrives(u, x);
            let free = v + (force - BASE.f1 * v.signum() - BASE.c * v) / BASE.b * 1e-4;
            v = if free * v < 0.0 && force.abs() <= BASE.f1 { 0.0 } else { free };
            x += v * 1e-4;
        }
    }
    recording
}

/// Share of the residual force that each coordinate explains, and that the drive explains of the drive's own residual.
fn shares(recording: Recording) -> (Vec<(&'static str, f64)>, f64) {
    let data = Data::new(&[recording], &[], 0.4);
    let screen = Screen::new(&data, &Candidate { base: BASE, effects: Vec::new() }).unwrap();
    let shares = map(&data, &screen).into_iter().map(|(name, _, r2, _)| (name, r2)).collect();
    let level = coordinates(&data, &screen).into_iter().find(|own| own.of_drive).unwrap();
    (shares, cross_validated(&level.value, &screen.residual_force(), BINS))
}

fn share(of: &[(&str, f64)], coordinate: &str) -> f64 {
    of.iter().find(|(name, _)| *name == coordinate).unwrap().1
}

/// A servo holds a spring. Much of its drive is the spring's force, so the drive predicts what the base leaves of the drive.
/// That is no reason to seek a fault in the drive.
#[test]
fn a_spring_is_no_matter_of_the_drive() {
    let servo =
        |t: f64, x: f64, v: f64| 20.0 * ((0.7 * t).sin() + (1.9 * t).sin() + 0.8 * (5.3 * t).sin() - x) - 0.3 * v;
    let (shares, of_the_drive) = shares(recording(servo, |u, x| u - 2.0 * x));
    let [position, level] = ["position", "drive level"].map(|name| share(&shares, name));
    assert!(of_the_drive > position && position > 0.3 && level < 0.05, "{of_the_drive} {shares:?}");
}

/// A dead zone is one: no coordinate predicts more.
#[test]
fn a_dead_zone_is() {
    let drive = |t: f64, _: f64, _: f64| (2.1 * t).sin() + 0.8 * (9.7 * t).sin();
    let (shares, _) = shares(recording(drive, |u, _| u.signum() * (u.abs() - 0.3).max(0.0)));
    let level = share(&shares, "drive level");
    assert!(shares.iter().all(|(_, share)| *share <= level) && level > 0.3, "{shares:?}");
}
