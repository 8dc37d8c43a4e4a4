//! What the estimators' solvers need of a number beyond [`Real`]: constants of its precision, integers, exact sums.
//!
//! On a microcontroller with single precision in hardware an operation in f64 is a call of a routine: the solvers in f64
//! are 17 KiB of code there. In f32 they are a quarter of it, if the sums whose differences matter keep more digits: those
//! are [`DoubleWord`]s.

use super::Real;
use core::f64::consts::TAU;
use core::fmt::Debug;

/// Units of 2⁻⁶⁴ turn per radian.
const TURN: f64 = 18_446_744_073_709_551_616.0 / TAU;

/// f32 or f64, as a solver takes it.
pub trait SolverReal: Real {
    /// A sum of products whose differences matter: f64 itself, or two f32.
    type Sum: ExactSum<Self>;
    /// Distance from 1 to the next number.
    const EPSILON: Self;
    /// The smallest positive number of full precision.
    const MIN_POSITIVE: Self;
    /// Rows of least squares are refused from this size on: sums of their squares stay finite.
    const LARGEST_ROW: Self;
    /// Angles below which a power series of a few terms is nearer than the difference of sine and cosine terms.
    const SMALL_ANGLE: Self;
    /// Terms of the series of sine and cosine up to π/4 that are above the rounding: 1/n! with alternating signs in pairs of
    /// an odd and the even order below, the highest first.
    const SERIES: &'static [[Self; 2]];

    /// The nearest number.
    fn from_i64(value: i64) -> Self;
    /// The nearest integer, to one rounding of the number; saturates at the ends of i32 (f32) or i64 (f64), 0 for NaN.
    fn nearest(self) -> i64;
    /// An angle in radians, −π..π, in units of 2⁻⁶⁴ turn.
    fn turns(self) -> i64;
}

/// A sum that rounds less than its terms.
pub trait ExactSum<R>: Copy + Default + Debug + PartialEq + Send + Sync + 'static {
    /// a·b, exactly where the type allows.
    #[must_use]
    fn product(a: R, b: R) -> Self;
    /// self + other.
    #[must_use]
    fn plus(self, other: Self) -> Self;
    /// self·factor.
    #[must_use]
    fn times(self, factor: R) -> Self;
    /// The nearest number.
    fn rounded(self) -> R;
}

/// 1/n! with alternating signs, from n = 2·`PAIRS` + 1 down to 2, odd before even.
const fn series<const PAIRS: usize>() -> [[f64; 2]; PAIRS] {
    let mut series = [[0.0; 2]; PAIRS];
    let (mut n, mut factorial) = (2, 1.0);
    while n < 2 * PAIRS + 2 {
        factorial *= n as f64;
        let sign = if n % 4 < 2 { 1.0 } else { -1.0 };
        series[PAIRS - n / 2][1 - n % 2] = sign / factorial;
        n += 1;
    }
    series
}

/// Up to n = 17: the next terms of sine and cosine are 8e-20 and 2e-18 at π/4.
static SERIES_F64: [[f64; 2]; 8] = series();
/// Up to n = 9: the next terms are 2e-9 and 2.5e-8.
static SERIES_F32: [[f32; 2]; 4] = {
    let wide = series::<4>();
    let mut narrow = [[0.0; 2]; 4];
    let mut k = 0;
    while k < 4 {
        narrow[k] = [wide[k][0] as f32, wide[k][1] as f32];
        k += 1;
    }
    narrow
};

impl SolverReal for f64 {
    type Sum = Self;
    const EPSILON: Self = Self::EPSILON;
    const MIN_POSITIVE: Self = Self::MIN_POSITIVE;
    const LARGEST_ROW: Self = 1e120;
    const SMALL_ANGLE: Self = 0.03;
    const SERIES: &'static [[Self; 2]] = &SERIES_F64;

    fn from_i64(value: i64) -> Self {
        value as Self
    }
    fn nearest(self) -> i64 {
        (self + Self::copysign(0.5, self)) as i64
    }
    fn turns(self) -> i64 {
        (self * TURN) as i64
    }
}

impl ExactSum<f64> for f64 {
    fn product(a: f64, b: f64) -> Self {
        a * b
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
    fn times(self, factor: f64) -> Self {
        self * factor
    }
    fn rounded(self) -> f64 {
        self
    }
}

impl SolverReal for f32 {
    type Sum = DoubleWord;
    const EPSILON: Self = Self::EPSILON;
    const MIN_POSITIVE: Self = Self::MIN_POSITIVE;
    const LARGEST_ROW: Self = 1e15;
    const SMALL_ANGLE: Self = 0.5;
    const SERIES: &'static [[Self; 2]] = &SERIES_F32;

    fn from_i64(value: i64) -> Self {
        value as Self
    }
    fn nearest(self) -> i64 {
        i64::from((self + Self::copysign(0.5, self)) as i32)
    }
    fn turns(self) -> i64 {
        (self * TURN as Self) as i64
    }
}

/// The unevaluated sum of two f32: 48 bits, in single precision only.
///
/// Algorithms: Joldes, Muller, Popescu, Tight and rigorous error bounds for basic building blocks of double-word
/// arithmetic, ACM TOMS 44 (2017), 5 and 7; Dekker's product. Sums lose no more than 2⁻⁴⁶ of their larger term, products
/// with an f32 no more than 2⁻⁴⁶, for sizes of 1e-22 to 1e34.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleWord {
    high: f32,
    low: f32,
}

impl DoubleWord {
    /// a + b exactly, for |a| ≥ |b| (Dekker).
    #[inline]
    fn normalised(a: f32, b: f32) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// a + b exactly (Knuth).
    #[inline]
    fn sum(a: f32, b: f32) -> Self {
        let high = a + b;
        let back = high - a;
        Self { high, low: (a - (high - back)) + (b - back) }
    }
}

/// The upper 12 bits of the significand and the rest (Veltkamp).
#[inline]
fn split(a: f32) -> (f32, f32) {
    let scaled = 4097.0 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

// One copy of each: in place they are what the code is saved by.
impl ExactSum<f32> for DoubleWord {
    #[cfg_attr(target_os = "none", inline(never))]
    fn product(a: f32, b: f32) -> Self {
        let high = a * b;
        let ((a1, a0), (b1, b0)) = (split(a), split(b));
        Self { high, low: ((a1 * b1 - high) + a1 * b0 + a0 * b1) + a0 * b0 }
    }
    #[cfg_attr(target_os = "none", inline(never))]
    fn plus(self, other: Self) -> Self {
        let sum = Self::sum(self.high, other.high);
        Self::normalised(sum.high, sum.low + (self.low + other.low))
    }
    #[cfg_attr(target_os = "none", inline(never))]
    fn times(self, factor: f32) -> Self {
        let product = Self::product(self.high, factor);
        Self::normalised(product.high, product.low + self.low * factor)
    }
    fn rounded(self) -> f32 {
        self.high
    }
}

impl From<DoubleWord> for f64 {
    fn from(value: DoubleWord) -> Self {
        Self::from(value.high) + Self::from(value.low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Numbers whose products stay inside the range that is promised.
    fn number() -> impl Strategy<Value = f32> {
        (-1.0..1.0_f32, -30..30_i32).prop_map(|(mantissa, exponent)| mantissa * 2.0_f32.powi(exponent))
    }

    proptest! {
        #[test]
        fn products_are_exact(a in number(), b in number()) {
            prop_assert_eq!(f64::from(DoubleWord::product(a, b)), f64::from(a) * f64::from(b));
        }

        /// Against the same sums and products in f64 (53 bits).
        #[test]
        fn forty_six_bits_are_kept(a in number(), b in number(), c in number(), d in number(), factor in number()) {
            let (left, right) = (DoubleWord::product(a, b), DoubleWord::product(c, d));
            let (x, y) = (f64::from(left), f64::from(right));
            let bound = 2.0_f64.powi(-46);
            prop_assert!((f64::from(left.plus(right)) - (x + y)).abs() <= bound * x.abs().max(y.abs()));
            let product = f64::from(left.times(factor));
            prop_assert!((product - x * f64::from(factor)).abs() <= bound * product.abs());
            prop_assert_eq!(left.plus(right).rounded(), (f64::from(left.plus(right))) as f32);
        }

        #[test]
        fn the_nearest_integer(x in -2e9..2e9_f64) {
            let single = x as f32;
            prop_assert!((x.nearest() as f64 - x).abs() <= 0.5 + 1e-6);
            prop_assert!((single.nearest() as f64 - f64::from(single)).abs() <= 0.5 + f64::from(single.abs() * f32::EPSILON));
        }
    }

    #[test]
    fn the_ends_of_the_integers() {
        assert_eq!((f32::NAN.nearest(), f64::NAN.nearest()), (0, 0));
        assert_eq!((1e20_f32.nearest(), (-1e30_f64).nearest()), (i64::from(i32::MAX), i64::MIN));
    }
}
