//! An event-exact plant for the tests: closed form between ticks, reversals and stick solved for.

use breakaway_core::excite::relay::{DualRelay, DualRelayState, default_hysteresis};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// `b·ẍ + c·ẋ + f1·sgn(ẋ) + load = u`, `c > 0`.
#[derive(Clone, Copy)]
pub struct Plant {
    pub b: f64,
    pub c: f64,
    pub f1: f64,
    pub load: f64,
    pub x: f64,
    pub v: f64,
}

/// The papers' plant with f2 lumped into c (docs/theory.md, section 1).
pub const REFERENCE: Plant = Plant { b: 0.02685, c: 0.11, f1: 0.5, load: 0.0, x: 0.0, v: 0.0 };

impl Plant {
    /// Moves on by `dt` with `u` held.
    pub fn advance(&mut self, u: f64, dt: f64) {
        let mut left = dt;
        let net = u - self.load;
        let tp = self.b / self.c;
        while left > 0.0 {
            if self.v == 0.0 && net.abs() <= self.f1 {
                return;
            }
            let sign = if self.v == 0.0 { net.signum() } else { self.v.signum() };
            let end = (net - self.f1 * sign) / self.c;
            let reversal =
                if end * sign < 0.0 && self.v != 0.0 { tp * (1.0 - self.v / end).ln() } else { f64::INFINITY };
            let step = left.min(reversal);
            let decay = -(-step / tp).exp_m1();
            self.x += end * step + (self.v - end) * tp * decay;
            self.v = if reversal <= left { 0.0 } else { self.v + (end - self.v) * decay };
            left -= step;
        }
    }
}

/// What is recorded.
#[derive(Clone, Copy)]
pub struct Sensor {
    /// Encoder step; 0 is a perfect sensor of the estimators' record (the relay then counts in 1e-6).
    pub q: f64,
    /// Standard deviation of the noise before quantisation.
    pub sigma: f64,
}

/// One relay experiment.
#[derive(Clone, Copy)]
pub struct Run {
    pub h1: f64,
    pub h2: f64,
    pub ts: f64,
    pub ticks: usize,
    pub hysteresis: u32,
}

/// A record: position as sensed, drive as applied from each sample to the next, and the error in counts.
pub struct Record {
    pub x: Vec<f64>,
    pub u: Vec<f64>,
    pub error_counts: Vec<i32>,
}

/// Closes the dual relay around the plant.
pub fn relay_run(mut plant: Plant, run: Run, sensor: Sensor, seed: u64) -> Record {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = Normal::new(0.0, sensor.sigma).unwrap();
    let relay = DualRelay::with_real_drive(run.h1, run.h2, run.hysteresis).unwrap();
    let mut state = DualRelayState::new();
    let count = if sensor.q > 0.0 { sensor.q } else { 1e-6 };
    let mut record = Record {
        x: Vec::with_capacity(run.ticks),
        u: Vec::with_capacity(run.ticks),
        error_counts: Vec::with_capacity(run.ticks),
    };
    for _ in 0..run.ticks {
        let seen = plant.x + noise.sample(&mut random);
        let counts = (seen / count).round();
        let error = -counts as i32;
        let u = relay.tick(&mut state, error);
        record.x.push(if sensor.q > 0.0 { counts * count } else { seen });
        record.u.push(u);
        record.error_counts.push(error);
        plant.advance(u, run.ts);
    }
    record
}

/// A relay experiment by its amplitudes, and about the period it gives (s).
#[derive(Clone, Copy)]
pub struct Cycle {
    pub h1: f64,
    pub h2: f64,
    pub period: f64,
}

/// `cycles` periods at 1 kHz from standstill, with the default hysteresis of 3σ + 1 count.
#[allow(dead_code, reason = "the relay's own tests choose their hysteresis")]
pub fn experiment(plant: Plant, cycle: Cycle, cycles: f64, sensor: Sensor, seed: u64) -> Record {
    let sigma_counts = if sensor.q > 0.0 { sensor.sigma / sensor.q } else { 0.0 };
    let run = Run {
        h1: cycle.h1,
        h2: cycle.h2,
        ts: 1e-3,
        ticks: (cycles * cycle.period / 1e-3) as usize,
        hysteresis: default_hysteresis(sigma_counts).unwrap(),
    };
    relay_run(plant, run, sensor, seed)
}
