//! The watch over the model's validity: the one-step residual of the model, and a two-sided CUSUM on it.
//!
//! An observer predicts each position from the last one, the drive and the model, friction with its sticking
//! included. The residual, `ε = x − x̂`, corrects it with gains of a double pole at e^(−ωo·Ts) for the double
//! integrator. A force that the model misses shows as `r = ε·(b·l2/Ts² + c·l1/Ts)`, drive units, after a few 1/ωo.
//! Residuals are averaged over blocks that overlap by half, under the window `30·τ²(1 − τ)²`: The noise of the
//! readings comes as b·ε̈ + c·ε̇. A window that ends smoothly takes the derivatives upon itself, so that a block of
//! length L keeps `b·σ·√Ts·26.8·L^(−5/2) + …` of it whatever ωo is. Blocks are taken only where the axis moves one
//! way and has done so for a few 1/ωo. The first blocks of either direction set mean and scale (the calibrated
//! stretch). Later ones, in units of that scale and cut at ±8, feed two pairs of sums over both directions. These are
//! of z itself (a load), and z along the motion (friction)
//!
//! ```text
//! g+ = max(0, g+ + z − k)      g− = max(0, g− − z − k)      alarm at g > h
//! ```
//!
//! (Page's cumulative sum, 1954). Because z is cut, no single block raises an alarm.

mod settings;

pub use settings::{DriftError, DriftSettings, Motion};

use super::compensator::Compensator;
use super::fast::Fast;
use crate::plant::Base;
use crate::plant::effect::Effect;
use crate::scalar::Real;

/// Bins of position.
pub const BINS: usize = 16;
/// Largest |z| that a block may count for.
const CUT: f64 = 8.0;
/// What the scale of a short stretch is multiplied with: it may have been a quiet one.
const UNSURE: f64 = 1.25;

/// Which way the missing force acts, against the motion it was found in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The axis moves harder than the model says.
    Resists,
    /// The axis moves more easily.
    Assists,
}

/// The model no longer fits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelMismatch<R> {
    /// Which way the missing force acts.
    pub direction: Direction,
    /// Sign of the velocity of the last block, −1 or 1.
    pub speed_sign: i8,
    /// Bin of position, 0..[`BINS`] over the calibrated travel, in which it is largest of late.
    pub bin: usize,
    /// Middle of that bin, X.
    pub position: R,
    /// Mean missing force since it began, drive units; positive pushes the axis in positive direction.
    pub force: R,
    /// The same over its standard error, had nothing changed since the calibrated stretch; signed as `force`.
    pub score: R,
}

/// Configuration of the watch.
#[derive(Clone, Copy, Debug)]
pub struct DriftWatch<R> {
    model: Compensator<R>,
    tick: R,
    half: R,
    /// Velocity and distance that a force makes in a tick, the viscous friction's share in it.
    to_v: R,
    to_x: R,
    /// Observer gains: on the position, and on the velocity (1/s).
    l1: R,
    l2: R,
    /// From ε to a force.
    force: R,
    /// Half a block, ticks.
    hop: u32,
    per_block: R,
    /// 30 over the ticks of a block.
    window: R,
    settle: u32,
    rest_speed: R,
    calibration: u32,
    per_calibration: R,
    unsure: R,
    slack: R,
    threshold: R,
    smallest_scale: R,
    cut: R,
    per_bins: R,
    per_memory: R,
}

/// What is learnt of one direction of motion.
#[derive(Clone, Copy, Debug, Default)]
struct Side<R> {
    blocks: u32,
    /// In calibration Σr, Σr²; then mean and 1/scale.
    mean: R,
    scale: R,
    /// Residual of late in each bin of position, in units of the scale.
    bins: [R; BINS],
}

/// A cumulative sum, the blocks since it was last 0 and their residuals.
#[derive(Clone, Copy, Debug, Default)]
struct Sum<R> {
    g: R,
    blocks: u32,
    residual: R,
}

/// What the watch remembers.
#[derive(Clone, Copy, Debug)]
pub struct DriftState<R> {
    started: bool,
    x: R,
    v: R,
    moving: u32,
    sign: i8,
    /// Ticks since the last block began; the block before it is in its second half if there is one.
    count: u32,
    overlaps: bool,
    first: R,
    second: R,
    sides: [Side<R>; 2],
    /// Of z, −z, and of both along the motion.
    sums: [Sum<R>; 4],
    /// Range of position over the calibrated stretch.
    low: R,
    high: R,
    /// The residual of the last tick, drive units.
    residual: R,
}

impl<R: Fast> Default for DriftState<R> {
    fn default() -> Self {
        Self {
            started: false,
            x: R::ZERO,
            v: R::ZERO,
            moving: 0,
            sign: 0,
            count: 0,
            overlaps: false,
            first: R::ZERO,
            second: R::ZERO,
            sides: [Side::default(); 2],
            sums: [Sum::default(); 4],
            low: R::ZERO,
            high: R::ZERO,
            residual: R::ZERO,
        }
    }
}

impl<R: Fast> DriftState<R> {
    /// The residual of the last tick, drive units.
    pub const fn residual(&self) -> R {
        self.residual
    }

    /// The observer's velocity, X/s.
    pub const fn velocity(&self) -> R {
        self.v
    }

    /// Readings are missing: the observer starts anew with the next one. What has been learnt stays.
    pub fn interrupt(&mut self) {
        let Self { sides, sums, low, high, .. } = *self;
        *self = Self { sides, sums, low, high, ..Self::default() };
    }

    /// Whether both directions are calibrated.
    pub fn is_calibrated(&self, watch: &DriftWatch<R>) -> bool {
        self.sides.iter().all(|side| side.blocks >= watch.calibration)
    }
}

impl<R: Fast> DriftWatch<R> {
    /// A watch over a model, at a tick of `tick_s` s.
    ///
    /// # Errors
    /// [`DriftError`] names the parameter.
    pub fn new<F: Real>(
        base: &Base<F>,
        effects: &[Effect<F>],
        settings: &DriftSettings<F>,
        tick_s: F,
    ) -> Result<Self, DriftError> {
        let model = Compensator::new(base, effects).map_err(DriftError::Model)?;
        let positive = |value: F| value.is_finite() && value > F::ZERO;
        if !positive(tick_s) {
            return Err(DriftError::Tick);
        }
        let DriftSettings { bandwidth_rad_s, rest_speed, settle_s, block_s, .. } = *settings;
        let DriftSettings { calibration, slack, threshold, smallest_scale, .. } = *settings;
        if !(positive(bandwidth_rad_s) && bandwidth_rad_s * tick_s <= F::from_f64(0.5)) {
            return Err(DriftError::Bandwidth);
        }
        if !positive(rest_speed) {
            return Err(DriftError::RestSpeed);
        }
        let hop = (block_s.scale(0.5) / tick_s).to_u32();
        if !(positive(block_s) && positive(settle_s) && (2..1 << 24).contains(&hop)) {
            return Err(DriftError::Block);
        }
        if calibration < 8 {
            return Err(DriftError::Calibration);
        }
        if !(positive(slack) && positive(threshold)) {
            return Err(DriftError::Threshold);
        }
        if !positive(smallest_scale) {
            return Err(DriftError::Scale);
        }
        let pole = (-bandwidth_rad_s * tick_s).exp_negative();
        let l1 = F::ONE - pole * pole;
        let l2 = (F::ONE - pole) * (F::ONE - pole);
        // ∫ and ∬ of the response to a force over a tick, in units of Ts/b and Ts²/b. They are (1 − e^(−z))/z and (1
        // − that)/z by their Padé fractions, to 5e-5 up to z = 0.3 and 1.5e-3 up to 1.
        let z = base.c * tick_s / base.b;
        let number = F::from_f64;
        let once = F::ONE / (F::ONE + z * (number(0.5) + z.scale(1.0 / 12.0)));
        let twice = number(0.5) / (F::ONE + z * (number(1.0 / 3.0) + z.scale(1.0 / 36.0)));
        let real = |value: F| R::from_f64(value.to_f64());
        Ok(Self {
            model,
            tick: real(tick_s),
            half: R::from_f64(0.5),
            to_v: real(once * tick_s / base.b),
            to_x: real(twice * tick_s * tick_s / base.b),
            l1: real(l1),
            l2: real(l2 / tick_s),
            force: real(base.b * l2 / (tick_s * tick_s) + base.c * l1 / tick_s),
            hop,
            // In the board's numbers: a division in f64 is a kilobyte of its flash.
            per_block: R::from_f64(0.5) / R::from_u32(hop),
            window: R::from_f64(15.0) / R::from_u32(hop),
            settle: (settle_s / tick_s).to_u32().min(1 << 24),
            rest_speed: real(rest_speed),
            calibration,
            per_calibration: R::ONE / R::from_u32(calibration),
            unsure: R::from_f64(UNSURE),
            slack: real(slack),
            threshold: real(threshold),
            smallest_scale: real(smallest_scale),
            cut: R::from_f64(CUT),
            per_bins: R::from_f64(1.0 / BINS as f64),
            per_memory: R::from_f64(0.25),
        })
    }

    /// One tick: `u` is the drive that was applied from the last reading until this one, behind any drive-path
    /// effects, and `x` the reading. Reports a mismatch once and starts to watch anew.
    pub fn tick(&self, state: &mut DriftState<R>, u: R, x: R) -> Option<ModelMismatch<R>> {
        if !state.started {
            state.interrupt();
            (state.started, state.x) = (true, x);
            if state.sides.iter().all(|side| side.blocks == 0) {
                (state.low, state.high) = (x, x);
            }
            return None;
        }
        self.observe(state, u, x);
        let sign = if state.v.abs() <= self.rest_speed {
            0
        } else if state.v > R::ZERO {
            1
        } else {
            -1
        };
        if sign == 0 || sign != state.sign {
            (state.sign, state.moving, state.count, state.overlaps) = (sign, 0, 0, false);
            (state.first, state.second) = (R::ZERO, R::ZERO);
            return None;
        }
        state.moving = state.moving.saturating_add(1);
        if state.moving < self.settle {
            return None;
        }
        state.first += self.weight(state.count) * state.residual;
        state.second += self.weight(state.count + self.hop) * state.residual;
        state.count += 1;
        if state.count < self.hop {
            return None;
        }
        let (mean, whole) = (state.second, state.overlaps);
        (state.count, state.overlaps, state.second, state.first) = (0, true, state.first, R::ZERO);
        if whole { self.block(state, sign, mean, x) } else { None }
    }

    /// The observer's step.
    fn observe(&self, state: &mut DriftState<R>, u: R, x: R) {
        let v = state.v;
        // At rest friction only answers the drive: nothing is missing, and the observer follows the readings.
        let net = if v == R::ZERO { R::ZERO } else { u - self.model.balance(state.x, v) };
        let (mut dv, mut dx) = (net * self.to_v, net * self.to_x);
        // Friction stops the axis and does not turn it around.
        if (v + dv) * v < R::ZERO {
            (dv, dx) = (-v, -v * self.tick * self.half);
        }
        let predicted = state.x + v * self.tick + dx;
        let error = x - predicted;
        state.x = predicted + self.l1 * error;
        state.v = v + dv + self.l2 * error;
        state.residual = self.force * error;
    }

    /// The window over a block at its tick `k`: its mean is 1 over the ticks of a block.
    fn weight(&self, k: u32) -> R {
        let tau = (R::from_u32(k) + self.half) * self.per_block;
        let rest = tau * (R::ONE - tau);
        self.window * rest * rest
    }

    /// The end of a block of mean residual `r`.
    fn block(&self, state: &mut DriftState<R>, sign: i8, r: R, x: R) -> Option<ModelMismatch<R>> {
        let calibrated = state.is_calibrated(self);
        let side = &mut state.sides[usize::from(sign > 0)];
        if side.blocks < self.calibration {
            side.blocks += 1;
            side.mean += r;
            side.scale += r * r;
            if side.blocks == self.calibration {
                let mean = side.mean * self.per_calibration;
                let variance = side.scale * self.per_calibration - mean * mean;
                side.mean = mean;
                side.scale = R::ONE / (variance.max(R::ZERO).sqrt() * self.unsure).max(self.smallest_scale);
            }
        }
        if !calibrated {
            state.low = state.low.min(x);
            state.high = state.high.max(x);
            return None;
        }
        let off = r - side.mean;
        let z = (off * side.scale).min(self.cut).max(-self.cut);
        let width = (state.high - state.low) * self.per_bins;
        let mut bin = 0;
        let mut edge = state.low + width;
        while bin + 1 < BINS && x > edge {
            bin += 1;
            edge += width;
        }
        if let Some(of_late) = side.bins.get_mut(bin) {
            *of_late += self.per_memory * (z - *of_late);
        }
        // Along the motion, and pushing in positive direction.
        let forward = sign > 0;
        let along = |value: R| if forward { value } else { -value };
        let mut found = None;
        for (i, sum) in state.sums.iter_mut().enumerate() {
            let (z, off) = if i < 2 { (z, off) } else { (along(z), along(off)) };
            let rises = i % 2 == 0;
            let g = sum.add(if rises { z } else { -z } - self.slack, off);
            if g > self.threshold {
                let pushes = if i < 2 { rises } else { rises == forward };
                let mean = sum.residual / R::from_u32(sum.blocks.max(1));
                found = Some((pushes, if i < 2 { mean } else { along(mean) }, sum.blocks));
            }
        }
        let (pushes, force, blocks) = found?;
        let score = force * side.scale * R::from_u32(blocks).sqrt();
        let (mut worst, mut most) = (bin, R::ZERO);
        for (i, of_late) in side.bins.iter().enumerate() {
            let pushed = if pushes { *of_late } else { -*of_late };
            if pushed > most {
                (worst, most) = (i, pushed);
            }
        }
        let position = state.low + width * R::from_i32(worst as i32) + (width * self.half);
        state.sums = [Sum::default(); 4];
        let direction = if pushes == forward { Direction::Assists } else { Direction::Resists };
        Some(ModelMismatch { direction, speed_sign: sign, bin: worst, position, force, score })
    }
}

impl<R: Fast> Sum<R> {
    /// Adds an increment and the residual behind it; the sum.
    fn add(&mut self, increment: R, residual: R) -> R {
        self.g = (self.g + increment).max(R::ZERO);
        if self.g > R::ZERO {
            self.blocks = self.blocks.saturating_add(1);
            self.residual += residual;
        } else {
            *self = Self::default();
        }
        self.g
    }
}

#[cfg(test)]
mod tests;
