//! The error of a curve that does not use the drive: a model must beat it.
//!
//! The curve is a cubic polynomial in time, fitted to the position over each window by least squares. A model that is
//! further off over the same windows has learnt nothing from the drive.

use super::data::Data;

/// Degree of the polynomial.
pub const DEGREE: usize = 3;

/// Root mean square residual of the curve over the held-out windows of the open-loop score, position units; `None` without one.
pub(super) fn error(data: &Data) -> Option<f64> {
    let (mut square, mut samples) = (0.0, 0);
    for window in &data.open_loop {
        let track = &data.tracks[window.track];
        let range = window.start..window.start + window.len;
        square += residual_square(&track.t[range.clone()], &track.x[range.clone()]);
        samples += range.len();
    }
    (samples > 0).then(|| (square / samples as f64).sqrt())
}

/// Sum of the squared residuals of the polynomial, by Gram-Schmidt on the powers of time in −1..1. `t` and `x` are of one length.
pub fn residual_square(t: &[f64], x: &[f64]) -> f64 {
    let (Some(first), Some(last)) = (t.first(), t.last()) else { return 0.0 };
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let less = |from: &mut [f64], share: f64, of: &[f64]| {
        from.iter_mut().zip(of).for_each(|(value, direction)| *value -= share * direction);
    };
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let mut residual: Vec<f64> = x.iter().map(|x| x - mean).collect();
    let mut directions: Vec<Vec<f64>> = Vec::new();
    for power in 0..=DEGREE {
        let mut column: Vec<f64> = t.iter().map(|t| ((t - middle) / half).powi(power as i32)).collect();
        for direction in &directions {
            let share = dot(&column, direction);
            less(&mut column, share, direction);
        }
        let norm = dot(&column, &column).sqrt();
        for value in &mut column {
            *value /= norm;
        }
        let share = dot(&residual, &column);
        less(&mut residual, share, &column);
        directions.push(column);
    }
    dot(&residual, &residual)
}
