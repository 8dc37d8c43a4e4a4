//! The simulated machine: plant, encoder, power stage.

use breakaway_core::link::FULL_SCALE_CODE;
use breakaway_core::plant::{Base, Drive, Effect};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use super::VirtualBoardError;
use crate::simulate::motion::SimulatedMotion;

/// What to simulate.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Base model.
    pub base: Base<f64>,
    /// Effects on top.
    pub effects: Vec<Effect<f64>>,
    /// Ticks per second, 10 to 100 000.
    pub tick_hz: u32,
    /// Position units per encoder count, > 0.
    pub encoder_step: f64,
    /// Standard deviation of the position noise before the encoder, position units, ≥ 0.
    pub noise: f64,
    /// Drive units at full scale, > 0.
    pub drive_full_scale: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Machine {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`VirtualBoardError::Range`] names the field.
    pub fn check(&self) -> Result<(), VirtualBoardError> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let checks = [
            ((10..=100_000).contains(&self.tick_hz), "tick_hz", f64::from(self.tick_hz), "10 to 100000"),
            (positive(self.encoder_step), "encoder_step", self.encoder_step, "> 0"),
            (positive(self.drive_full_scale), "drive_full_scale", self.drive_full_scale, "> 0"),
            (self.noise.is_finite() && self.noise >= 0.0, "noise", self.noise, "≥ 0"),
        ];
        match checks.into_iter().find(|(good, ..)| !good) {
            Some((_, field, value, need)) => Err(VirtualBoardError::Range { field, value, need }),
            None => Ok(()),
        }
    }
}

/// A machine under way.
#[derive(Debug)]
pub struct SimulatedMachine {
    motion: SimulatedMotion,
    noise: Normal<f64>,
    rng: ChaCha8Rng,
    tick_hz: u32,
    encoder_step: f64,
    drive_full_scale: f64,
    history: Vec<f64>,
    ticks: u64,
    frozen: Option<i32>,
    /// One channel is dead: the count toggles between this and the next.
    dead_channel: Option<i32>,
    /// The encoder counts the other way.
    reversed: bool,
    offset: i32,
    last: i32,
}

/// Past drive that is kept, ticks: far more than any delay of the catalogue.
const HISTORY: usize = 10_000;

impl SimulatedMachine {
    /// At rest at 0.
    pub fn new(machine: &Machine) -> Self {
        Self {
            motion: SimulatedMotion::at_rest(machine.base, &machine.effects),
            // Checked before; without noise, and a normal distribution of it, the machine is the same.
            noise: Normal::new(0.0, machine.noise.max(0.0)).unwrap_or_else(|_| unreachable!("checked")),
            rng: ChaCha8Rng::seed_from_u64(machine.seed),
            tick_hz: machine.tick_hz,
            encoder_step: machine.encoder_step,
            drive_full_scale: machine.drive_full_scale,
            history: Vec::new(),
            ticks: 0,
            frozen: None,
            dead_channel: None,
            reversed: false,
            offset: 0,
            last: 0,
        }
    }

    /// Ticks per second.
    pub const fn tick_hz(&self) -> u32 {
        self.tick_hz
    }

    /// True position, position units.
    pub const fn position(&self) -> f64 {
        self.motion.position()
    }

    /// What the encoder says now.
    pub fn count(&mut self) -> i32 {
        let reading = self.motion.measured() + self.noise.sample(&mut self.rng);
        // A machine that has run away wraps, as a counter does.
        let count = ((reading / self.encoder_step).round() as i64 as i32).wrapping_add(self.offset);
        let count = if self.reversed { count.wrapping_neg() } else { count };
        // Of the four states in a line, the live channel is high in two.
        let toggled = self.dead_channel.map(|at| at.wrapping_add(i32::from(matches!(count.rem_euclid(4), 1 | 2))));
        self.last = self.frozen.or(toggled).unwrap_or(count);
        self.last
    }

    /// One tick under a drive code.
    pub fn advance(&mut self, code: i16) {
        let u = f64::from(code) / f64::from(FULL_SCALE_CODE) * self.drive_full_scale;
        let ts = 1.0 / f64::from(self.tick_hz);
        if self.history.len() >= 2 * HISTORY {
            self.history.drain(..HISTORY);
        }
        self.history.push(u);
        let t = self.ticks as f64 * ts;
        let sub_steps = self.motion.sub_steps(ts);
        self.motion.advance(Drive { u: &self.history, ts, t }, sub_steps);
        self.ticks += 1;
    }

    /// The encoder stays where it is.
    pub fn freeze(&mut self) {
        self.frozen = Some(self.last);
    }

    /// One channel of the encoder is dead from now on.
    pub fn kill_channel(&mut self) {
        self.dead_channel = Some(self.last);
    }

    /// The encoder counts the other way from now on.
    pub fn reverse(&mut self) {
        self.reversed = true;
    }

    /// The encoder is off by this much from now on.
    pub fn jump(&mut self, counts: i32) {
        self.offset = self.offset.wrapping_add(counts);
    }

    /// The encoder is as it was.
    pub fn heal(&mut self) {
        (self.frozen, self.dead_channel, self.reversed, self.offset) = (None, None, false, 0);
    }
}
