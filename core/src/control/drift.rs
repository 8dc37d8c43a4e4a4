//! The watch over the model's validity: the one-step residual of the model, and a two-sided CUSUM on it.
//!
//! An observer predicts each position from the last one, the drive and the model; what is left, `ε = x − x̂`, corrects it
//! with a double pole at e^(−ωo·Ts). A force that the model misses shows as `r = ε·b·l2/Ts²`, drive units, after a few
//! 1/ωo. Residuals are averaged over blocks of three 1/ωo, which makes neighbours nearly independent, and blocks are
//! taken only where the axis moves one way and has done so for five 1/ωo. The first blocks of either direction teach
//! mean and scale (the calibrated stretch); later ones, in units of that scale and cut at ±4, feed per direction of motion
//!
//! ```text
//! g+ = max(0, g+ + z − k)      g− = max(0, g− − z − k)      alarm at g > h
//! ```
//!
//! (Page's cumulative sum, 1954). Because z is cut, no single block raises an alarm.

mod settings;

pub use settings::{DriftError, DriftSettings};

use super::compensator::Compensator;
use super::fast::Fast;
use crate::plant::Base;
use crate::plant::effect::Effect;
use crate::scalar::Real;

/// Bins of position.
pub const BINS: usize = 16;
/// Largest |z| that a block may count for.
const CUT: f64 = 4.0;

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
    /// Sign of the velocity in which it was found, −1 or 1.
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
    half_tick: R,
    per_b: R,
    /// Observer gains: on the position, and on the velocity (1/s).
    l1: R,
    l2: R,
    /// From ε to a force.
    force: R,
    block: u32,
    per_block: R,
    settle: u32,
    rest_speed: R,
    calibration: u32,
    per_calibration: R,
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
    up: Sum<R>,
    down: Sum<R>,
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
    count: u32,
    sum: R,
    sides: [Side<R>; 2],
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
            sum: R::ZERO,
            sides: [Side::default(); 2],
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
        let Self { sides, low, high, .. } = *self;
        *self = Self { sides, low, high, ..Self::default() };
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
        let DriftSettings { bandwidth_rad_s, rest_speed, calibration, slack, threshold, smallest_scale } = *settings;
        if !(positive(bandwidth_rad_s) && bandwidth_rad_s * tick_s <= F::from_f64(0.5)) {
            return Err(DriftError::Bandwidth);
        }
        if !positive(rest_speed) {
            return Err(DriftError::RestSpeed);
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
        let l2 = (F::ONE - pole) * (F::ONE - pole);
        let ticks = |time_constants: f64| {
            let exact = F::from_f64(time_constants) / (bandwidth_rad_s * tick_s);
            let whole = exact.to_u32().min(1_000_000_000);
            if F::from_u32(whole) < exact { whole + 1 } else { whole }
        };
        let block = ticks(3.0);
        let real = |value: F| R::from_f64(value.to_f64());
        Ok(Self {
            model,
            tick: real(tick_s),
            half_tick: real(tick_s.scale(0.5)),
            per_b: real(F::ONE / base.b),
            l1: real(F::ONE - pole * pole),
            l2: real(l2 / tick_s),
            force: real(base.b * l2 / (tick_s * tick_s)),
            block,
            per_block: R::ONE / R::from_u32(block),
            settle: ticks(5.0),
            rest_speed: real(rest_speed),
            calibration,
            per_calibration: R::ONE / R::from_u32(calibration),
            slack: real(slack),
            threshold: real(threshold),
            smallest_scale: real(smallest_scale),
            cut: R::from_f64(CUT),
            per_bins: R::from_f64(1.0 / BINS as f64),
            per_memory: R::from_f64(0.25),
        })
    }

    /// One tick: `u` is the drive that was applied from the last reading until this one (with drive-path effects: what
    /// they hand on), `x` the reading. Reports a mismatch once and starts to watch anew.
    pub fn tick(&self, state: &mut DriftState<R>, u: R, x: R) -> Option<ModelMismatch<R>> {
        if !state.started {
            state.interrupt();
            (state.started, state.x) = (true, x);
            if state.sides.iter().all(|side| side.blocks == 0) {
                (state.low, state.high) = (x, x);
            }
            return None;
        }
        let moving = state.v.abs() > self.rest_speed;
        let sign = if !moving {
            0
        } else if state.v > R::ZERO {
            1
        } else {
            -1
        };
        // At rest friction only answers the drive: nothing is missing, and the observer follows the readings.
        let a = if moving { (u - self.model.balance(state.x, state.v)) * self.per_b } else { R::ZERO };
        let dv = a * self.tick;
        let predicted = state.x + state.v * self.tick + dv * self.half_tick;
        let error = x - predicted;
        state.x = predicted + self.l1 * error;
        state.v += dv + self.l2 * error;
        state.residual = self.force * error;
        if sign == 0 || sign != state.sign {
            (state.sign, state.moving, state.count, state.sum) = (sign, 0, 0, R::ZERO);
            return None;
        }
        state.moving = state.moving.saturating_add(1);
        if state.moving < self.settle {
            return None;
        }
        state.sum += state.residual;
        state.count += 1;
        if state.count < self.block {
            return None;
        }
        let mean = state.sum * self.per_block;
        (state.count, state.sum) = (0, R::ZERO);
        self.block(state, sign, mean, x)
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
                side.scale = R::ONE / variance.sqrt().max(self.smallest_scale);
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
        let up = side.up.add(z - self.slack, off);
        let down = side.down.add(-z - self.slack, off);
        if up <= self.threshold && down <= self.threshold {
            return None;
        }
        let pushes = up > self.threshold;
        let found = if pushes { side.up } else { side.down };
        let blocks = R::from_i32((found.blocks.min(1 << 20) as i32).max(1));
        let force = found.residual / blocks;
        let score = force * side.scale * blocks.sqrt();
        let (mut worst, mut most) = (bin, R::ZERO);
        for (i, of_late) in side.bins.iter().enumerate() {
            let pushed = if pushes { *of_late } else { -*of_late };
            if pushed > most {
                (worst, most) = (i, pushed);
            }
        }
        let position = state.low + width * R::from_i32(worst as i32) + (width * self.half());
        for side in &mut state.sides {
            (side.up, side.down) = (Sum::default(), Sum::default());
        }
        let direction = if pushes == (sign > 0) { Direction::Assists } else { Direction::Resists };
        Some(ModelMismatch { direction, speed_sign: sign, bin: worst, position, force, score })
    }

    fn half(&self) -> R {
        self.per_memory + self.per_memory
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
