//! The current loop: a PI from the current's error to the bridge's voltage, so that the drive may be amperes.
//!
//! A winding of R and L under a voltage that is held for a tick Ts is `i⁺ = a·i + (1 − a)/R·u`, a = e^(−R·Ts/L). The PI's
//! zero is put on the pole a. What is left is an integrator, `ωc·Ts/(z − 1)`, at any L:
//!
//! ```text
//! u = kp·e + S      S⁺ = S + ki·e      kp = a·ωc·Ts·R/(1 − a)      ki = ωc·Ts·R
//! ```
//!
//! Of the applied voltage S is `S⁺ = a·S + (1 − a)·u`, R times the current of a winding that has it. So it stays where
//! u is cut. The current then goes to its end as fast as the bridge lets it, without the slow pole a.
//!
//! With L = 0, not known, it is an integral alone. The back-EMF is a disturbance that S makes up for within L/R. The delay from the
//! reading to the middle of the voltage's hold takes ωc·delay of the phase of 90°
//! (docs/control.md, section "The current loop").

use crate::says::says;
use crate::scalar::Real;

/// Phase margin at the bandwidth that [`Winding::largest_bandwidth`] gives, rad: 60°, at which a step does not overshoot by more than
/// a twelfth.
const MARGIN: f64 = core::f64::consts::FRAC_PI_3;

/// A motor's winding, from its name plate or identified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding<F = f64> {
    /// Resistance between the bridge's ends, with its switches and the shunt, Ω, > 0.
    pub resistance: F,
    /// Inductance, H, ≥ 0; 0 where it is not known.
    pub inductance: F,
}

/// Why a current loop is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurrentLoopError {
    /// The resistance is not finite and positive.
    Resistance,
    /// The inductance is not finite and non-negative.
    Inductance,
    /// The tick or the delay is not finite and positive.
    Tick,
    /// The bandwidth is not finite and positive, or past what the delay allows.
    Bandwidth,
}

says! { CurrentLoopError:
    Self::Resistance => "the resistance must be a finite number above 0",
    Self::Inductance => "the inductance must be a finite number, 0 or more",
    Self::Tick => "tick and delay must be finite numbers above 0",
    Self::Bandwidth => "the bandwidth of the current loop is not above 0, or leaves less than 60° of phase",
}

impl<F: Real> Winding<F> {
    /// The largest bandwidth behind a delay of `delay_s` from the reading to the middle of the hold, rad/s: 60° of
    /// phase margin. Where the inductance is not known it is a tenth of that. An L/R of up to ten times the delay then
    /// costs no more than 45°.
    pub fn largest_bandwidth(&self, delay_s: F) -> F {
        let largest = F::from_f64(core::f64::consts::FRAC_PI_2 - MARGIN) / delay_s;
        if self.inductance > F::ZERO { largest } else { largest.scale(0.1) }
    }
}

/// Configuration of the loop. Voltage and current may have any units; U and I stand for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop<R> {
    /// kp, U per I.
    proportional: R,
    /// ki, U per I and tick.
    integral: R,
    /// 1 − a: the share of a cut voltage by which S goes back.
    back: R,
}

/// What the loop remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurrentLoopState<R> {
    /// S, U.
    pub integral: R,
    /// S of the next tick, unless the voltage is cut.
    pending: R,
}

impl<R: Real> CurrentLoop<R> {
    /// The loop for a winding at a tick of `tick_s` s; `bandwidth_rad_s` is ωc, 0 for the largest. `volt` and `ampere` are how many U
    /// and I these are.
    ///
    /// # Errors
    /// [`CurrentLoopError`].
    pub fn new<F: Real>(
        winding: &Winding<F>,
        bandwidth_rad_s: F,
        tick_s: F,
        delay_s: F,
        volt: F,
        ampere: F,
    ) -> Result<Self, CurrentLoopError> {
        let Winding { resistance, inductance } = *winding;
        let positive = |value: F| value.is_finite() && value > F::ZERO;
        if !positive(resistance) {
            return Err(CurrentLoopError::Resistance);
        }
        if !(inductance.is_finite() && inductance >= F::ZERO) {
            return Err(CurrentLoopError::Inductance);
        }
        if !(positive(tick_s) && positive(delay_s) && positive(volt) && positive(ampere)) {
            return Err(CurrentLoopError::Tick);
        }
        let largest = winding.largest_bandwidth(delay_s);
        let bandwidth = if bandwidth_rad_s == F::ZERO { largest } else { bandwidth_rad_s };
        // The largest one, as somebody else has rounded it, is not past itself.
        if !(positive(bandwidth) && bandwidth <= winding_limit(delay_s).scale(1.000_01)) {
            return Err(CurrentLoopError::Bandwidth);
        }
        let a = if inductance > F::ZERO { (-(resistance * tick_s / inductance)).exp_negative() } else { F::ZERO };
        let both = bandwidth * tick_s * resistance * volt / ampere;
        let real = |value: F| R::from_f64(value.to_f64());
        // A pole at 1 within the number's digits is a winding without resistance beside its inductance.
        let proportional = if a < F::ONE { a * both / (F::ONE - a) } else { bandwidth * inductance * volt / ampere };
        // ki/(kp + ki) is 1 − a, and never 0.
        let back = real(both / (proportional + both));
        Ok(Self { proportional: real(proportional), integral: real(both), back })
    }

    /// The voltage for a reference and a measured current; [`Self::update`] or [`Self::cut`] must follow.
    #[inline]
    pub fn drive(&self, state: &mut CurrentLoopState<R>, reference: R, current: R) -> R {
        let e = reference - current;
        state.pending = state.integral + self.integral * e;
        state.pending + self.proportional * e
    }

    /// Ends a tick whose voltage was applied as it is.
    #[inline]
    pub fn update(&self, state: &mut CurrentLoopState<R>) {
        state.integral = state.pending;
    }

    /// Ends a tick whose voltage was cut; `excess` is the applied one less the computed one. S follows the applied one.
    #[inline]
    pub fn cut(&self, state: &mut CurrentLoopState<R>, excess: R) {
        state.integral = state.pending + self.back * excess;
    }
}

/// The bandwidth with [`MARGIN`] behind a delay, rad/s.
fn winding_limit<F: Real>(delay_s: F) -> F {
    F::from_f64(core::f64::consts::FRAC_PI_2 - MARGIN) / delay_s
}

#[cfg(test)]
mod tests;
