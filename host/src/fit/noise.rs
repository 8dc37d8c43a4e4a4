//! Noise of the position, and jitter of the clock, from the residuals of the smoothed motion.

use super::settings::SPEED_CLASSES;
use super::statistics::median;

/// Standard deviation of the position's noise, from the residuals of the local cubic. It is the median of their mean
/// squares over blocks in motion. So reversals, switching edges and quantised rest do not count.
pub(super) fn noise(residuals: &[f64], velocity: &[f64], half: usize) -> f64 {
    let points = (2 * half + 1) as f64;
    // Share of a sample's own noise that the cubic takes up at its centre.
    let leverage = (2.25 / points).min(0.9);
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

/// Noise at rest and jitter of the clock, s, from the residuals of the local cubic. Over classes of speed they are σ² +
/// (jitter·v)². `None` where the residuals do not grow with speed.
pub(super) fn jitter(residuals: &[f64], velocity: &[f64], half: usize) -> Option<(f64, f64)> {
    let leverage = (2.25 / (2 * half + 1) as f64).min(0.9);
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
    (rest > 0.0 && square * fastest > rest).then(|| (rest.sqrt(), square.sqrt()))
}
