//! A piece of a reference between two set-points: the cubic that has position and velocity of both.

use super::Setpoint;
use crate::control::fast::Fast;
use crate::scalar::Real;

/// `x(s) = x0 + s·(a1 + s·(a2 + s·a3))` with s from 0 to 1 over the piece's duration T. This is cubic Hermite
/// interpolation: `a1 = v0·T`, `a2 = 3Δ − (2·v0 + v1)·T`, `a3 = (v0 + v1)·T − 2Δ`, `Δ = x1 − x0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic<R> {
    x0: R,
    a: [R; 3],
    per_s: R,
}

/// The largest and smallest position and the largest speed that a piece can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicRange<F> {
    /// Smallest position, X.
    pub low: F,
    /// Largest position, X.
    pub high: F,
    /// Largest speed either way, X/s.
    pub speed: F,
}

impl<R: Fast> Cubic<R> {
    /// From (`x0`, `v0`) to (`x1`, `v1`) in `duration_s`; `per_s` is 1/`duration_s`.
    pub fn new([x0, v0]: [R; 2], [x1, v1]: [R; 2], duration_s: R, per_s: R) -> Self {
        let way = x1 - x0;
        let (before, after) = (v0 * duration_s, v1 * duration_s);
        Self { x0, a: [before, way + way + way - before - before - after, before + after - way - way], per_s }
    }

    /// The reference at `s`, 0 ..= 1 of the duration.
    #[inline]
    pub fn at(&self, s: R) -> Setpoint<R> {
        let [a1, a2, a3] = self.a;
        let third = a3 * s;
        let x = self.x0 + s * (a1 + s * (a2 + third));
        let v = (a1 + s * (a2 + a2 + third + third + third)) * self.per_s;
        let a = (a2 + a2 + R::from_i32(6) * third) * (self.per_s * self.per_s);
        Setpoint { x, v, a }
    }
}

impl<F: Real> CubicRange<F> {
    /// Bounds of the piece from (`x0`, `v0`) to (`x1`, `v1`) in `duration_s` > 0. A polynomial lies within the hull of its
    /// Bézier points, and so does its derivative within that of its own. The bounds are therefore safe, and exact where
    /// the extremes are at the ends.
    #[must_use]
    pub fn new([x0, v0]: [F; 2], [x1, v1]: [F; 2], duration_s: F) -> Self {
        let third = duration_s / F::from_f64(3.0);
        let (after, before) = (x0 + v0 * third, x1 - v1 * third);
        let middle = (before - after) / third;
        Self {
            low: x0.min(x1).min(after).min(before),
            high: x0.max(x1).max(after).max(before),
            speed: v0.abs().max(v1.abs()).max(middle.abs()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Q32;
    use proptest::prelude::*;

    /// Position and velocity at both ends are those of the set-points, in every number type; a parabola is itself.
    #[test]
    fn the_ends_are_the_set_points() {
        fn check<R: Fast>(tolerance: f64) {
            let real = R::from_f64;
            let cubic = Cubic::new([real(0.5), real(1.0)], [real(0.9), real(3.0)], real(0.2), real(5.0));
            for (s, x, v) in [(0.0, 0.5, 1.0), (0.5, 0.65, 2.0), (1.0, 0.9, 3.0)] {
                let at = cubic.at(real(s));
                // x = 0.5 + t + 5·t², so that a = 10 everywhere.
                for (found, wanted) in [(at.x, x), (at.v, v), (at.a, 10.0)] {
                    assert!((found.to_f64() - wanted).abs() < tolerance, "{s}: {found:?}, not {wanted}");
                }
            }
        }
        // Rounding: 25·2⁻²⁴ of the acceleration in f32; that of Q32 is 2⁻³² of each product.
        check::<f64>(1e-13);
        check::<f32>(1e-5);
        check::<Q32>(1e-6);
    }

    proptest! {
        /// The bounds hold at every point of the piece, and are at most three times too wide in speed.
        #[test]
        fn the_bounds_hold(x0 in -10.0..10.0, x1 in -10.0..10.0, v0 in -9.0..9.0, v1 in -9.0..9.0, t in 0.01..5.0) {
            let range = CubicRange::new([x0, v0], [x1, v1], t);
            let cubic = Cubic::new([x0, v0], [x1, v1], t, 1.0 / t);
            let mut fastest = 0.0_f64;
            for k in 0..=100 {
                let at = cubic.at(f64::from(k) / 100.0);
                let slack = 1e-9 * (1.0 + range.speed);
                prop_assert!(at.x >= range.low - slack && at.x <= range.high + slack);
                prop_assert!(at.v.abs() <= range.speed + slack);
                fastest = fastest.max(at.v.abs());
            }
            prop_assert!(range.speed <= 3.0 * fastest + 1e-9, "{} of {fastest}", range.speed);
        }
    }
}
