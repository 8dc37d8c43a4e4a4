//! The position sensor: when it is read, how late it is, and what it rounds to.

use crate::{machine::Machine, world::World};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::collections::VecDeque;

/// Two sub-steps or more beyond what is read back, s.
const MARGIN_S: f64 = 1e-3;

/// The sensor during one recording; times are those of the session, s.
#[derive(Clone, Debug)]
pub struct Sensor {
    step: f64,
    sigma: f64,
    delay_s: f64,
    held_s: Option<f64>,
    /// Instant of one of its readings, if it is read on a clock of its own.
    phase_s: f64,
    /// Exact positions, the last at the present.
    past: VecDeque<(f64, f64)>,
    /// The last reading, and its number.
    reading: Reading,
    number: Option<i64>,
}

/// One reading, rad.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reading {
    /// Without noise and quantisation.
    pub exact: f64,
    /// As reported, a multiple of the step.
    pub reported: f64,
    /// Whether it was not given before.
    pub fresh: bool,
}

impl Sensor {
    /// At rest at the exact position y at time t; a held sensor's readings begin anywhere within its period.
    pub fn new(machine: &Machine, world: &World, t: f64, y: f64, rng: &mut ChaCha8Rng) -> Self {
        let phase_s = world.held_s.map_or(0.0, |held| t - held * rng.random_range(0.0..1.0));
        Self {
            step: machine.encoder_step,
            sigma: machine.noise_sigma,
            delay_s: world.sensor_delay_s,
            held_s: world.held_s,
            phase_s,
            past: VecDeque::from([(t, y)]),
            reading: Reading::default(),
            number: None,
        }
    }

    /// Takes note of the exact position y at time t.
    pub fn measure(&mut self, t: f64, y: f64) {
        self.past.push_back((t, y));
        let oldest = t - self.delay_s - self.held_s.unwrap_or(0.0) - MARGIN_S;
        while self.past.get(1).is_some_and(|(next, _)| *next < oldest) {
            self.past.pop_front();
        }
    }

    /// What the log gets at time t, which is the present.
    pub fn read(&mut self, t: f64, rng: &mut ChaCha8Rng) -> Reading {
        let number = self.held_s.map(|held| ((t - self.phase_s) / held).floor() as i64);
        if number.is_some() && number == self.number {
            self.reading.fresh = false;
            return self.reading;
        }
        self.number = number;
        let instant = match (self.held_s, number) {
            (Some(held), Some(number)) => (self.phase_s + number as f64 * held).min(t),
            _ => t,
        };
        let exact = self.at(instant - self.delay_s);
        let noise: f64 = rng.sample(StandardNormal);
        let reported = ((exact + noise * self.sigma) / self.step).round() * self.step;
        self.reading = Reading { exact, reported, fresh: true };
        self.reading
    }

    /// Exact position at a past time, linear between sub-steps: at 0.1 ms and 1000 rad/s² within 1.3e-6 rad.
    fn at(&self, t: f64) -> f64 {
        let (present, y) = self.past.back().copied().unwrap_or_default();
        let next = self.past.partition_point(|(at, _)| *at < t);
        match (next.checked_sub(1).and_then(|i| self.past.get(i)), self.past.get(next)) {
            // The present itself, which two ways of adding up may put a rounding apart.
            _ if t > present - 1e-9 => y,
            (Some((t0, y0)), Some((t1, y1))) => y0 + (y1 - y0) * (t - t0) / (t1 - t0),
            (None, Some((_, first))) => *first,
            (_, None) => y,
        }
    }
}
