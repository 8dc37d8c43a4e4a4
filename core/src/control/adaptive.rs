//! The adaptive law, corrected (docs/theory.md, section 6; errata 27–33 of the paper's eqs 22–31).
//!
//! ```text
//! s = Λ1·∫e + Λ2·e + ė       s_Δ = s − δ·sat(s/δ)       e = x_d − x
//! u_c = −Λ1·e − Λ2·ė − ẍ_d − Kv·s_Δ
//! u = ĉ·v − b̂·u_c + f̂1·sgn v + f̂·sat(s/δ)
//! ĉ' = kc·v·s_Δ    b̂' = −kb·u_c·s_Δ    f̂1' = kf1·sgn v·s_Δ    f̂' = kf·(|s_Δ| − σ·f̂)
//! ```
//!
//! The paper's â and f̂2 have the same regressor v up to its sign. They act only as ĉ = f̂2 − â, whose law is theirs
//! with kc = ka + kf2. No data separate them (section 1). On top of the paper: b_min ≤ b̂ ≤ b_max and f̂1, ĉ, f̂ ≥ 0
//! by projection. At b_max the loop, whose gain goes with b̂/b, leaves what tick and delay allow
//! ([`crate::control::largest_rate`]). σ lets f̂ fall again. While the drive is saturated adaptation is frozen, and
//! the integral goes back by what was cut off. Gains are scaled by the parameters' own sizes.

mod settings;

pub use settings::{Adaptation, AdaptiveError, Estimates, least_delta};

use super::fast::Fast;
use super::rate::{Differentiator, RateState};
use super::trajectory::Setpoint;
use super::tuning::{Gains, ROUNDING, TuningError};
use crate::scalar::Real;

/// Configuration of the adaptive controller. In Q32 a gain times the tick has steps of 2.3e-10, and below that is 0.
#[derive(Clone, Copy, Debug)]
pub struct Adaptive<R> {
    lambda1: R,
    lambda2: R,
    kv: R,
    /// Kv within δ: Kv or 0.
    kv_inside: R,
    delta: R,
    per_delta: R,
    tick: R,
    per_tick: R,
    rate: Differentiator<R>,
    /// Adaptation gains times the tick.
    steps: Estimates<R>,
    sigma: R,
    b_min: R,
    b_max: R,
    /// X·s of the integral per drive unit that was cut off, in a tick.
    back: R,
    limit: R,
    start: Estimates<R>,
}

/// What the adaptive controller remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AdaptiveState<R> {
    /// The adapted parameters.
    pub estimates: Estimates<R>,
    /// ∫e, X·s.
    pub integral: R,
    rate: RateState<R>,
    now: Regressors<R>,
}

/// What this tick's drive was made of: the adaptation needs it once it is known whether the drive saturated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Regressors<R> {
    integral: R,
    s_delta: R,
    v: R,
    u_c: R,
    direction: R,
}

/// Exact signals in place of those made from positions, for simulation and proofs.
#[derive(Clone, Copy, Debug)]
pub struct Ideal<R> {
    /// e, X.
    pub error: R,
    /// ė, X/s.
    pub error_rate: R,
    /// What the law takes for sgn v.
    pub direction: R,
}

impl<R: Fast> Adaptive<R> {
    /// An adaptive controller that starts at `start`; `gains.b` is the b its limits are for.
    ///
    /// # Errors
    /// [`AdaptiveError`] names what is out of range, with the largest allowed gain.
    pub fn new<F: Real>(
        gains: &Gains<F>,
        adaptation: &Adaptation<F>,
        start: &Estimates<F>,
        tick_s: F,
        delay_ticks: u32,
        limit: F,
    ) -> Result<Self, AdaptiveError> {
        gains.check(tick_s, delay_ticks).map_err(AdaptiveError::Gains)?;
        let drives = limit > F::ZERO;
        if !drives {
            return Err(AdaptiveError::Gains(TuningError::Limit));
        }
        let Adaptation { gains: k, sigma, delta, b_min, pid_inside, speed, acceleration } = *adaptation;
        let known = |value: F| value.is_finite() && value >= F::ZERO;
        if !(delta.is_finite() && delta > F::ZERO) {
            return Err(AdaptiveError::Delta);
        }
        if !(known(sigma) && sigma * k.f * tick_s <= F::ONE) {
            return Err(AdaptiveError::Sigma);
        }
        if !known(b_min) {
            return Err(AdaptiveError::SmallestB);
        }
        if ![start.b, start.c, start.f1, start.f].into_iter().all(known) {
            return Err(AdaptiveError::Start);
        }
        if !(known(speed) && known(acceleration)) {
            return Err(AdaptiveError::Motion);
        }
        // |φ|·√(k/b)·Ts ≤ 0.1.
        let largest = |phi: F| {
            let rate = F::from_f64(0.1) / (phi.max(F::from_f64(1e-12)) * tick_s);
            gains.b * rate * rate
        };
        let within = |value: F, phi: F| known(value) && value <= largest(phi).scale(ROUNDING);
        if !within(k.b, acceleration) {
            return Err(AdaptiveError::B { largest: largest(acceleration).to_f64() });
        }
        if !within(k.c, speed) {
            return Err(AdaptiveError::C { largest: largest(speed).to_f64() });
        }
        if !within(k.f1, F::ONE) {
            return Err(AdaptiveError::F1 { largest: largest(F::ONE).to_f64() });
        }
        if !within(k.f, F::ONE) {
            return Err(AdaptiveError::F { largest: largest(F::ONE).to_f64() });
        }
        // (b̂/b)·(Kv + Λ2) is what the sampled loop has for its rate; a start beyond it is not learnt away from.
        let b_max = gains.b * Gains::largest_rate(tick_s, delay_ticks) / (gains.kv + gains.lambda2);
        let real = |value: F| R::from_f64(value.to_f64());
        Ok(Self {
            lambda1: real(gains.lambda1),
            lambda2: real(gains.lambda2),
            kv: real(gains.kv),
            kv_inside: real(if pid_inside { gains.kv } else { F::ZERO }),
            delta: real(delta),
            per_delta: real(F::ONE / delta),
            tick: real(tick_s),
            per_tick: real(F::ONE / tick_s),
            rate: Differentiator::new(gains, tick_s),
            steps: Estimates {
                b: real(k.b * tick_s),
                c: real(k.c * tick_s),
                f1: real(k.f1 * tick_s),
                f: real(k.f * tick_s),
            },
            sigma: real(sigma),
            b_min: real(b_min),
            b_max: real(b_max.max(start.b).max(b_min)),
            back: real(gains.back_calculation(tick_s) * tick_s),
            limit: real(limit),
            start: Estimates { b: real(start.b), c: real(start.c), f1: real(start.f1), f: real(start.f) },
        })
    }

    /// The state at the start.
    pub fn start(&self) -> AdaptiveState<R> {
        AdaptiveState { estimates: self.start, ..AdaptiveState::default() }
    }

    /// The largest |u|.
    pub const fn limit(&self) -> R {
        self.limit
    }

    /// The drive for position `x`, with ė from e by observer and filter, and v = ẋ_d − ė; `direction` is the sign of the
    /// reference's velocity. [`Self::update`] must follow.
    #[inline]
    pub fn drive(&self, state: &mut AdaptiveState<R>, reference: Setpoint<R>, x: R, direction: R) -> R {
        let error = reference.x - x;
        let rate = self.rate.tick(&mut state.rate, error);
        self.drive_ideal(state, reference, Ideal { error, error_rate: rate * self.per_tick, direction })
    }

    /// The drive from given signals. [`Self::update`] must follow.
    #[inline]
    pub fn drive_ideal(&self, state: &mut AdaptiveState<R>, reference: Setpoint<R>, signals: Ideal<R>) -> R {
        let Ideal { error: e, error_rate, direction } = signals;
        let v = reference.v - error_rate;
        let integral = state.integral + e * self.tick;
        let s = self.lambda1 * state.integral + self.lambda2 * e + error_rate;
        let sat = (s * self.per_delta).min(R::ONE).max(-R::ONE);
        let inside = self.delta * sat;
        let s_delta = s - inside;
        let feedback = self.kv * s_delta + self.kv_inside * inside;
        let u_c = -(self.lambda1 * e + self.lambda2 * error_rate + reference.a + feedback);
        state.now = Regressors { integral, s_delta, v, u_c, direction };
        let Estimates { b, c, f1, f } = state.estimates;
        c * v - b * u_c + f1 * direction + f * sat
    }

    /// Ends a tick whose drive was cut; `excess` is the applied drive less the computed one. Nothing adapts, and the
    /// integral goes back by the excess over the tracking time 1/√Λ1, as the PID's.
    #[inline]
    pub fn cut(&self, state: &mut AdaptiveState<R>, excess: R) {
        state.integral += self.back * excess;
    }

    /// Ends a tick whose drive was applied as it is: the integral goes on and the parameters adapt.
    #[inline]
    pub fn update(&self, state: &mut AdaptiveState<R>) {
        let Regressors { integral, s_delta, v, u_c, direction } = state.now;
        state.integral = integral;
        if s_delta == R::ZERO && self.sigma == R::ZERO {
            return;
        }
        let hat = &mut state.estimates;
        let k = &self.steps;
        hat.b = (hat.b - k.b * u_c * s_delta).max(self.b_min).min(self.b_max);
        hat.c = (hat.c + k.c * v * s_delta).max(R::ZERO);
        hat.f1 = (hat.f1 + k.f1 * direction * s_delta).max(R::ZERO);
        hat.f = (hat.f + k.f * (s_delta.abs() - self.sigma * hat.f)).max(R::ZERO);
    }
}

#[cfg(test)]
mod tests;
