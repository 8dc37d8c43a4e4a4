//! Fixed point: [`Q32`], 31 integer and 32 fractional bits, for cores without an FPU.
//!
//! The operators of `fixed::types::I32F32` panic on overflow in debug builds and wrap in release ones. A control law
//! must do neither, so `Q32` wraps the type and saturates. Products and quotients round to nearest. All arithmetic is
//! in integers. Range ±2³¹, step 2.3e-10. Worst errors measured by the tests below: sin and cos 4e-9, atan2 2 steps
//! (5e-10), ln 2 steps, exp 2 steps + 2e-10 relative, sqrt 1 step.

use super::Real;
use crate::scalar::nco;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};
use fixed::types::I32F32;

/// A saturating fixed-point number in −2³¹..2³¹ with steps of 2⁻³².
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Q32(pub I32F32);

/// Fractional bits of [`Q32`].
const BITS: u32 = 32;
/// Fractional bits of the elementary functions' inner arithmetic.
const INNER: u32 = 60;
/// ln 2, Q60.
const LN_2_Q60: i64 = 799_144_290_325_165_979;
/// log₂ e, Q30.
const LOG2_E_Q30: i128 = 1_549_082_005;
/// π, Q60.
const PI_Q60: i64 = 3_622_009_729_038_561_421;
/// 1/(2π), Q64.
const TURNS_PER_RADIAN_Q64: i128 = 2_935_890_503_282_001_226;
/// √2, Q60, rounded up.
const SQRT_2_Q60: i64 = 1_630_477_228_166_597_777;

/// `value / 2^bits`, rounded to nearest; `bits` ≥ 1.
const fn round_shift(value: i128, bits: u32) -> i128 {
    (value + (1 << (bits - 1))) >> bits
}

fn mul_q60(a: i64, b: i64) -> i64 {
    round_shift(i128::from(a) * i128::from(b), INNER) as i64
}

/// `numerator/denominator` in Q60, for |numerator| ≤ denominator.
fn ratio_q60(numerator: i128, denominator: i128) -> i64 {
    ((numerator << INNER) / denominator) as i64
}

impl Q32 {
    fn saturated(bits: i128) -> Self {
        let bits = bits.clamp(i128::from(i64::MIN), i128::from(i64::MAX));
        Self(I32F32::from_bits(bits as i64))
    }
    const fn bits(self) -> i64 {
        self.0.to_bits()
    }
    /// The phase of an angle in units of 2⁻³² turn, for [`nco::sin_cos`].
    fn phase(self) -> u32 {
        round_shift(i128::from(self.bits()) * TURNS_PER_RADIAN_Q64, 64) as u32
    }
}

impl Neg for Q32 {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}
impl Add for Q32 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}
impl Sub for Q32 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}
impl Mul for Q32 {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::saturated(round_shift(i128::from(self.bits()) * i128::from(other.bits()), BITS))
    }
}
impl Div for Q32 {
    type Output = Self;
    /// A division by zero saturates to the sign of the dividend; 0/0 is 0.
    fn div(self, other: Self) -> Self {
        let numerator = i128::from(self.bits()) << BITS;
        let denominator = i128::from(other.bits());
        if denominator == 0 {
            return Self::saturated(numerator.signum() << 64);
        }
        // Half the divisor, with the quotient's sign, turns truncation into rounding.
        let half = denominator.abs() / 2;
        let half = if numerator < 0 { -half } else { half };
        Self::saturated((numerator + half) / denominator)
    }
}
impl AddAssign for Q32 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
impl SubAssign for Q32 {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl MulAssign for Q32 {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Real for Q32 {
    const ZERO: Self = Self(I32F32::ZERO);
    const ONE: Self = Self(I32F32::ONE);

    /// Nearest representable value; saturates; NaN becomes 0.
    fn from_f64(value: f64) -> Self {
        // A cast to an integer saturates and takes NaN to 0; the product by 2³² is exact.
        Self(I32F32::from_bits(libm::round(value * 4_294_967_296.0) as i64))
    }
    fn to_f64(self) -> f64 {
        self.bits() as f64 / 4_294_967_296.0
    }
    fn from_u32(value: u32) -> Self {
        Self(I32F32::saturating_from_num(value))
    }
    fn to_u32(self) -> u32 {
        (self.0.to_bits().max(0) >> BITS) as u32
    }
    fn is_finite(self) -> bool {
        true
    }
    fn abs(self) -> Self {
        Self(self.0.saturating_abs())
    }
    fn sqrt(self) -> Self {
        if self.bits() <= 0 {
            return Self::ZERO;
        }
        Self::saturated(((self.bits() as u128) << BITS).isqrt() as i128)
    }
    fn sin(self) -> Self {
        let (sin, _) = nco::sin_cos(self.phase());
        Self(I32F32::from_bits(i64::from(sin) << 2))
    }
    fn cos(self) -> Self {
        let (_, cos) = nco::sin_cos(self.phase());
        Self(I32F32::from_bits(i64::from(cos) << 2))
    }
    /// e^x = 2^k·e^r with |r| ≤ ln2/2, and the Taylor series of e^r to r¹³ (next term 4e-18).
    fn exp(self) -> Self {
        let bits = i128::from(self.bits());
        let k = round_shift(bits * LOG2_E_Q30, BITS + 30);
        if k > 31 {
            return Self(I32F32::MAX);
        }
        if k < -33 {
            return Self::ZERO;
        }
        let r = ((bits << (INNER - BITS)) - k * i128::from(LN_2_Q60)) as i64;
        let one = 1_i64 << INNER;
        let mut sum = one;
        for n in (1..=13).rev() {
            sum = one + mul_q60(sum, r) / n;
        }
        // Q60 to Q32 is a shift by 28 right, 2^k one by k left.
        let shift = 28 - k as i32;
        if shift > 0 {
            Self::saturated(round_shift(i128::from(sum), shift as u32))
        } else {
            Self::saturated(i128::from(sum) << shift.unsigned_abs())
        }
    }
    /// ln(m·2^k) = k·ln2 + 2·artanh((m−1)/(m+1)), 1/√2 < m ≤ √2, the series to the 19th power (next term 8e-18).
    fn ln(self) -> Self {
        if self.bits() <= 0 {
            return Self(I32F32::MIN);
        }
        let top = self.bits().ilog2();
        let mut k = top as i128 - i128::from(BITS);
        let mut m = (i128::from(self.bits()) << INNER) >> top;
        if m > i128::from(SQRT_2_Q60) {
            m >>= 1;
            k += 1;
        }
        let one = 1_i128 << INNER;
        let s = ratio_q60(m - one, m + one);
        let square = mul_q60(s, s);
        let mut sum = 0_i64;
        for n in (0..10).rev() {
            sum = (one as i64) / (2 * n + 1) + mul_q60(sum, square);
        }
        let mantissa = 2 * i128::from(mul_q60(sum, s));
        Self::saturated(round_shift(mantissa + k * i128::from(LN_2_Q60), INNER - BITS))
    }
    /// The series of atan to the 41st power (next term 1e-18) for |t| ≤ tan(π/8), after folding octants.
    fn atan2(self, x: Self) -> Self {
        let (y, x) = (i128::from(self.bits()), i128::from(x.bits()));
        if y == 0 && x == 0 {
            return Self::ZERO;
        }
        let (small, large) = (y.abs().min(x.abs()), y.abs().max(x.abs()));
        // tan(π/8) ≈ 0.4142: beyond it, atan t = π/4 + atan((t−1)/(t+1)).
        let fold = small * 10_000 > large * 4_142;
        let t = if fold { ratio_q60(small - large, small + large) } else { ratio_q60(small, large) };
        let square = mul_q60(t, t);
        let one = 1_i64 << INNER;
        let mut sum = 0_i64;
        for n in (0..21).rev() {
            sum = one / (2 * n + 1) - mul_q60(sum, square);
        }
        let mut angle = mul_q60(sum, t) + if fold { PI_Q60 / 4 } else { 0 };
        if y.abs() > x.abs() {
            angle = PI_Q60 / 2 - angle;
        }
        if x < 0 {
            angle = PI_Q60 - angle;
        }
        if y < 0 {
            angle = -angle;
        }
        Self::saturated(round_shift(i128::from(angle), INNER - BITS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const STEP: f64 = 1.0 / 4_294_967_296.0;

    fn q(value: f64) -> Q32 {
        Q32::from_f64(value)
    }
    fn any_q() -> impl Strategy<Value = Q32> {
        prop_oneof![any::<i64>(), -(1_i64 << 40)..(1 << 40), Just(i64::MIN), Just(i64::MAX), Just(0)]
            .prop_map(|bits| Q32(I32F32::from_bits(bits)))
    }

    #[test]
    fn operators_saturate() {
        let (max, min) = (Q32(I32F32::MAX), Q32(I32F32::MIN));
        assert_eq!(max + Q32::ONE, max);
        assert_eq!(min - Q32::ONE, min);
        assert_eq!(max * max, max);
        assert_eq!(max * min, min);
        assert_eq!(-min, max);
        assert_eq!(min.abs(), max);
        assert_eq!(Q32::ONE / Q32::ZERO, max);
        assert_eq!(-Q32::ONE / Q32::ZERO, min);
        assert_eq!(Q32::ZERO / Q32::ZERO, Q32::ZERO);
        assert_eq!(q(f64::NAN), Q32::ZERO);
        assert_eq!(q(1e300), max);
        assert_eq!(q(-2.0).sqrt(), Q32::ZERO);
        assert_eq!(Q32::ZERO.ln(), min);
        assert_eq!(q(40.0).exp(), max);
        assert_eq!(q(-40.0).exp(), Q32::ZERO);
    }

    proptest! {
        #[test]
        fn nothing_panics(a in any_q(), b in any_q()) {
            let _ = (a + b, a - b, a * b, a / b, -a);
            let _ = (a.sqrt(), a.sin(), a.cos(), a.exp(), a.ln(), a.atan2(b), a.abs(), a.sgn());
        }

        /// A sum or product that is in range is f64's to within the rounding of one step.
        #[test]
        fn arithmetic_is_that_of_f64(a in -3e4..3e4_f64, b in -3e4..3e4_f64) {
            let (x, y) = (q(a), q(b));
            prop_assert!(((x + y).to_f64() - (x.to_f64() + y.to_f64())).abs() <= STEP);
            // Both sides are rounded to the 53 bits of an f64.
            let exact = x.to_f64() * y.to_f64();
            prop_assert!(((x * y).to_f64() - exact).abs() <= STEP + exact.abs() * 4e-16);
            if b.abs() > 1e-3 {
                let exact = x.to_f64() / y.to_f64();
                prop_assert!(((x / y).to_f64() - exact).abs() <= STEP + exact.abs() * 4e-16);
            }
        }

        /// The phase has steps of 1.5e-9 rad and the oscillator errs by 2.6e-9: under 4e-9 together.
        #[test]
        fn sine_and_cosine(a in -1e3..1e3_f64) {
            let x = q(a);
            prop_assert!((x.sin().to_f64() - libm::sin(x.to_f64())).abs() < 4e-9);
            prop_assert!((x.cos().to_f64() - libm::cos(x.to_f64())).abs() < 4e-9);
        }

        #[test]
        fn root_exponential_logarithm(a in 1e-6..2e9_f64, e in -22.0..21.4_f64) {
            let x = q(a);
            prop_assert!((x.sqrt().to_f64() - libm::sqrt(x.to_f64())).abs() <= STEP);
            prop_assert!((x.ln().to_f64() - libm::log(x.to_f64())).abs() <= 2.0 * STEP);
            let exact = libm::exp(q(e).to_f64());
            prop_assert!((q(e).exp().to_f64() - exact).abs() <= 2.0 * STEP + 2e-10 * exact);
        }

        #[test]
        fn arctangent(y in -2e9..2e9_f64, x in -2e9..2e9_f64, small in -1.0..1.0_f64) {
            for (y, x) in [(y, x), (small, x), (y, small)] {
                let (y, x) = (q(y), q(x));
                let exact = libm::atan2(y.to_f64(), x.to_f64());
                prop_assert!((y.atan2(x).to_f64() - exact).abs() <= 2.0 * STEP);
            }
        }
    }
}
