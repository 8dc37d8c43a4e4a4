//! The PID of the paper's remark 1 as a controller of its own: `u = b·Kv·s`, `s = Λ1·∫e + Λ2·e + ė`.

use super::fast::Fast;
use super::rate::{Differentiator, RateState};
use super::trajectory::Setpoint;
use super::tuning::{Gains, TuningError};
use crate::scalar::Real;

/// Configuration of the PID.
#[derive(Clone, Copy, Debug)]
pub struct Pid<R> {
    /// b·Kv·Λ2, drive units per X.
    proportional: R,
    /// b·Kv·Λ1·Ts, drive units per (X·tick).
    integral: R,
    /// b·Kv/Ts, drive units per (X/tick).
    derivative: R,
    rate: Differentiator<R>,
    /// X·ticks of the integral per drive unit that was cut off, in a tick: 1/(b·Kv·√Λ1), at most 1/(b·Kv·Λ1·Ts).
    back: R,
    /// Largest |u|, drive units.
    limit: R,
    /// Error within which the integral rests while the reference does, X.
    rest_band: R,
}

/// What the PID remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidState<R> {
    /// Σe, X·ticks.
    pub integral: R,
    rate: RateState<R>,
    /// What the integral becomes unless the drive is cut.
    pending: R,
}

impl<R: Fast> Pid<R> {
    /// A PID with a tick of `tick_s` s and a drive of at most ±`limit`; its limits are those of one tick of delay.
    ///
    /// # Errors
    /// [`TuningError`], with the largest allowed rate.
    pub fn new<F: Real>(gains: &Gains<F>, tick_s: F, limit: F) -> Result<Self, TuningError> {
        Self::with_delay(gains, tick_s, 1, limit)
    }

    /// The same for `delay_ticks` ticks from reading to drive.
    ///
    /// # Errors
    /// [`TuningError`], with the largest allowed rate.
    pub fn with_delay<F: Real>(gains: &Gains<F>, tick_s: F, delay_ticks: u32, limit: F) -> Result<Self, TuningError> {
        gains.check(tick_s, delay_ticks)?;
        let drives = limit > F::ZERO;
        if !drives {
            return Err(TuningError::Limit);
        }
        let k = gains.b * gains.kv;
        let real = |value: F| R::from_f64(value.to_f64());
        Ok(Self {
            proportional: real(k * gains.lambda2),
            integral: real(k * gains.lambda1 * tick_s),
            derivative: real(k / tick_s),
            rate: Differentiator::new(gains, tick_s),
            back: real(gains.back_calculation(tick_s)),
            limit: real(limit),
            rest_band: R::ZERO,
        })
    }

    /// The integral rests while the reference does and |e| ≤ `band` (X, ≥ 0; usually one encoder step). The position
    /// within a step is not known. An integral that goes on would break the axis away again and again where friction
    /// at rest is above that in motion.
    #[must_use]
    pub fn with_rest_band(self, band: f64) -> Self {
        Self { rest_band: R::from_f64(band).max(R::ZERO), ..self }
    }

    /// The largest |u|.
    pub const fn limit(&self) -> R {
        self.limit
    }

    /// The drive for position `x`; [`Self::update`] must follow, once it is known what of the drive was cut off.
    #[inline]
    pub fn drive(&self, state: &mut PidState<R>, reference: Setpoint<R>, x: R) -> R {
        let e = reference.x - x;
        let rate = self.rate.tick(&mut state.rate, e);
        let resting = reference.v == R::ZERO && reference.a == R::ZERO && e.abs() <= self.rest_band;
        state.pending = if resting { state.integral } else { state.integral + e };
        self.integral * state.pending + self.proportional * e + self.derivative * rate
    }

    /// Ends a tick whose drive was applied as it is: the integral goes on.
    #[inline]
    pub fn update(&self, state: &mut PidState<R>) {
        state.integral = state.pending;
    }

    /// Ends a tick whose drive was cut; `excess` is the applied drive less the computed one. The integral goes back
    /// by the excess over the tracking time 1/√Λ1 (docs/control.md, section "The PID").
    #[inline]
    pub fn cut(&self, state: &mut PidState<R>, excess: R) {
        state.integral += self.back * excess;
    }
}

#[cfg(test)]
mod tests;
