//! Sine, cosine and arctangent in f64 for the solvers.
//!
//! libm's cost 6 KB on a microcontroller, most of it for the reduction of angles beyond 2²⁰ turns and for the last half
//! unit in the last place. The solvers' angles are products that are already rounded: here the reduction is by the
//! rounded quarter turn, whose error is no more than twice the angle's own rounding, and the series is a loop.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// 1/n! with alternating signs, from n = 17 down to 2: the next terms of sine and cosine are 8e-20 and 2e-18 at π/4.
const SERIES: [f64; 16] = series();

const fn series() -> [f64; 16] {
    let mut series = [0.0; 16];
    let (mut n, mut factorial) = (2, 1.0);
    while n < 18 {
        factorial *= n as f64;
        let sign = if n % 4 < 2 { 1.0 } else { -1.0 };
        series[17 - n] = sign / factorial;
        n += 1;
    }
    series
}

/// Adding it leaves the nearest integer in the low bits, for |x| < 2⁵¹.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// (sin, cos) of an angle in radians, |angle| < 2⁵⁰; worst error 2.3e-16·(1 + |angle|) (tested against libm). What is
/// not finite gives NaN.
pub(super) fn sin_cos(angle: f64) -> (f64, f64) {
    let quarters = angle * FRAC_2_PI;
    let shifted = quarters + ROUND;
    let y = (quarters - (shifted - ROUND)) * FRAC_PI_2;
    let square = y * y;
    let (mut sin, mut cos) = (0.0, 0.0);
    for pair in SERIES.chunks_exact(2) {
        sin = sin * square + pair[0];
        cos = cos * square + pair[1];
    }
    let (sin, cos) = (y + y * square * sin, 1.0 + square * cos);
    match shifted.to_bits() & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The angle of the point (x, y), −π..π, to 4e-16; 0 for the origin. `size` is its distance from the origin.
pub(super) fn angle_of(x: f64, y: f64, size: f64) -> f64 {
    // Within 0.07 rad; each step leaves the cube of the error before, over 6.
    let near = (y.abs() - x.abs()) / (y.abs() + x.abs());
    let near = core::f64::consts::FRAC_PI_4 * (1.0 + near);
    let near = if x < 0.0 { core::f64::consts::PI - near } else { near };
    let mut angle = if y < 0.0 { -near } else { near };
    if angle.is_nan() {
        return 0.0;
    }
    for _ in 0..3 {
        let (sin, cos) = sin_cos(angle);
        angle += (y * cos - x * sin) / size;
    }
    angle
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Over the angles of a record: up to 10⁵ periods.
        #[test]
        fn sine_and_cosine_are_those_of_libm(angle in prop_oneof![-7.0..7.0_f64, -7e5..7e5_f64, -1e-3..1e-3_f64]) {
            let (sin, cos) = sin_cos(angle);
            let bound = 2.3e-16 * (1.0 + angle.abs());
            prop_assert!((sin - libm::sin(angle)).abs() <= bound, "{} {}", sin, libm::sin(angle));
            prop_assert!((cos - libm::cos(angle)).abs() <= bound, "{} {}", cos, libm::cos(angle));
            // Near 0 the sine keeps its relative precision: the Dirichlet sums divide by it.
            if angle.abs() < 0.5 {
                prop_assert!((sin - libm::sin(angle)).abs() <= 5e-16 * angle.abs());
            }
        }

        #[test]
        fn the_angle_is_that_of_libm(x in -2.0..2.0_f64, y in prop_oneof![-2.0..2.0_f64, -1e-9..1e-9_f64, Just(0.0)]) {
            let difference = angle_of(x, y, libm::hypot(x, y)) - libm::atan2(y, x);
            prop_assert!(difference.abs() <= 5e-16, "{}", difference);
        }
    }

    #[test]
    fn what_has_no_angle() {
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
        assert_eq!(angle_of(0.0, 0.0, 0.0), 0.0);
        // On the cut both signs are right.
        assert!((angle_of(-1.0, 0.0, 1.0).abs() - core::f64::consts::PI).abs() < 5e-16);
    }
}
