//! Forward-mode derivatives: a number that carries its derivatives with respect to N parameters.
//!
//! The plant in the core is generic over [`Real`]. On [`Dual`] one simulation gives the trajectory and its exact
//! sensitivities. They hold through reversals and stick phases: the instants of events are differentiated too.

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use breakaway_core::scalar::Real;

/// A value and its gradient. Comparisons use the value only.
///
/// The gradient is in single precision, which takes half the time. It gives the direction of a step and standard
/// errors, and no values.
#[derive(Clone, Copy, Debug)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// Derivatives with respect to the N parameters.
    pub gradient: [f32; N],
}

impl<const N: usize> Dual<N> {
    /// A constant.
    pub const fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }
    /// Parameter number `index`; a constant if `index ≥ N`.
    pub fn parameter(value: f64, index: usize) -> Self {
        let mut gradient = [0.0; N];
        if let Some(slot) = gradient.get_mut(index) {
            *slot = 1.0;
        }
        Self { value, gradient }
    }
    #[inline]
    fn chain(mut self, value: f64, slope: f64) -> Self {
        let slope = slope as f32;
        for lane in &mut self.gradient {
            *lane *= slope;
        }
        Self { value, ..self }
    }
    /// The value, with each lane combined from those of both. The loop is in place, because the compiler puts it into
    /// vector instructions. It would call `array::from_fn` lane by lane.
    #[inline]
    fn lanes(mut self, o: &Self, value: f64, combine: impl Fn(f32, f32) -> f32) -> Self {
        for (lane, other) in self.gradient.iter_mut().zip(&o.gradient) {
            *lane = combine(*lane, *other);
        }
        Self { value, ..self }
    }
}

impl<const N: usize> Default for Dual<N> {
    fn default() -> Self {
        Self::constant(0.0)
    }
}
impl<const N: usize> PartialEq for Dual<N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}
impl<const N: usize> PartialOrd for Dual<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}
impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        self.lanes(&o, self.value + o.value, |a, b| a + b)
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self.lanes(&o, self.value - o.value, |a, b| a - b)
    }
}
#[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule is a sum")]
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        let (own, other) = (self.value as f32, o.value as f32);
        self.lanes(&o, self.value * o.value, |a, b| a * other + b * own)
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let inverse = 1.0 / o.value;
        let value = self.value * inverse;
        let (slope, over) = (value as f32, inverse as f32);
        self.lanes(&o, value, |a, b| (a - slope * b) * over)
    }
}
impl<const N: usize> AddAssign for Dual<N> {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<const N: usize> SubAssign for Dual<N> {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
impl<const N: usize> MulAssign for Dual<N> {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl<const N: usize> Real for Dual<N> {
    const ZERO: Self = Self::constant(0.0);
    const ONE: Self = Self::constant(1.0);

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::constant(value)
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.value
    }
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
    fn is_finite(self) -> bool {
        self.value.is_finite()
    }
    #[inline]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    fn sqrt(self) -> Self {
        let root = self.value.max(0.0).sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    #[inline]
    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos)
    }
    #[inline]
    fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(cos, -sin)
    }
    #[inline]
    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }
    fn ln(self) -> Self {
        if self.value > 0.0 { self.chain(self.value.ln(), 1.0 / self.value) } else { Self::constant(f64::MIN) }
    }
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
        let (by_y, by_x) = ((x.value * inverse) as f32, (self.value * inverse) as f32);
        self.lanes(&x, self.value.atan2(x.value), |y, x| by_y * y - by_x * x)
    }
}

#[cfg(test)]
mod tests;
