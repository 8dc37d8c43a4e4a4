//! What a curve follows that knows nothing of the drive: the least that a model has to beat.
//!
//! Over each window of 1 s of the held-out measurement a cubic polynomial in time is fitted to the position by least
//! squares. A model whose simulation over the same windows is further off than this curve has learnt nothing from the drive.

use breakaway::discover::drive_free::{DEGREE, residual_square};
use breakaway::recording::Recording;

use super::splits::Taken;

/// Length of a window, s: that of the open-loop score of a discovery.
const WINDOW_S: f64 = 1.0;
/// Fewest samples of a window: twice the coefficients.
const LEAST_SAMPLES: usize = 2 * (DEGREE + 1);

/// Root mean square residual of the curve, position units, over all held-out windows of a split; `None` without a window.
///
/// Windows begin where pieces between gaps begin; the rest of a piece counts if it is longer than half a window. Where
/// nothing is held out by the split, windows that begin in the last third of a recording are, as in a discovery.
pub fn error(taken: &Taken) -> Option<f64> {
    let whole = !taken.holdout.is_empty();
    let recordings = if whole { &taken.holdout } else { &taken.fit };
    let (mut square, mut samples) = (0.0, 0);
    for recording in recordings {
        let from = if whole { 0 } else { (2 * recording.t.len()).div_ceil(3) };
        for window in windows(recording).into_iter().filter(|window| window.start >= from) {
            square += residual_square(&recording.t[window.clone()], &recording.x[window.clone()]);
            samples += window.len();
        }
    }
    (samples > 0).then(|| (square / samples as f64).sqrt())
}

fn windows(recording: &Recording) -> Vec<std::ops::Range<usize>> {
    let length = (WINDOW_S / recording.timing().median_s.max(f64::MIN_POSITIVE)).round().max(1.0) as usize;
    let mut windows = Vec::new();
    for piece in recording.pieces() {
        let mut start = piece.start;
        while start + length / 2 < piece.end {
            let end = (start + length).min(piece.end);
            if end - start >= LEAST_SAMPLES {
                windows.push(start..end);
            }
            start = end;
        }
    }
    windows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(x: impl Fn(f64) -> f64) -> Recording {
        let t: Vec<f64> = (0..3000).map(|k| 5.0 + 1e-3 * f64::from(k)).collect();
        let x = t.iter().map(|&t| x(t - 7.0)).collect();
        Recording { u: vec![0.0; t.len()], x, t, ..Recording::default() }
    }

    /// A cubic leaves nothing. Of t⁴ over a window of half-width h = 0.5 a cubic leaves h⁴·8/35·√(1/9), the norm of
    /// the quartic Legendre polynomial: t⁴ = (8/35)·P4 + …, and the mean square of P4 is 1/9.
    #[test]
    fn the_curve_is_a_cubic_over_the_held_out_second() {
        let cubic = Taken { fit: vec![recording(|t| 3.0 + t - 2.0 * t * t + 4.0 * t.powi(3))], ..Taken::default() };
        assert!(error(&cubic).unwrap() < 1e-12);
        // The last third is the window from 7 s to 8 s, whose middle is 0.5 s after the recording's zero.
        let quartic = Taken { fit: vec![recording(|t| (t - 0.5).powi(4))], ..Taken::default() };
        let expected = 0.5_f64.powi(4) * 8.0 / 35.0 / 3.0;
        // A window has 1000 samples, not a continuum: the difference is of the order of 1/1000.
        assert!((error(&quartic).unwrap() / expected - 1.0).abs() < 5e-3);
        // What the split holds out is looked at, and the whole of it.
        let held = Taken { fit: cubic.fit, holdout: vec![recording(|t| if t < -1.0 { 1.0 } else { 0.0 })] };
        assert!(error(&held).unwrap() < 1e-12, "a step between two windows is no residual");
        assert_eq!(error(&Taken::default()), None);
    }
}
