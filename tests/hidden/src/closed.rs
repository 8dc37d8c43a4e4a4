//! Recordings in closed loop: a PD controller that follows a reference.

use crate::{
    experiment::Role,
    machine::Machine,
    plan::{Course, Kind},
    world::World,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Natural frequency of the loop, Hz.
const LOOP_HZ: f64 = 3.0;
/// Largest phase, rad, that the sensor and the tick may cost at the natural frequency. With the derivative's own
/// filter the loop keeps half a radian.
const PHASE_RAD: f64 = 0.3;

/// Tracks the course with a damping ratio of 0.8, slower where the position comes late.
fn follow(machine: &Machine, world: &World, course: Course) -> Kind {
    let omega = (TAU * LOOP_HZ).min(PHASE_RAD / world.latency_s());
    let base = machine.base;
    Kind::Track { kp: base.b * omega * omega, kd: (1.6 * base.b * omega - base.c).max(0.0), course }
}

/// A smooth trajectory of three sines.
pub fn track(machine: &Machine, world: &World, rng: &mut ChaCha8Rng) -> Kind {
    let mut line =
        |a: f64, frequency: f64| (a * rng.random_range(0.7..1.3), TAU * frequency, rng.random_range(0.0..TAU));
    let sines = vec![line(1.5, 0.21), line(0.7, 0.37), line(0.2, 0.9)];
    follow(machine, world, Course::Sines(sines))
}

/// Moves from end to end of `reach` (rad) in `period` (s); both shrink with the length of the recordings, which keeps the
/// speed. The proportional part alone must overcome the friction three times, or a slow move would not begin.
fn moves(machine: &Machine, world: &World, reach: f64, period: f64, rng: &mut ChaCha8Rng) -> Kind {
    let (extent, slope) = (rng.random_range(0.7..1.3), rng.random_range(1.2..2.2));
    let mut kind = follow(machine, world, Course::Moves { reach, period: period * world.share(), slope });
    if let Kind::Track { kp, course: Course::Moves { reach, .. }, .. } = &mut kind {
        *reach = extent * (*reach * world.share()).max(3.0 * machine.base.f1 / *kp);
    }
    kind
}

/// Nine lines of 0.5–8 Hz, whose drive would reach 80 % of the amplitude on a machine that stands still.
fn shake(machine: &Machine, world: &World, rng: &mut ChaCha8Rng) -> Kind {
    let lines: Vec<(f64, f64, f64)> =
        (0..9).map(|k| (1.0, TAU * 0.5 * 2f64.powf(0.5 * k as f64), rng.random_range(0.0..TAU))).collect();
    let mut kind = follow(machine, world, Course::Sines(lines));
    if let Kind::Track { kp, kd, course: Course::Sines(lines) } = &mut kind {
        let drive = lines.iter().map(|(a, w, p)| (a * kp.hypot(*kd * w), *w, p + (*kd * w).atan2(*kp))).collect();
        let drive = Course::Sines(drive);
        // 4 s hold two turns of the slowest line, 1 ms a hundredth of the fastest's.
        let peak = (0..4000).map(|k| drive.at(1e-3 * k as f64).abs()).fold(0.0, f64::max);
        for (a, ..) in lines {
            *a *= 0.8 * machine.amplitude / peak;
        }
    }
    kind
}

/// The suite's counterpart: name, role, length in s of the kind world, and drive of each.
pub fn closed(machine: &Machine, world: &World, rng: &mut ChaCha8Rng) -> [(&'static str, Role, f64, Kind); 7] {
    [
        ("track", Role::Fit, 12.0, track(machine, world, rng)),
        ("moves", Role::Fit, 10.0, moves(machine, world, 1.0, 2.5, rng)),
        ("slow_moves", Role::Fit, 8.0, moves(machine, world, 0.2, 4.0, rng)),
        ("shake", Role::Fit, 10.0, shake(machine, world, rng)),
        ("track_2", Role::Score, 8.0, track(machine, world, rng)),
        ("moves_2", Role::Score, 6.0, moves(machine, world, 1.0, 2.0, rng)),
        ("shake_2", Role::Score, 6.0, shake(machine, world, rng)),
    ]
}
