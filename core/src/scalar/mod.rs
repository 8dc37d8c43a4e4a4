//! The number trait [`Real`], over which everything in the core but integer arithmetic is generic. Also the integer
//! sine and cosine of the tick ([`nco`]).

#[cfg(feature = "micromath")]
pub mod approximate;
mod fixed_point;
mod float;
pub mod nco;
#[cfg(any(test, target_os = "none"))]
mod root;
mod solver;

pub use fixed_point::Q32;
pub use solver::{DoubleWord, ExactSum, SolverReal};

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number as the core needs it: f32, f64, or a fixed-point type.
///
/// Operations on fixed-point types saturate; none panics.
pub trait Real:
    Copy
    + Default
    + PartialOrd
    + Debug
    + Send
    + Sync
    + 'static
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// Additive identity.
    const ZERO: Self;
    /// Multiplicative identity.
    const ONE: Self;

    /// Nearest representable value; saturates.
    #[must_use]
    fn from_f64(value: f64) -> Self;
    /// The value as f64 (exact for f32 and f64).
    fn to_f64(self) -> f64;
    /// Nearest representable value of an integer; saturates.
    #[must_use]
    fn from_u32(value: u32) -> Self {
        Self::from_f64(f64::from(value))
    }
    /// Rounded down to an integer; 0 below 0 and for NaN, saturates.
    fn to_u32(self) -> u32 {
        self.to_f64() as u32
    }
    /// False for NaN and infinities; always true in fixed point.
    fn is_finite(self) -> bool;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// Square root; 0 for negative input.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine of an angle in radians.
    #[must_use]
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    #[must_use]
    fn cos(self) -> Self;
    /// e to the power of self.
    #[must_use]
    fn exp(self) -> Self;
    /// e^self for self ≤ 0; 0 below −80. In f32 without libm: 2e-7 relative (tested in control/fast.rs).
    #[must_use]
    fn exp_negative(self) -> Self {
        if self > Self::from_f64(-80.0) { self.exp() } else { Self::ZERO }
    }
    /// Natural logarithm; the most negative value for input ≤ 0.
    #[must_use]
    fn ln(self) -> Self;
    /// The angle of the point (`x`, `self`), in −π..π.
    #[must_use]
    fn atan2(self, x: Self) -> Self;

    /// Multiplied by a plain constant.
    #[must_use]
    fn scale(self, factor: f64) -> Self {
        self * Self::from_f64(factor)
    }
    /// −1, 0 or 1; `sgn(0) = 0`, as friction at rest needs it.
    #[must_use]
    fn sgn(self) -> Self {
        if self > Self::ZERO {
            Self::ONE
        } else if self < Self::ZERO {
            -Self::ONE
        } else {
            Self::ZERO
        }
    }
    /// The smaller of two.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}
