//! Noise of the position, and jitter of the clock, from residuals of the smoothed motion.

use super::settings::SPEED_CLASSES;
use super::statistics::median;

/// Share of a sample's own noise that a local cubic over ±`half` samples takes up at its centre.
pub(super) fn leverage(half: usize) -> f64 {
    (2.25 / (2 * half + 1) as f64).min(0.9)
}

/// Standard deviation of the position's noise, from residuals that lack the share `leverage` of it. It is the median of
/// their mean squares over blocks in motion. So reversals, switching edges and quantised rest do not count.
pub(super) fn noise(residuals: &[f64], velocity: &[f64], leverage: f64) -> f64 {
    let typical = median(velocity.iter().map(|v| v.abs()).collect());
    let blocks = residuals.chunks(64).zip(velocity.chunks(64)).filter(|(r, _)| r.len() == 64);
    let mean_square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>() / r.len() as f64;
    let moving: Vec<f64> = blocks
        .clone()
        .filter(|(_, v)| v.iter().map(|v| v.abs()).sum::<f64>() / 64.0 >= 0.5 * typical)
        .map(|(r, _)| mean_square(r))
        .collect();
    let squares = if moving.len() >= 8 { moving } else { vec![mean_square(residuals)] };
    (median(squares) / (1.0 - leverage)).sqrt()
}

/// Share of the misfit of a constant noise that jitter may leave where the stamps are regular. Jitter itself leaves the
/// scatter of the classes alone. The residuals of quantised positions grow with the speed too, up to that of a step in
/// each row. So the faster half of the classes must follow the law better than a constant as well.
const REGULAR: f64 = 0.25;

/// Noise at rest and jitter of the clock, s, from the same residuals. Over classes of speed they are σ² + (jitter·v)².
/// `None` where the residuals do not grow with speed. Stamps that are `regular` may be nominal. The residuals alone tell
/// then, and must follow that law.
pub(super) fn jitter(residuals: &[f64], velocity: &[f64], leverage: f64, regular: bool) -> Option<(f64, f64)> {
    let mut order: Vec<usize> = (0..residuals.len()).collect();
    order.sort_by(|a, b| velocity[*a].abs().total_cmp(&velocity[*b].abs()));
    // (mean square speed, variance) of every class. The median is used, so that reversals do not count.
    let classes: Vec<(f64, f64)> = order
        .chunks(residuals.len().div_ceil(SPEED_CLASSES).max(8))
        .map(|class| {
            let speed = class.iter().map(|k| velocity[*k].powi(2)).sum::<f64>() / class.len() as f64;
            let deviation = median(class.iter().map(|k| residuals[*k].abs()).collect()) / 0.6745;
            (speed, deviation * deviation / (1.0 - leverage))
        })
        .collect();
    let fast = &classes[classes.len() / 2..];
    let square = median(fast.iter().filter(|c| c.0 > 0.0).map(|(speed, variance)| variance / speed).collect());
    let rest = classes
        .iter()
        .map(|(speed, variance)| (variance - square * speed).max(0.1 * variance))
        .fold(f64::INFINITY, f64::min);
    let fastest = classes.last()?.0;
    let over = |classes: &[(f64, f64)]| [misfit(classes, |speed| rest + square * speed), misfit(classes, |_| 1.0)];
    let lawful = || {
        let ([law, constant], [faster_law, faster_constant]) = (over(&classes), over(fast));
        law < REGULAR * constant && faster_law < faster_constant
    };
    (rest > 0.0 && square * fastest > rest && (!regular || lawful())).then(|| (rest.sqrt(), square.sqrt()))
}

/// Variance of the logarithms of the classes' variances over those of a law of the square speed.
fn misfit(classes: &[(f64, f64)], law: impl Fn(f64) -> f64) -> f64 {
    let logs: Vec<f64> = classes.iter().map(|(speed, variance)| (variance / law(*speed)).ln()).collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / logs.len() as f64
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal, Uniform};

    use super::*;

    /// Jitter of regular stamps, by residuals at speeds up to 5 rad/s that deviate by this at each speed.
    fn found(deviation: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let (normal, speeds) = (Normal::new(0.0, 1.0).unwrap(), Uniform::new(0.0, 5.0).unwrap());
        let velocity: Vec<f64> = (0..8000).map(|_| speeds.sample(&mut rng)).collect();
        let residuals: Vec<f64> = velocity.iter().map(|v| deviation(*v) * normal.sample(&mut rng)).collect();
        jitter(&residuals, &velocity, 0.0, true)
    }

    /// 1 ms of jitter over .3 mrad of noise is found to 5 %; a class of 333 residuals knows its deviation to 6 %.
    #[test]
    fn stamps_that_are_nominal_jitter() {
        let (rest, jitter_s) = found(|v: f64| 3e-4_f64.hypot(1e-3 * v)).unwrap();
        assert!((jitter_s / 1e-3 - 1.0).abs() < 0.05 && (0.5..1.5).contains(&(rest / 3e-4)), "{rest} {jitter_s}");
    }

    /// A constant noise is none, nor one of coarse positions: it grows up to the speed of a step in each row, and stays.
    #[test]
    fn coarse_positions_do_not_jitter() {
        assert_eq!(found(|_| 1e-3), None);
        for step_speed in [0.2, 0.5, 1.0, 2.0] {
            assert_eq!(found(|v: f64| 1e-3 * (v / step_speed).min(1.0).max(0.05)), None, "{step_speed}");
        }
    }
}
