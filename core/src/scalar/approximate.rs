//! Fast approximate functions of f32 by micromath (feature `micromath`): where a control tick's budget allows their error.
//!
//! They are not part of [`Real`](super::Real), whose f32 uses libm. Worst errors against f64, measured by the test in
//! this file, which holds each to within 5 % of its entry:
//!
//! | function | range | worst error |
//! |---|---|---|
//! | [`fast_sqrt`] | 1e-6..1e6 | 6.07 % relative |
//! | [`fast_inverse_sqrt`] | 1e-6..1e6 | 3.44 % relative |
//! | [`fast_sin`] | ±π | 1.09e-3 |
//! | [`fast_sin`] | ±100 | 1.10e-3 |
//! | [`fast_cos`] | ±π | 1.09e-3 |
//! | [`fast_cos`] | ±100 | 1.10e-3 |
//! | [`fast_atan2`] | unit circle | 2.83e-3 rad |
//! | [`fast_exp`] | ±20 | 0.239 % relative |
//! | [`fast_ln`] | 1e-6..1e6 | 6.22e-5 |

use micromath::F32Ext;

/// Square root; 0 for negative input, as [`Real::sqrt`](super::Real::sqrt).
pub fn fast_sqrt(x: f32) -> f32 {
    if x > 0.0 { F32Ext::sqrt(x) } else { 0.0 }
}

/// 1/√x, x > 0; 0 otherwise.
pub fn fast_inverse_sqrt(x: f32) -> f32 {
    if x > 0.0 { F32Ext::invsqrt(x) } else { 0.0 }
}

/// Sine of an angle in radians. The error grows with the number of turns.
pub fn fast_sin(x: f32) -> f32 {
    F32Ext::sin(x)
}

/// Cosine of an angle in radians. The error grows with the number of turns.
pub fn fast_cos(x: f32) -> f32 {
    F32Ext::cos(x)
}

/// The angle of the point (`x`, `y`), in −π..π; 0 at the origin, where micromath gives NaN.
pub fn fast_atan2(y: f32, x: f32) -> f32 {
    if x == 0.0 && y == 0.0 { 0.0 } else { F32Ext::atan2(y, x) }
}

/// e to the power of `x`.
pub fn fast_exp(x: f32) -> f32 {
    // micromath gives the numbers above an exponent of 128, which no f32 has.
    if x >= LEAST_INFINITE { f32::INFINITY } else { F32Ext::exp(x) }
}

/// 128·ln 2, from which e^x is above every f32.
const LEAST_INFINITE: f32 = 88.722_84;

/// Natural logarithm; the most negative value for input ≤ 0, as [`Real::ln`](super::Real::ln).
pub fn fast_ln(x: f32) -> f32 {
    // Below 1 micromath takes its approximate reciprocal, which costs 0.118: divide instead.
    if x >= 1.0 {
        F32Ext::ln(x)
    } else if x > 0.0 {
        -F32Ext::ln(1.0 / x)
    } else {
        f32::MIN
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use proptest::prelude::*;

    /// Worst of |error| over 200 001 points of a range, linear or logarithmic.
    fn worst(low: f64, high: f64, logarithmic: bool, error: impl Fn(f32) -> f64) -> f64 {
        (0..=200_000)
            .map(|i| {
                let share = f64::from(i) / 200_000.0;
                let x = if logarithmic { low * libm::pow(high / low, share) } else { low + (high - low) * share };
                error(x as f32).abs()
            })
            .fold(0.0, f64::max)
    }

    fn of(fast: fn(f32) -> f32, exact: fn(f64) -> f64, relative: bool) -> impl Fn(f32) -> f64 {
        move |x| {
            let exact = exact(f64::from(x));
            let error = f64::from(fast(x)) - exact;
            if relative { error / exact } else { error }
        }
    }

    /// Each error is that of the module's table, neither above nor far below.
    #[test]
    fn error_table() {
        let inverse = |x: f64| 1.0 / libm::sqrt(x);
        let atan2 = |angle: f32| {
            let (y, x) = (libm::sin(f64::from(angle)), libm::cos(f64::from(angle)));
            let error = f64::from(fast_atan2(y as f32, x as f32)) - libm::atan2(y, x);
            libm::remainder(error, 2.0 * PI)
        };
        let table = [
            ("sqrt", worst(1e-6, 1e6, true, of(fast_sqrt, libm::sqrt, true)), 6.07e-2),
            ("invsqrt", worst(1e-6, 1e6, true, of(fast_inverse_sqrt, inverse, true)), 3.44e-2),
            ("sin", worst(-PI, PI, false, of(fast_sin, libm::sin, false)), 1.09e-3),
            ("sin 100", worst(-100.0, 100.0, false, of(fast_sin, libm::sin, false)), 1.10e-3),
            ("cos", worst(-PI, PI, false, of(fast_cos, libm::cos, false)), 1.09e-3),
            ("cos 100", worst(-100.0, 100.0, false, of(fast_cos, libm::cos, false)), 1.10e-3),
            ("atan2", worst(-PI, PI, false, atan2), 2.83e-3),
            ("exp", worst(-20.0, 20.0, false, of(fast_exp, libm::exp, true)), 2.39e-3),
            ("ln", worst(1e-6, 1e6, true, of(fast_ln, libm::log, false)), 6.22e-5),
        ];
        for (name, measured, stated) in table {
            assert!(
                (0.95..=1.05).contains(&(measured / stated)),
                "{name}: measured {measured:e}, stated {stated:e} in {table:?}"
            );
        }
    }

    /// From 88 to 90, where e^x leaves f32. micromath panics from 128·ln 2 to 129·ln 2 in debug, and gives NaN in release.
    #[test]
    fn the_exponential_grows_into_infinity() {
        let of = |k: u16| fast_exp(88.0 + f32::from(k) / 32_768.0);
        assert!((0..=u16::MAX).all(|k| !of(k).is_nan()));
        let first = (0..=u16::MAX).find(|k| of(*k).is_infinite()).unwrap();
        assert!((23_000..24_500).contains(&first), "{first}");
    }

    proptest! {
        #[test]
        fn nothing_panics(a in any::<f32>(), b in any::<f32>()) {
            let _ = (fast_sqrt(a), fast_inverse_sqrt(a), fast_sin(a), fast_cos(a));
            let _ = (fast_atan2(a, b), fast_exp(a), fast_ln(a));
        }
    }
}
