//! The dual relay that shakes the axis into a limit cycle.
//!
//! `u = h1·sgn(e) + h2·sgn(∫e)`, `e = r − x` (paper section 3, docs/theory.md, section 2). The first relay (FR1) acts
//! as a spring, the second (FR2) as negative damping that feeds what friction takes. Because FR2 acts on the
//! integral, a cycle can only repeat when `∫e` returns to itself. The mean of `e` goes to zero, and the axis does not
//! drift, with a constant load too.

use core::ops::{Add, Neg};

use crate::says::says;
use crate::scalar::Real;

/// What is wrong with a relay's configuration; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RelayError {
    /// `h1` is not finite and positive.
    H1,
    /// `h2` is not finite and positive. (That a cycle needs `h2 > f1` only the experiment can tell.)
    H2,
    /// `h1 + h2` is more than the drive can represent.
    Sum,
    /// `hysteresis` is above 2³⁰ counts, or not finite or negative.
    Hysteresis,
}

says! { RelayError:
    Self::H1 => "h1 must be a finite number above 0",
    Self::H2 => "h2 must be a finite number above 0",
    Self::Sum => "h1 + h2 is more than the drive can represent",
    Self::Hysteresis => "the hysteresis must be 0 or more, and at most 2³⁰ counts",
}

/// Configuration of the dual relay. The error is an integer (encoder counts); the drive is an integer drive code
/// (`DualRelay<i32>`) or a real amplitude (`DualRelay<R>`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualRelay<A> {
    h1: A,
    h2: A,
    hysteresis: i32,
}

/// What the dual relay remembers: the sign of each relay, never 0, and the error's sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DualRelayState {
    positive1: bool,
    positive2: bool,
    integral: i64,
}

impl Default for DualRelayState {
    fn default() -> Self {
        Self::new()
    }
}

impl DualRelayState {
    /// Both relays at +1 and an empty integral: the first tick drives at `h1 + h2`, the most that can break away.
    #[must_use]
    pub const fn new() -> Self {
        Self { positive1: true, positive2: true, integral: 0 }
    }

    /// Σe in count·ticks.
    #[must_use]
    pub const fn integral(&self) -> i64 {
        self.integral
    }

    /// The signs of FR1 and FR2, each −1 or +1.
    #[must_use]
    pub const fn signs(&self) -> (i8, i8) {
        (if self.positive1 { 1 } else { -1 }, if self.positive2 { 1 } else { -1 })
    }
}

/// The default hysteresis on the error: 3σ + 1 count (docs/theory.md, section 2).
///
/// `sigma_counts` is the standard deviation of the position noise in counts.
///
/// # Errors
/// [`RelayError::Hysteresis`] when `sigma_counts` is negative, not finite, or above 2³⁰/3.
pub fn default_hysteresis<R: Real>(sigma_counts: R) -> Result<u32, RelayError> {
    let value = 3.0 * sigma_counts.to_f64() + 1.0;
    if !sigma_counts.is_finite() || value.is_nan() || value < 1.0 || value > f64::from(MAX_HYSTERESIS) {
        return Err(RelayError::Hysteresis);
    }
    Ok(libm::ceil(value) as u32)
}

const MAX_HYSTERESIS: u32 = 1 << 30;

impl DualRelay<i32> {
    /// A relay whose amplitudes are drive codes.
    ///
    /// # Errors
    /// `h1 ≤ 0`, `h2 ≤ 0`, `h1 + h2` above `i32::MAX`, or a hysteresis above 2³⁰ counts.
    pub fn new(h1: i32, h2: i32, hysteresis_counts: u32) -> Result<Self, RelayError> {
        if h1 <= 0 {
            return Err(RelayError::H1);
        }
        if h2 <= 0 {
            return Err(RelayError::H2);
        }
        if h1.checked_add(h2).is_none() {
            return Err(RelayError::Sum);
        }
        Self::checked(h1, h2, hysteresis_counts)
    }
}

impl<R: Real> DualRelay<R> {
    /// A relay whose amplitudes are real, in drive units.
    ///
    /// # Errors
    /// As [`DualRelay::new`], and amplitudes that are not finite.
    pub fn with_real_drive(h1: R, h2: R, hysteresis_counts: u32) -> Result<Self, RelayError> {
        if !(h1.is_finite() && h1 > R::ZERO) {
            return Err(RelayError::H1);
        }
        if !(h2.is_finite() && h2 > R::ZERO) {
            return Err(RelayError::H2);
        }
        let sum = h1 + h2;
        // Floats overflow to infinity; fixed point saturates, and then the sum no longer holds its part.
        if !sum.is_finite() || sum - h1 < h2 * R::from_f64(0.5) {
            return Err(RelayError::Sum);
        }
        Self::checked(h1, h2, hysteresis_counts)
    }
}

impl<A> DualRelay<A> {
    fn checked(h1: A, h2: A, hysteresis_counts: u32) -> Result<Self, RelayError> {
        if hysteresis_counts > MAX_HYSTERESIS {
            return Err(RelayError::Hysteresis);
        }
        Ok(Self { h1, h2, hysteresis: hysteresis_counts as i32 })
    }

    /// One tick on the error `r − x` in counts: returns the signs of FR1 and FR2.
    ///
    /// FR1 switches when the error leaves the hysteresis on the other side. FR2 does the same on Σe. The sum crosses
    /// zero where |e| is at its peak, so one tick's error carries it across the band. At rest, noise within the
    /// hysteresis cannot toggle it every tick.
    pub fn signs(&self, state: &mut DualRelayState, error_counts: i32) -> (i8, i8) {
        state.positive1 = switch(state.positive1, error_counts, self.hysteresis);
        state.integral = state.integral.saturating_add(i64::from(error_counts));
        state.positive2 = switch(state.positive2, state.integral, i64::from(self.hysteresis));
        state.signs()
    }
}

impl<A: Copy + Add<Output = A> + Neg<Output = A>> DualRelay<A> {
    /// One tick on the error `r − x` in counts: returns the drive, to be applied at once and held until the next tick.
    ///
    /// A drive that reaches the axis one tick later adds `ω·Ts` of lag, which feeds the cycle like `h1·ω·Ts` more of
    /// `h2`. The estimators then need the drive as it was applied.
    pub fn tick(&self, state: &mut DualRelayState, error_counts: i32) -> A {
        self.signs(state, error_counts);
        let first = if state.positive1 { self.h1 } else { -self.h1 };
        let second = if state.positive2 { self.h2 } else { -self.h2 };
        first + second
    }

    /// Amplitude of the relay on the error, in drive codes or units.
    pub const fn h1(&self) -> A {
        self.h1
    }

    /// Amplitude of the relay on the error's integral, in drive codes or units.
    pub const fn h2(&self) -> A {
        self.h2
    }

    /// Half-width of the hysteresis, in counts.
    pub const fn hysteresis_counts(&self) -> u32 {
        self.hysteresis as u32
    }
}

#[inline]
fn switch<T: Copy + PartialOrd + Neg<Output = T>>(positive: bool, value: T, hysteresis: T) -> bool {
    if positive { value >= -hysteresis } else { value > hysteresis }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn configuration_errors_name_the_parameter() {
        assert_eq!(DualRelay::new(0, 1, 0), Err(RelayError::H1));
        assert_eq!(DualRelay::new(1, -1, 0), Err(RelayError::H2));
        assert_eq!(DualRelay::new(i32::MAX, 1, 0), Err(RelayError::Sum));
        assert_eq!(DualRelay::new(1, 1, u32::MAX), Err(RelayError::Hysteresis));
        assert_eq!(DualRelay::with_real_drive(f32::NAN, 1.0, 0), Err(RelayError::H1));
        assert_eq!(DualRelay::with_real_drive(1.0, f64::INFINITY, 0), Err(RelayError::H2));
        assert_eq!(DualRelay::with_real_drive(f32::MAX, f32::MAX, 0), Err(RelayError::Sum));
        assert_eq!(default_hysteresis(-1.0), Err(RelayError::Hysteresis));
        assert_eq!(default_hysteresis(1.5), Ok(6));
        assert_eq!(default_hysteresis(0.0_f32), Ok(1));
    }

    #[test]
    fn zero_error_keeps_the_state_and_the_start_is_not_zero() {
        let relay = DualRelay::new(200, 150, 0).unwrap();
        let mut state = DualRelayState::new();
        assert_eq!(relay.tick(&mut state, 0), 350);
        assert_eq!(relay.tick(&mut state, -1), -350);
        assert_eq!(relay.tick(&mut state, 0), -350);
        // e = +1 brings Σe back to 0: FR1 switches, FR2 keeps its sign.
        assert_eq!(relay.tick(&mut state, 1), 50);
    }

    #[test]
    fn noise_within_the_hysteresis_toggles_neither_relay() {
        let relay = DualRelay::new(2, 1, 4).unwrap();
        let mut state = DualRelayState::new();
        for k in 0..1000 {
            assert_eq!(relay.tick(&mut state, if k % 2 == 0 { -4 } else { 4 }), 3);
        }
    }

    #[test]
    fn extreme_errors_saturate_and_do_not_wrap() {
        let relay = DualRelay::with_real_drive(1.0_f32, 0.5, 1 << 30).unwrap();
        let mut state = DualRelayState { integral: i64::MAX - 1, ..DualRelayState::new() };
        assert_eq!(relay.tick(&mut state, i32::MAX), 1.5);
        assert_eq!(state.integral(), i64::MAX);
        assert_eq!(relay.tick(&mut state, i32::MIN), -0.5);
    }
}
