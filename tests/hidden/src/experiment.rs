//! The experiments of the standard suite, sized from the break-away force found first.

use crate::{draw::Machine, law::Law, plant::TS};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};

/// Which recordings a session holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// The standard suite: 40 s to fit, 20 s to score.
    Suite,
    /// Two relay levels to fit (12 s), a third to score (5 s).
    Relay,
    /// One multisine to fit (8 s), another to score (7 s).
    Multisine,
    /// Closed-loop PD tracking of a smooth trajectory: 12 s to fit, another of 6 s to score.
    Track,
    /// One slow sine to fit (10 s), another to score (8 s).
    SlowSine,
}

impl Experiment {
    /// The experiment of that name: suite, relay, multisine, track, slow_sine.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "suite" => Self::Suite,
            "relay" => Self::Relay,
            "multisine" => Self::Multisine,
            "track" => Self::Track,
            "slow_sine" => Self::SlowSine,
            _ => return None,
        })
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Suite => "suite",
            Self::Relay => "relay",
            Self::Multisine => "multisine",
            Self::Track => "track",
            Self::SlowSine => "slow_sine",
        }
    }
}

/// Whether a recording is to be fitted or is held out to score.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// May be used to fit.
    Fit,
    /// Only for the score.
    Score,
}

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
    Track {
        kp: f64,
        kd: f64,
        sines: [(f64, f64, f64); 3],
    },
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

/// What a slow ramp of the drive in both directions finds, over one turn.
#[derive(Clone, Copy, Debug)]
pub struct BreakAway {
    /// Largest drive needed anywhere in either direction.
    pub largest: f64,
    /// Half the distance between the two directions' thresholds, the largest over the turn.
    pub half: f64,
    /// Middle between the two thresholds, mean over the turn.
    pub offset: f64,
}

impl BreakAway {
    /// Static search on the true plant at session time 0.
    pub fn find(law: &Law, limit: f64) -> Self {
        const PLACES: usize = 48;
        let mut found = Self { largest: 0.0, half: 0.0, offset: 0.0 };
        for i in 0..PLACES {
            let x = -PI + TAU * i as f64 / PLACES as f64;
            let up = threshold(law, x, limit, 1.0);
            let down = threshold(law, x, limit, -1.0);
            found.largest = found.largest.max(up).max(-down);
            found.half = found.half.max(0.5 * (up - down));
            found.offset += 0.5 * (up + down) / PLACES as f64;
        }
        found
    }
}

/// Drive at which the body at rest just moves in the given direction.
fn threshold(law: &Law, x: f64, limit: f64, side: f64) -> f64 {
    let moves = |u: f64| {
        let delivered = law.shape(u, 0.0);
        let force = law.drive_force(delivered, x, 0.0) + law.extra_force(x, 0.0, 0.0);
        side * force > law.rest_level(x, 0.0, delivered)
    };
    let (mut below, mut above) = (-side * limit, side * limit);
    for _ in 0..30 {
        let middle = 0.5 * (below + above);
        if moves(middle) {
            above = middle;
        } else {
            below = middle;
        }
    }
    above
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

fn open(samples: usize, limit: f64, u: impl Fn(f64) -> f64) -> Kind {
    Kind::Open((0..samples).map(|k| u(k as f64 * TS).clamp(-limit, limit)).collect())
}

/// 0.25–16 Hz, two lines per octave, random phases, scaled to the peak.
fn multisine(samples: usize, peak: f64, offset: f64, machine: &Machine, rng: &mut ChaCha8Rng) -> Kind {
    let phases: Vec<f64> = (0..13).map(|_| rng.random_range(0.0..TAU)).collect();
    let wave = |t: f64| -> f64 {
        let line = |(k, phase): (usize, &f64)| {
            let frequency = (8.0 * 0.25 * 2f64.powf(0.5 * k as f64)).round() / 8.0;
            (TAU * frequency * t + phase).sin()
        };
        phases.iter().enumerate().map(line).sum()
    };
    let raw: Vec<f64> = (0..samples).map(|k| wave(k as f64 * TS)).collect();
    let scale = peak / raw.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    let limit = machine.drive_limit;
    Kind::Open(raw.iter().map(|u| (u * scale + offset).clamp(-limit, limit)).collect())
}

fn track(machine: &Machine, rng: &mut ChaCha8Rng) -> Kind {
    let omega = TAU * 3.0;
    let base = machine.base;
    let mut line =
        |a: f64, frequency: f64| (a * rng.random_range(0.7..1.3), TAU * frequency, rng.random_range(0.0..TAU));
    Kind::Track {
        kp: base.b * omega * omega,
        kd: (1.6 * base.b * omega - base.c).max(0.0),
        sines: [line(1.5, 0.21), line(0.7, 0.37), line(0.2, 0.9)],
    }
}

/// The recordings of a session on this machine, for the plant with this law.
pub fn plan(which: Experiment, machine: &Machine, law: &Law, rng: &mut ChaCha8Rng) -> Vec<Spec> {
    let found = BreakAway::find(law, machine.drive_limit);
    let limit = machine.drive_limit;
    let a0 = machine.amplitude;
    let mut specs = Vec::new();
    let mut add = |name, role, seconds: f64, kind: Kind, start: f64| {
        specs.push(Spec { name, role, samples: (seconds / TS).round() as usize, start, kind });
    };
    let start = |rng: &mut ChaCha8Rng| rng.random_range(-0.3..0.3);
    let sine = |n: usize, level: f64, frequency: f64| {
        open(n, limit, |t| found.offset + level * found.half * (TAU * frequency * t).sin())
    };
    let suite = which == Experiment::Suite;
    if suite || which == Experiment::Relay {
        add("relay_high", Role::Fit, 6.0, relay(machine, &found, 1.0, 0.0), start(rng));
        add("relay_low", Role::Fit, 6.0, relay(machine, &found, 0.5, 0.0), start(rng));
    }
    if suite || which == Experiment::Multisine {
        let kind = multisine(8000, 0.95 * a0, found.offset, machine, rng);
        add("multisine", Role::Fit, 8.0, kind, start(rng));
    }
    if suite || which == Experiment::SlowSine {
        add("slow_sine", Role::Fit, 10.0, sine(10_000, 1.5, 0.5), start(rng));
    }
    if suite {
        let travel = rng.random_range(2.0..6.0);
        let period = 10.0;
        let drag = machine.base.c * 4.0 * travel / period;
        let kind = match relay(machine, &found, 1.0, drag) {
            Kind::Relay { h1, h2, .. } => Kind::Relay { h1, h2, travel, period },
            other => other,
        };
        add("relay_travel", Role::Fit, period, kind, start(rng));
    }
    if which == Experiment::Track {
        add("track", Role::Fit, 12.0, track(machine, rng), 0.0);
        add("track_2", Role::Score, 6.0, track(machine, rng), 0.0);
    }
    if suite || which == Experiment::Relay {
        add("relay_mid", Role::Score, 5.0, relay(machine, &found, 0.75, 0.0), start(rng));
    }
    if suite || which == Experiment::Multisine {
        let kind = multisine(7000, 0.75 * a0, found.offset, machine, rng);
        add("multisine_2", Role::Score, 7.0, kind, start(rng));
    }
    if suite || which == Experiment::SlowSine {
        add("slow_sine_2", Role::Score, 8.0, sine(8000, 1.8, 0.4), start(rng));
    }
    specs
}
