//! The variate difference method (docs/theory.md, section 5): differences of the position that hold its noise alone.
//!
//! A difference of order p is zero for a polynomial of degree p − 1. So with a growing order less and less of the
//! motion is left, and white noise stays. The order is high enough where the next one leaves no less.

/// Share of the deviation at one order that the next must leave for the first to be enough. Deviations of noise over a
/// few hundred rows differ by less.
const STABLE: f64 = 0.8;
/// Orders are tried in steps of this size. An even order leaves the window's middle where it was.
const STEP: usize = 2;
/// Highest order. Of a motion with six rows a period it leaves a ten-thousandth.
const HIGHEST: usize = 14;

/// The differences of the lowest order beyond `order` that is high enough, with their deviation; `None` where `order`
/// itself is, whose deviation is `sigma`. `deviation` takes the deviation of differences.
pub fn higher_order(
    (order, sigma): (usize, f64),
    differences: impl Fn(usize) -> Vec<f64>,
    deviation: impl Fn(&[f64]) -> f64,
) -> Option<(Vec<f64>, f64)> {
    let mut best: Option<(Vec<f64>, f64)> = None;
    for order in (order + STEP..=HIGHEST).step_by(STEP) {
        let own = differences(order);
        let left = deviation(&own);
        if left >= STABLE * best.as_ref().map_or(sigma, |(_, sigma)| *sigma) {
            break;
        }
        best = Some((own, left));
    }
    best
}

/// The difference of `x` at each row, over the `order` + 1 rows about it, scaled so that white noise keeps its deviation.
/// The instants `t` need not be even. Rows nearer to an end take the last window; too few rows leave 0.
pub fn differences(t: &[f64], x: &[f64], order: usize) -> Vec<f64> {
    let windows: Vec<f64> = t.windows(order + 1).zip(x.windows(order + 1)).map(|(t, x)| difference(t, x)).collect();
    let Some(last) = windows.len().checked_sub(1) else { return vec![0.0; x.len()] };
    (0..x.len()).map(|k| windows[k.saturating_sub(order / 2).min(last)]).collect()
}

/// The divided difference over all rows of a window.
fn difference(t: &[f64], x: &[f64]) -> f64 {
    // About the mean interval, so that no product leaves the range of a double.
    let interval = (t[t.len() - 1] - t[0]) / (t.len() - 1) as f64;
    let (mut sum, mut square) = (0.0, 0.0);
    for (i, (own, position)) in t.iter().zip(x).enumerate() {
        let others = t.iter().enumerate().filter(|(j, _)| *j != i);
        let weight = 1.0 / others.map(|(_, other)| (own - other) / interval).product::<f64>();
        sum += weight * (position - x[0]);
        square += weight * weight;
    }
    sum / square.sqrt()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    const SIGMA: f64 = 1e-3;

    /// 4000 rows at about 100 Hz of a sine of this frequency, Hz, with noise of [`SIGMA`]: instants and positions.
    fn sampled(frequency_hz: f64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let (noise, jitter) = (Normal::new(0.0, SIGMA).unwrap(), Normal::new(0.0, 1e-3).unwrap());
        let t: Vec<f64> = (0..4000).map(|k| 1e-2 * f64::from(k) + jitter.sample(&mut rng)).collect();
        let sine = |t: &f64| (std::f64::consts::TAU * frequency_hz * t).sin();
        let x = t.iter().map(|t| sine(t) + noise.sample(&mut rng)).collect();
        (t, x)
    }

    fn deviation(differences: &[f64]) -> f64 {
        (differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64).sqrt()
    }

    /// Ten rows a period: a difference of order 4 leaves more than 5 times the noise's deviation. The lowest order that is
    /// high enough leaves it within 5 %. A deviation over 4000 rows that depend on their neighbours is known to 2 %.
    #[test]
    fn a_fast_motion_leaves_the_noise() {
        let (t, x) = sampled(10.0);
        let of = |order| differences(&t, &x, order);
        let fourth = deviation(&of(4));
        assert!(fourth > 5.0 * SIGMA, "{fourth}");
        let (own, sigma) = higher_order((4, fourth), of, deviation).unwrap();
        assert!(own.len() == x.len() && (sigma / SIGMA - 1.0).abs() < 0.05, "{sigma}");
    }

    /// A slow motion is a polynomial to its cubic already.
    #[test]
    fn a_slow_motion_needs_no_higher_order() {
        let (t, x) = sampled(0.5);
        let of = |order| differences(&t, &x, order);
        let fourth = deviation(&of(4));
        assert!((fourth / SIGMA - 1.0).abs() < 0.05, "{fourth}");
        assert!(higher_order((4, fourth), of, deviation).is_none());
    }

    #[test]
    fn few_rows_have_no_differences() {
        assert_eq!(differences(&[0.0, 1.0], &[3.0, 5.0], 4), [0.0; 2]);
        assert!(differences(&[], &[], 4).is_empty());
    }
}
