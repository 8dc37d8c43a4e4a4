//! The recordings to be made, sized from the break-away force found first.

use crate::{
    break_away::BreakAway,
    closed::{closed, track},
    experiment::{Experiment, Role},
    law::ForceLaw,
    machine::Machine,
    world::World,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// How the drive of one recording is made.
#[derive(Clone, Debug)]
pub enum Kind {
    /// u = h1·sgn(e) + h2·sgn(∫e) about a triangular reference (amplitude 0: constant).
    Relay {
        h1: f64,
        h2: f64,
        travel: f64,
        period: f64,
    },
    Open(Vec<f64>),
    /// PD tracking.
    Track {
        kp: f64,
        kd: f64,
        course: Course,
    },
}

/// A reference to be tracked.
#[derive(Clone, Debug)]
pub enum Course {
    /// Amplitude (rad), frequency (rad/s) and phase of each.
    Sines(Vec<(f64, f64, f64)>),
    /// Between −reach and reach at constant speed, with a dwell at either end: a triangle `slope` times too high, clipped.
    Moves { reach: f64, period: f64, slope: f64 },
}

/// One recording to be made.
#[derive(Clone, Debug)]
pub struct Spec {
    pub name: &'static str,
    pub role: Role,
    pub samples: usize,
    pub start: f64,
    pub kind: Kind,
}

fn relay(machine: &Machine, found: &BreakAway, level: f64, extra: f64) -> Kind {
    let total = level * machine.amplitude;
    // h1 = 3·h2 unless the break-away force asks for more: a cycle needs h2 above it.
    let h2 = (0.25 * total).max(1.05 * found.largest + 0.1 * total + extra);
    // h1 − h2 above the break-away force avoids stick phases.
    let total = total.max(2.0 * h2 + 1.05 * found.largest).min(machine.amplitude);
    let h2 = h2.min(0.75 * total);
    Kind::Relay { h1: total - h2, h2, travel: 0.0, period: 1.0 }
}

fn open(samples: usize, tick_s: f64, limit: f64, u: impl Fn(f64) -> f64) -> Kind {
    Kind::Open((0..samples).map(|k| u(k as f64 * tick_s).clamp(-limit, limit)).collect())
}

/// 0.25–16 Hz, two lines per octave, random phases, scaled to the peak.
fn multisine(samples: usize, tick_s: f64, peak: f64, offset: f64, machine: &Machine, rng: &mut ChaCha8Rng) -> Kind {
    let phases: Vec<f64> = (0..13).map(|_| rng.random_range(0.0..TAU)).collect();
    let wave = |t: f64| -> f64 {
        let line = |(k, phase): (usize, &f64)| {
            let frequency = (8.0 * 0.25 * 2f64.powf(0.5 * k as f64)).round() / 8.0;
            (TAU * frequency * t + phase).sin()
        };
        phases.iter().enumerate().map(line).sum()
    };
    let raw: Vec<f64> = (0..samples).map(|k| wave(k as f64 * tick_s)).collect();
    let scale = peak / raw.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let limit = machine.drive_limit;
    Kind::Open(raw.iter().map(|u| (u * scale + offset).clamp(-limit, limit)).collect())
}

/// The recordings of a session on this machine, for the plant with this law.
pub fn plan(which: Experiment, machine: &Machine, law: &ForceLaw, world: &World, rng: &mut ChaCha8Rng) -> Vec<Spec> {
    let (tick_s, share) = (world.tick_s, world.share());
    let samples = |seconds: f64| (seconds * share / tick_s).round() as usize;
    let found = BreakAway::find(law, machine.drive_limit);
    let limit = machine.drive_limit;
    let a0 = machine.amplitude;
    let mut specs = Vec::new();
    let mut add = |name, role, seconds: f64, kind: Kind, start: f64| {
        specs.push(Spec { name, role, samples: samples(seconds), start, kind });
    };
    let start = |rng: &mut ChaCha8Rng| rng.random_range(-0.3..0.3);
    let sine = |seconds: f64, level: f64, frequency: f64| {
        open(samples(seconds), tick_s, limit, |t| found.offset + level * found.half * (TAU * frequency * t).sin())
    };
    if which == Experiment::Closed {
        for (name, role, seconds, kind) in closed(machine, world, rng) {
            add(name, role, seconds, kind, start(rng));
        }
    }
    let suite = which == Experiment::Suite;
    if suite || which == Experiment::Relay {
        add("relay_high", Role::Fit, 6.0, relay(machine, &found, 1.0, 0.0), start(rng));
        add("relay_low", Role::Fit, 6.0, relay(machine, &found, 0.5, 0.0), start(rng));
    }
    if suite || which == Experiment::Multisine {
        let kind = multisine(samples(8.0), tick_s, 0.95 * a0, found.offset, machine, rng);
        add("multisine", Role::Fit, 8.0, kind, start(rng));
    }
    if suite || which == Experiment::SlowSine {
        add("slow_sine", Role::Fit, 10.0, sine(10.0, 1.5, 0.5), start(rng));
    }
    if suite {
        // Shorter recordings travel less far, at the same speed.
        let travel = rng.random_range(2.0..6.0) * share;
        let period = 10.0 * share;
        let drag = machine.base.c * 4.0 * travel / period;
        let kind = match relay(machine, &found, 1.0, drag) {
            Kind::Relay { h1, h2, .. } => Kind::Relay { h1, h2, travel, period },
            other => other,
        };
        add("relay_travel", Role::Fit, 10.0, kind, start(rng));
    }
    if which == Experiment::Track {
        add("track", Role::Fit, 12.0, track(machine, world, rng), 0.0);
        add("track_2", Role::Score, 6.0, track(machine, world, rng), 0.0);
    }
    if suite || which == Experiment::Relay {
        add("relay_mid", Role::Score, 5.0, relay(machine, &found, 0.75, 0.0), start(rng));
    }
    if suite || which == Experiment::Multisine {
        let kind = multisine(samples(7.0), tick_s, 0.75 * a0, found.offset, machine, rng);
        add("multisine_2", Role::Score, 7.0, kind, start(rng));
    }
    if suite || which == Experiment::SlowSine {
        add("slow_sine_2", Role::Score, 8.0, sine(8.0, 1.8, 0.4), start(rng));
    }
    specs
}
