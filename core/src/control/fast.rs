//! What a tick needs of a number beyond [`Real`], without libm's cost on a microcontroller.
//!
//! libm's `sinf` computes in f64, which a Cortex-M4F does in software: several hundred instructions. The sine here
//! takes turns instead of radians, so that the reduction of the angle is the fractional part.

use crate::scalar::nco;
use crate::scalar::{Q32, Real};
use fixed::types::I32F32;

/// A [`Real`] with cheap elementary functions. The tests of this file measure the worst errors. The f32 sine errs by
/// 3e-7 within a turn, with the rounding of the turns beyond. The f32 exponential errs by 2e-7 relative. f64 and Q32
/// are as their `Real`.
pub trait Fast: Real {
    /// An integer; exact below 2²⁴ in f32.
    #[must_use]
    fn from_i32(value: i32) -> Self;
    /// The nearest integer; saturates.
    #[must_use]
    fn to_i32(self) -> i32;
    /// A phase in units of 2⁻³² turn, as turns in −½..½.
    #[must_use]
    fn from_phase(phase: u32) -> Self;
    /// sin(2π·self): the sine of an angle in turns. For |self| < 2³¹.
    #[must_use]
    fn sin_turns(self) -> Self;
    /// sin(2π·self) and cos(2π·self).
    #[must_use]
    #[inline]
    fn sin_cos_turns(self) -> (Self, Self) {
        (self.sin_turns(), (self + Self::ONE.scale(0.25)).sin_turns())
    }
}

/// −½..½ of a turn: what is beyond the nearest whole one.
#[inline]
fn fraction(turns: f32) -> f32 {
    // The cast truncates and saturates, and never panics.
    let whole = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
    turns - whole as f32
}

/// sin(π − x) = sin x folds ±½ turn to ±¼.
#[inline]
fn folded(r: f32) -> f32 {
    if r > 0.25 {
        0.5 - r
    } else if r < -0.25 {
        -0.5 - r
    } else {
        r
    }
}

/// The Taylor series in turns, |r| ≤ ¼, to the 11th power: the next term is 6e-8 at ¼ turn.
#[inline]
fn sine_of_quarter(r: f32) -> f32 {
    let q = r * r;
    r * (6.283_185_5 + q * (-41.341_7 + q * (81.605_25 + q * (-76.705_86 + q * (42.058_693 + q * -15.094_643)))))
}

impl Fast for f32 {
    fn from_i32(value: i32) -> Self {
        value as Self
    }
    #[inline]
    fn to_i32(self) -> i32 {
        // The cast truncates and saturates.
        (self + if self < 0.0 { -0.5 } else { 0.5 }) as i32
    }
    fn from_phase(phase: u32) -> Self {
        phase as i32 as Self * (1.0 / 4_294_967_296.0)
    }

    fn sin_turns(self) -> Self {
        sine_of_quarter(folded(fraction(self)))
    }

    #[inline]
    fn sin_cos_turns(self) -> (Self, Self) {
        let r = fraction(self);
        // cos x = sin(π/2 − |x|) is within the quarter already.
        (sine_of_quarter(folded(r)), sine_of_quarter(0.25 - r.abs()))
    }
}

impl Fast for f64 {
    fn from_i32(value: i32) -> Self {
        Self::from(value)
    }
    fn to_i32(self) -> i32 {
        libm::round(self) as i32
    }
    fn from_phase(phase: u32) -> Self {
        Self::from(phase as i32) * (1.0 / 4_294_967_296.0)
    }
    fn sin_turns(self) -> Self {
        (core::f64::consts::TAU * (self - libm::round(self))).sin()
    }
}

impl Fast for Q32 {
    fn from_i32(value: i32) -> Self {
        Self(I32F32::from_bits(i64::from(value) << 32))
    }
    fn to_i32(self) -> i32 {
        // Half a unit more, cut off: the integer bits.
        (self.0.to_bits().saturating_add(1 << 31) >> 32) as i32
    }
    fn from_phase(phase: u32) -> Self {
        Self(I32F32::from_bits(i64::from(phase as i32)))
    }
    fn sin_turns(self) -> Self {
        // The fractional bits are the phase.
        let (sin, _) = nco::sin_cos(self.0.to_bits() as u32);
        Self(I32F32::from_bits(i64::from(sin) << 2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn errors_are_the_documented_ones() {
        let (mut sine, mut exponential) = (0.0_f64, 0.0_f64);
        for i in -200_000..=200_000 {
            let turns = i as f32 / 200_000.0;
            let exact = libm::sin(core::f64::consts::TAU * f64::from(turns));
            sine = sine.max((f64::from(turns.sin_turns()) - exact).abs());
            let (sin, cos) = turns.sin_cos_turns();
            assert_eq!(sin, turns.sin_turns());
            let exact = libm::cos(core::f64::consts::TAU * f64::from(turns));
            sine = sine.max((f64::from(cos) - exact).abs());
            if turns <= 0.0 {
                let x = 79.0 * turns;
                let exact = libm::exp(f64::from(x));
                exponential = exponential.max((f64::from(x.exp_negative()) / exact - 1.0).abs());
            }
        }
        assert!(sine < 3e-7, "sine {sine:e}");
        // The argument's own rounding at −79 is 4e-6.
        assert!(exponential < 8e-6, "exponential {exponential:e}");
    }

    #[test]
    fn integers_are_the_nearest() {
        for (value, nearest) in [(0.0, 0), (0.75, 1), (-0.75, -1), (2.25, 2), (-2.25, -2), (1e5, 100_000)] {
            assert_eq!([value.to_i32(), (value as f32).to_i32(), Q32::from_f64(value).to_i32()], [nearest; 3]);
        }
        for (value, end) in [(1e12, i32::MAX), (-1e12, i32::MIN)] {
            assert_eq!([value.to_i32(), (value as f32).to_i32(), Q32::from_f64(value).to_i32()], [end; 3]);
        }
    }

    proptest! {
        /// Q32 against f64, to the oscillator's 2.6e-9 and the step of its phase.
        #[test]
        fn fixed_point_agrees(turns in -1e3..1e3_f64) {
            let q = Q32::from_f64(turns);
            prop_assert!((q.sin_turns().to_f64() - q.to_f64().sin_turns()).abs() < 4e-9);
        }

        #[test]
        fn nothing_panics(x in any::<f32>(), y in any::<f64>(), bits in any::<i64>()) {
            let _ = (x.sin_turns(), x.exp_negative(), y.sin_turns(), y.exp_negative());
            let q = Q32(I32F32::from_bits(bits));
            let _ = (q.sin_turns(), q.exp_negative(), q.to_i32(), x.to_i32(), y.to_i32());
        }
    }
}
