//! The rate of the error behind an encoder: a tracking observer, which is a phase-locked loop of second order, and a filter.
//!
//! ```text
//! ê⁻ = ê + r      i = e − ê⁻      ê = ê⁻ + (1 − p²)·i      r' = r + (1 − p)²·i      p = 1/(1 + ωo·Ts)
//! ```
//!
//! Both poles are at p, so it is stable at any ωo and does not overshoot. It is as late as two filters of 1/ωo.
//! Without an observer p is 0, and r the plain difference. What a count makes of r rises over the time 1/ωo to ωo/e
//! per second. In a filter of the same delay it is there at once (docs/control.md, section "The encoder").

use super::tuning::Gains;
use crate::scalar::Real;

/// Configuration of the differentiator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Differentiator<R> {
    /// 1 − p².
    to_error: R,
    /// (1 − p)².
    to_rate: R,
    /// Share of the new rate in the filtered one.
    alpha: R,
}

/// What the differentiator remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RateState<R> {
    /// ê, X; `None` before the first tick.
    error: Option<R>,
    /// r, X/tick.
    rate: R,
    /// The same behind the filter.
    filtered: R,
}

/// Most ticks in which the peak of [`Gains::rate_of_step`] is looked for: slower observers have no margins at any tick.
const MOST_TICKS: usize = 100_000;

impl<R: Real> Differentiator<R> {
    /// The one of checked gains at a tick of `tick_s` s.
    pub(super) fn new<F: Real>(gains: &Gains<F>, tick_s: F) -> Self {
        let (p, alpha) = gains.poles(tick_s);
        let inside = F::ONE - p;
        let real = |value: F| R::from_f64(value.to_f64());
        Self { to_error: real(inside * (F::ONE + p)), to_rate: real(inside * inside), alpha: real(alpha) }
    }

    /// The filtered rate of `error`, X/tick; 0 in the first tick.
    #[allow(clippy::inline_always, reason = "cheaper than its call, in every tick of an image built for size")]
    #[inline(always)]
    pub(super) fn tick(&self, state: &mut RateState<R>, error: R) -> R {
        let predicted = state.error.unwrap_or(error) + state.rate;
        let innovation = error - predicted;
        state.error = Some(predicted + self.to_error * innovation);
        state.rate += self.to_rate * innovation;
        state.filtered += self.alpha * (state.rate - state.filtered);
        state.filtered
    }
}

impl<F: Real> Gains<F> {
    /// The observer's pole p, and the share of the new rate in the filtered one.
    pub(super) fn poles(&self, tick_s: F) -> (F, F) {
        let p = if self.observer_rad_s > F::ZERO { F::ONE / (F::ONE + self.observer_rad_s * tick_s) } else { F::ZERO };
        (p, tick_s / (self.filter_s + tick_s))
    }

    /// The largest rate that the loop sees of a step of the error by 1, 1/s.
    pub fn rate_of_step(&self, tick_s: F) -> F {
        let differentiator = Differentiator::<F>::new(self, tick_s);
        let mut state = RateState { error: Some(F::ZERO), ..RateState::default() };
        let mut largest = F::ZERO;
        for _ in 0..MOST_TICKS {
            // It rises to one peak and falls for ever.
            let rate = differentiator.tick(&mut state, F::ONE);
            if rate <= largest {
                break;
            }
            largest = rate;
        }
        largest / tick_s
    }

    /// The largest drive that one count of `step` (X) makes: b·Kv·(Λ2 + the rate)·step.
    pub fn drive_of_count(&self, step: F, tick_s: F) -> F {
        self.b * self.kv * (self.lambda2 + self.rate_of_step(tick_s)) * step
    }
}

#[cfg(test)]
mod tests;
