//! What makes the drive of a recording from the position that was reported.

use crate::{
    machine::Machine,
    plan::{Course, Kind, Spec},
    plant::sign,
};

/// The drive's maker during one recording.
pub struct Controller<'a> {
    spec: &'a Spec,
    tick_s: f64,
    limit: f64,
    hysteresis: f64,
    /// Offset of the relay's reference: with none, both relays hang on the first noise and may
    /// oppose each other for good.
    kick: f64,
    relay: f64,
    integral: f64,
    last_error: f64,
    /// Ticks since the last fresh position.
    age: usize,
    rate: f64,
}

/// Time constant of the filter behind the derivative, s.
const FILTER_S: f64 = 0.01;

impl<'a> Controller<'a> {
    /// At the start of a recording.
    pub fn new(machine: &Machine, spec: &'a Spec, tick_s: f64) -> Self {
        Self {
            spec,
            tick_s,
            limit: machine.drive_limit,
            hysteresis: 3.0 * machine.noise_sigma + machine.encoder_step,
            kick: 40.0 * machine.encoder_step,
            relay: 1.0,
            integral: 0.0,
            last_error: 0.0,
            age: 0,
            rate: 0.0,
        }
    }

    /// Drive of the k-th tick at the reported position x. The derivative waits for a fresh one: of a held position it would be
    /// a train of spikes.
    pub fn drive(&mut self, k: usize, x: f64, fresh: bool) -> f64 {
        let t = k as f64 * self.tick_s;
        match &self.spec.kind {
            Kind::Open(u) => u.get(k).copied().unwrap_or(0.0),
            Kind::Relay { h1, h2, travel, period } => {
                let e = self.spec.start + self.kick + triangle(t / period) * travel - x;
                if e.abs() > self.hysteresis {
                    self.relay = sign(e);
                }
                self.integral += e * self.tick_s;
                h1 * self.relay + h2 * if self.integral < 0.0 { -1.0 } else { 1.0 }
            }
            Kind::Track { kp, kd, course } => {
                let envelope = 1.0 - (-(t / 0.5).powi(2)).exp();
                let e = envelope * course.at(t) + self.spec.start - x;
                self.age += 1;
                if fresh {
                    let elapsed = self.age as f64 * self.tick_s;
                    let raw = (e - self.last_error) / elapsed;
                    self.last_error = e;
                    self.age = 0;
                    self.rate += (raw - self.rate) * elapsed.min(FILTER_S) / FILTER_S;
                }
                (kp * e + kd * self.rate).clamp(-self.limit, self.limit)
            }
        }
    }
}

impl Course {
    /// Reference at time t of the recording, rad.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Sines(sines) => sines.iter().map(|(a, w, p)| a * (w * t + p).sin()).sum(),
            Self::Moves { reach, period, slope } => reach * (slope * triangle(t / period)).clamp(-1.0, 1.0),
        }
    }
}

/// Unit triangle of period 1: 0, 1, 0, −1, 0.
fn triangle(phase: f64) -> f64 {
    let p = (phase + 0.25).rem_euclid(1.0);
    1.0 - 4.0 * (p - 0.5).abs()
}
