//! Sine, cosine and arctangent for the solvers, in f32 and f64.
//!
//! libm's functions take 6 KB on a microcontroller. Most of it reduces angles beyond 2²⁰ turns, and computes the last
//! half unit in the last place. The solvers' angles are integers in fractions of a turn, or products that are already
//! rounded. Here the reduction is by integers or by the rounded quarter turn, whose error is at most twice the
//! angle's own rounding. The series is a loop.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

use crate::scalar::SolverReal;

/// Radians per 2⁻⁶⁴ turn.
pub(super) const RADIANS: f64 = TAU / 18_446_744_073_709_551_616.0;

/// (sin, cos) of an angle in radians, |angle| < 2⁵⁰ in f64 and 2²² in f32; worst error (1 + |angle|) roundings (tested
/// against libm). What is not finite gives NaN.
pub(super) fn sin_cos<R: SolverReal>(angle: R) -> (R, R) {
    let quarters = angle.scale(FRAC_2_PI);
    let whole = quarters.nearest();
    within((quarters - R::from_i64(whole)).scale(FRAC_PI_2), whole)
}

/// (sin, cos) of an angle in units of 2⁻⁶⁴ turn, to the precision of the type; near 0 the sine's is relative.
pub(super) fn sin_cos_of_turns<R: SolverReal>(angle: u64) -> (R, R) {
    let quarters = angle.wrapping_add(1 << 61) >> 62;
    let rest = angle.wrapping_sub(quarters << 62) as i64;
    within(R::from_i64(rest).scale(RADIANS), quarters as i64)
}

/// (sin, cos) of a number of quarter turns and `y` in −π/4..π/4.
fn within<R: SolverReal>(y: R, quarters: i64) -> (R, R) {
    let square = y * y;
    let (mut sin, mut cos) = (R::ZERO, R::ZERO);
    for pair in R::SERIES {
        sin = sin * square + pair[0];
        cos = cos * square + pair[1];
    }
    let (sin, cos) = (y + y * square * sin, R::ONE + square * cos);
    match quarters & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The angle of the point (x, y), −π..π; 0 for the origin. `size` is its distance from the origin. The worst error is
/// √2 (1 + |angle|) roundings (tested against libm).
pub(super) fn angle_of<R: SolverReal>(x: R, y: R, size: R) -> R {
    // Within 0.07 rad; each step leaves the cube of the error before, over 6.
    let near = (y.abs() - x.abs()) / (y.abs() + x.abs());
    let near = (R::ONE + near).scale(FRAC_PI_4);
    let near = if x < R::ZERO { R::from_f64(PI) - near } else { near };
    let mut angle = if y < R::ZERO { -near } else { near };
    if !angle.is_finite() {
        return R::ZERO;
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
            let (sin, cos): (f64, f64) = sin_cos(angle);
            let bound = 2.3e-16 * (1.0 + angle.abs());
            prop_assert!((sin - libm::sin(angle)).abs() <= bound, "{} {}", sin, libm::sin(angle));
            prop_assert!((cos - libm::cos(angle)).abs() <= bound, "{} {}", cos, libm::cos(angle));
            // Near 0 the sine keeps its relative precision: the Dirichlet sums divide by it.
            if angle.abs() < 0.5 {
                prop_assert!((sin - libm::sin(angle)).abs() <= 5e-16 * angle.abs());
            }
        }

        /// In fractions of a turn nothing is lost, in f64 and in f32, wherever the angle is.
        #[test]
        fn turns_are_those_of_libm(angle in any::<u64>()) {
            let radians = angle as i64 as f64 * RADIANS;
            let (sin, cos): (f64, f64) = sin_cos_of_turns(angle);
            prop_assert!((sin - libm::sin(radians)).abs() <= 6e-16 && (cos - libm::cos(radians)).abs() <= 6e-16);
            let (sin, cos): (f32, f32) = sin_cos_of_turns(angle);
            for (got, truth) in [(sin, libm::sin(radians)), (cos, libm::cos(radians))] {
                prop_assert!((f64::from(got) - truth).abs() <= 1.2e-7, "{} {}", got, truth);
            }
        }

        #[test]
        fn single_precision_is_that_of_libm(angle in -7.0..7.0_f32, x in -2.0..2.0_f32, y in -2.0..2.0_f32) {
            let (sin, cos) = sin_cos(angle);
            prop_assert!((f64::from(sin) - libm::sin(angle.into())).abs() <= 1.2e-7 * f64::from(1.0 + angle.abs()));
            prop_assert!((f64::from(cos) - libm::cos(angle.into())).abs() <= 1.2e-7 * f64::from(1.0 + angle.abs()));
            let difference = f64::from(angle_of(x, y, libm::hypotf(x, y))) - libm::atan2(y.into(), x.into());
            prop_assert!(difference.abs() <= 5e-7, "{}", difference);
        }

        #[test]
        fn the_angle_is_that_of_libm(x in -2.0..2.0_f64, y in prop_oneof![-2.0..2.0_f64, -1e-9..1e-9_f64, Just(0.0)]) {
            let difference = angle_of(x, y, libm::hypot(x, y)) - libm::atan2(y, x);
            // The last step takes over the errors of sine and cosine, above, which are at right angles: √2 times.
            let bound = 3.3e-16 * (1.0 + libm::atan2(y, x).abs());
            prop_assert!(difference.abs() <= bound, "{}", difference);
        }
    }

    #[test]
    fn what_has_no_angle() {
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
        assert_eq!(angle_of(0.0, 0.0, 0.0_f64), 0.0);
        // On the cut both signs are right.
        assert!((angle_of(-1.0, 0.0, 1.0_f64).abs() - core::f64::consts::PI).abs() < 5e-16);
    }
}
