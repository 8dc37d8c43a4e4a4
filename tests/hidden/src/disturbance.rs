//! The random torque: an Ornstein–Uhlenbeck process, discretised exactly.

use crate::world::Torque;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

/// Random torque of one recording.
#[derive(Clone, Debug)]
pub struct Disturbance {
    /// Root mean square, V.
    rms: f64,
    /// Rate at which it forgets, 1/s.
    rate: f64,
    torque: f64,
    rng: ChaCha8Rng,
}

impl Disturbance {
    /// Begins in its stationary distribution.
    pub fn new(torque: Torque, drive_limit: f64, mut rng: ChaCha8Rng) -> Self {
        let rms = 0.01 * torque.rms_percent * drive_limit;
        let start: f64 = rng.sample(StandardNormal);
        Self { rms, rate: TAU * torque.bandwidth_hz, torque: rms * start, rng }
    }

    /// Value h later (V), with the transition of that step whatever its length.
    pub fn step(&mut self, h: f64) -> f64 {
        let kept = (-self.rate * h).exp();
        let fresh: f64 = self.rng.sample(StandardNormal);
        self.torque = kept * self.torque + self.rms * (1.0 - kept * kept).sqrt() * fresh;
        self.torque
    }
}
