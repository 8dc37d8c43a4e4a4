//! What a window, and the samples in it, show of a ripple.

/// Share of a ripple that a window passes: the transform of (1 − s²)³. `turn` is the ripple's phase from the middle of
/// the window to its edge, rad.
pub fn attenuation(turn: f64) -> f64 {
    let a = turn.abs();
    if a < 0.3 {
        return 1.0 - a * a / 18.0;
    }
    let (sin, cos) = a.sin_cos();
    // 105·((15 − 6a²)·sin a − (15a − a³)·cos a)/a⁷, normalised to 1 at 0.
    105.0 * ((15.0 - 6.0 * a * a) * sin - (15.0 * a - a * a * a) * cos) / a.powi(7)
}

/// Share of a ripple that its samples show, from 0 to 1. The ripple turns by `turn` radians from one sample to the
/// next.
pub fn audible(turn: f64) -> f64 {
    1.0 / (1.0 + (1.3 * turn.abs()).powi(8))
}

#[cfg(test)]
mod tests {
    use super::attenuation;

    /// Simpson's rule on the integral of (1 − s²)³·cos(a·s) gives the same digits, at turns where neither cancels.
    #[test]
    fn the_attenuation_is_the_test_functions_transform() {
        for a in [0.1, 0.31, 1.0, 3.0, 7.0] {
            let n = 2000;
            let f = |i: usize| {
                let s = -1.0 + 2.0 * i as f64 / n as f64;
                (1.0 - s * s).powi(3) * (a * s).cos()
            };
            let simpson: f64 = (0..=n)
                .map(|i| {
                    f(i) * if i == 0 || i == n {
                        1.0
                    } else if i % 2 == 1 {
                        4.0
                    } else {
                        2.0
                    }
                })
                .sum::<f64>()
                * (2.0 / n as f64)
                / 3.0;
            let expected = simpson / (32.0 / 35.0);
            assert!((attenuation(a) - expected).abs() < 1e-4, "{a}: {} {expected}", attenuation(a));
        }
    }
}
