//! The PID of the paper's remark 1, tuned from the identified (b, c) and a bandwidth.
//!
//! `u = b·Kv·s`, `s = Λ1·∫e + Λ2·e + ė` (docs/control.md, section "The PID"; b is what (paper 24) puts before u_c).
//! With the plant the open loop is `L(s) = Kv·(s² + Λ2·s + Λ1)/(s²·(s + c/b))`. Λ1 and Λ2 put one zero at ωc/4 and
//! the other on the plant's pole c/b, but within ωc/4..4ωc. That is a double zero at ωc/4 for little damping, and
//! nearly a PI for much. Kv makes |L| = 1 at ωc. In continuous time the phase margin is then at least 62° for any c.

mod encoder;

pub use encoder::{Resolution, encoder_bandwidth_hz, tune_behind};

use super::margins::margins;
use crate::says::says;
use crate::scalar::Real;

/// Gains of the PID and of the adaptive law; in f64, or in what the board computes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains<F = f64> {
    /// b the gains are for, drive units per (X/s²).
    pub b: F,
    /// Kv, 1/s.
    pub kv: F,
    /// Λ1, 1/s².
    pub lambda1: F,
    /// Λ2, 1/s.
    pub lambda2: F,
    /// Time constant of the filter on ė, s; 0 for none.
    pub filter_s: F,
    /// Bandwidth ωo of the observer that ė is read from, rad/s; 0 for none, which is the difference of two readings.
    pub observer_rad_s: F,
}

/// Why gains are refused; with the largest that would do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TuningError {
    /// b is not finite and positive.
    B,
    /// c is not finite and non-negative.
    C,
    /// The tick is not finite and positive.
    Tick,
    /// The drive limit is not positive.
    Limit,
    /// Kv, Λ1, Λ2, the filter's time or the observer's bandwidth is not finite and non-negative, or Kv or Λ2 is 0.
    Gain,
    /// The bandwidth is not finite and positive, or past what the sampled loop allows.
    Bandwidth {
        /// The largest bandwidth that is allowed, Hz.
        largest_hz: f64,
    },
    /// Kv + Λ2 is past [`largest_rate`].
    Rate {
        /// The largest Kv + Λ2 that is allowed, 1/s.
        largest_per_s: f64,
    },
}

says! { TuningError:
    Self::B => "b must be a finite number above 0",
    Self::C => "c must be a finite number, 0 or more",
    Self::Tick => "the tick must be above 0",
    Self::Limit => "the drive limit must be above 0",
    Self::Gain => "kv and lambda2 must be above 0, lambda1, filter_s and observer_rad_s 0 or more",
    Self::Bandwidth { largest_hz } => "the bandwidth is past what this tick and delay allow; the largest for this model is {largest_hz:.4} Hz",
    Self::Rate { largest_per_s } => "kv + lambda2 is past what this tick and delay allow; the largest is {largest_per_s:.4} per s",
}

/// The largest Kv + Λ2, 1/s: `(Kv + Λ2)·Ts ≤ 0.8/(1 + d)` for `d` ticks of delay, 0.4 for the usual one
/// (docs/control.md, section "The PID"). It leaves half the way to instability: an integrating loop with the hold's and the
/// difference's half ticks becomes unstable at (π/2)/(1 + d).
pub fn largest_rate(tick_s: f64, delay_ticks: u32) -> f64 {
    0.8 / ((1.0 + f64::from(delay_ticks)) * tick_s)
}

/// Limits are passed by no more than this: the largest value allowed must itself pass, in f32 too.
pub(super) const ROUNDING: f64 = 1.0 + 1e-6;

impl<F: Real> Gains<F> {
    /// Checks the ranges, and the limits of the sampled loop at `delay_ticks` ticks from reading to drive.
    ///
    /// # Errors
    /// [`TuningError`] names what is out of range, with the largest allowed rate.
    pub fn check(&self, tick_s: F, delay_ticks: u32) -> Result<(), TuningError> {
        if !(tick_s.is_finite() && tick_s > F::ZERO) {
            return Err(TuningError::Tick);
        }
        if !(self.b.is_finite() && self.b > F::ZERO) {
            return Err(TuningError::B);
        }
        let ranges = [self.kv, self.lambda2, self.lambda1, self.filter_s, self.observer_rad_s];
        if ranges.iter().any(|g| !g.is_finite() || *g < F::ZERO) || self.kv == F::ZERO || self.lambda2 == F::ZERO {
            return Err(TuningError::Gain);
        }
        let largest = Self::largest_rate(tick_s, delay_ticks);
        if self.kv + self.lambda2 > largest.scale(ROUNDING) {
            return Err(TuningError::Rate { largest_per_s: largest.to_f64() });
        }
        Ok(())
    }

    /// X·ticks by which the integral goes back per drive unit that was cut off, in a tick. The drive unit is
    /// 1/(b·Kv·Λ1·Ts) of them. The tracking time is 1/√Λ1, at most all of it in a tick. It is the geometric mean of
    /// the PID's integral time Λ2/Λ1 and derivative time 1/Λ2. Without an integral 0.
    pub(super) fn back_calculation(&self, tick_s: F) -> F {
        if self.lambda1 == F::ZERO {
            return F::ZERO;
        }
        let ticks = (F::ONE / (self.lambda1.sqrt() * tick_s)).max(F::ONE);
        F::ONE / (self.b * self.kv * self.lambda1 * tick_s * ticks)
    }

    /// [`largest_rate`], in what the board computes in.
    pub(super) fn largest_rate(tick_s: F, delay_ticks: u32) -> F {
        F::from_f64(0.8) / (F::from_f64(1.0 + f64::from(delay_ticks)) * tick_s)
    }
}

/// Gains at a crossover of `w` rad/s.
fn gains_at(b: f64, c: f64, w: f64) -> Gains {
    let pole = c / b;
    let (zero, other) = (0.25 * w, pole.clamp(0.25 * w, 4.0 * w));
    let kv = w * w * libm::hypot(w, pole) / (libm::hypot(w, zero) * libm::hypot(w, other));
    // An eighth of the crossover's period over 2π: 7° of phase for a quarter of the encoder's noise at high rates.
    Gains { b, kv, lambda1: zero * other, lambda2: zero + other, filter_s: 0.125 / w, observer_rad_s: 0.0 }
}

/// The largest bandwidth that [`tune`] accepts, Hz; 0 for a plant or tick that is none.
pub fn largest_bandwidth_hz(b: f64, c: f64, tick_s: f64, delay_ticks: u32) -> f64 {
    // In Hz, as `tune` has it: what is found is accepted to the last bit.
    let allowed = |hz: f64| acceptable(&gains_at(b, c, core::f64::consts::TAU * hz), b, c, tick_s, delay_ticks);
    let mut low = 0.0;
    let mut high = largest_rate(tick_s, delay_ticks) / core::f64::consts::TAU;
    if !(high.is_finite() && high > 0.0 && b > 0.0 && c >= 0.0 && b.is_finite() && c.is_finite()) {
        return 0.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if allowed(middle) { low = middle } else { high = middle }
    }
    low
}

/// Within the rate's limit, and with 30° of phase and a factor of two of gain in hand.
fn acceptable(gains: &Gains, b: f64, c: f64, tick_s: f64, delay_ticks: u32) -> bool {
    gains.check(tick_s, delay_ticks).is_ok()
        && margins(gains, b, c, tick_s, delay_ticks).is_some_and(|m| m.phase_deg >= 30.0 && m.gain >= 2.0)
}

/// PID gains for the plant (b, c) at an open-loop crossover of `bandwidth_hz`. The loop is sampled every `tick_s`
/// seconds, with `delay_ticks` ticks from reading a position to applying the drive computed from it.
///
/// # Errors
/// [`TuningError`]. A bandwidth past the sampled loop's limit is refused with the largest that is not. The limit is
/// [`largest_rate`], 30° of phase and a factor of two of gain in hand.
pub fn tune(b: f64, c: f64, bandwidth_hz: f64, tick_s: f64, delay_ticks: u32) -> Result<Gains, TuningError> {
    if !(b.is_finite() && b > 0.0) {
        return Err(TuningError::B);
    }
    if !(c.is_finite() && c >= 0.0) {
        return Err(TuningError::C);
    }
    if !(tick_s.is_finite() && tick_s > 0.0) {
        return Err(TuningError::Tick);
    }
    let refused = || TuningError::Bandwidth { largest_hz: largest_bandwidth_hz(b, c, tick_s, delay_ticks) };
    if !(bandwidth_hz.is_finite() && bandwidth_hz > 0.0) {
        return Err(refused());
    }
    let gains = gains_at(b, c, core::f64::consts::TAU * bandwidth_hz);
    if acceptable(&gains, b, c, tick_s, delay_ticks) { Ok(gains) } else { Err(refused()) }
}

#[cfg(test)]
mod tests;
