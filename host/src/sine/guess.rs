//! A first guess of a signal's frequency: the strongest line of a coarse spectrum.

use std::f64::consts::TAU;

/// Samples the spectrum is computed from: 1024 cycles can be told apart, in milliseconds.
const POINTS: usize = 2048;

/// The strongest line of the signal.
///
/// Two spectra. One is of the whole record averaged down to [`POINTS`], for slow lines. The other is of the first
/// [`POINTS`] samples as they are, for lines that the averages would remove. `None` for a signal without a line.
pub(super) fn strongest_line(t: &[f64], y: &[f64]) -> Option<Line> {
    let whole = averaged(t, y);
    let head = POINTS.min(t.len()).min(y.len());
    let first: Vec<(f64, f64)> = t.iter().copied().zip(y.iter().copied()).take(head).collect();
    let slow = peak(whole);
    let fast = if head < t.len() { peak(first) } else { None };
    [slow, fast].into_iter().flatten().max_by(|a, b| a.power.total_cmp(&b.power))
}

/// A line of a coarse spectrum.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Distance to the spectrum's next line, rad/s: half a cycle in what was looked at.
    pub step: f64,
    /// Mean square of the line, A²/2. It is not a share of the segment's, because the first moments of a slow sine
    /// would then be a line.
    pub power: f64,
}

/// Means of equally many neighbouring samples, at most [`POINTS`].
fn averaged(t: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let each = t.len().div_ceil(POINTS).max(1);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    t.chunks(each).zip(y.chunks(each)).map(|(t, y)| (mean(t), mean(y))).collect()
}

/// The strongest line of at least one cycle and at most one cycle per two samples.
fn peak(mut samples: Vec<(f64, f64)>) -> Option<Line> {
    let (first, last) = (samples.first()?.0, samples.last()?.0);
    let count = samples.len() as f64;
    let span = (last - first) * count / (count - 1.0);
    if !(span.is_finite() && span > 0.0) {
        return None;
    }
    detrend(&mut samples);
    let power: f64 = samples.iter().map(|(_, y)| y * y).sum();
    if !(power.is_finite() && power > 0.0) {
        return None;
    }
    // Steps of half a cycle: any line is within a quarter cycle of one, where it keeps sinc²(1/4) = 81 % of its power.
    (2..=samples.len())
        .map(|half| {
            let step = TAU * 0.5 / span;
            let omega = step * half as f64;
            let (mut cos, mut sin) = (0.0, 0.0);
            for (t, y) in &samples {
                let (s, c) = (omega * (t - first)).sin_cos();
                cos += y * c;
                sin += y * s;
            }
            Line { omega, step, power: 2.0 * (cos * cos + sin * sin) / (count * count) }
        })
        .max_by(|a, b| a.power.total_cmp(&b.power))
}

/// Takes out the straight line: a drifting position would hide its sine behind it.
fn detrend(samples: &mut [(f64, f64)]) {
    let count = samples.len() as f64;
    let mean_t = samples.iter().map(|(t, _)| t).sum::<f64>() / count;
    let mean_y = samples.iter().map(|(_, y)| y).sum::<f64>() / count;
    let (mut cross, mut square) = (0.0, 0.0);
    for (t, y) in samples.iter() {
        cross += (t - mean_t) * (y - mean_y);
        square += (t - mean_t) * (t - mean_t);
    }
    let slope = if square > 0.0 { cross / square } else { 0.0 };
    for (t, y) in samples {
        *y -= mean_y + slope * (*t - mean_t);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 000 jittered samples over 100 s of a line on a slope; 3 Hz stands out in the averages, 300 Hz only in the samples.
    #[test]
    fn finds_slow_and_fast_lines_on_a_slope_under_a_jittered_clock() {
        let t: Vec<f64> =
            (0..100_000).map(|k| 1e-3 * (f64::from(k) + 0.3 * f64::from(k * 7919 % 101) / 101.0)).collect();
        for hertz in [0.01, 0.3, 3.0, 300.0] {
            let y: Vec<f64> = t.iter().map(|t| (TAU * hertz * t + 1.0).sin() + 0.05 * t).collect();
            let line = strongest_line(&t, &y).unwrap();
            // One cycle on a slope loses part of itself to the slope: its line is sought from half to twice the guess.
            let within = if hertz < 0.02 { 0.5 } else { line.step / line.omega };
            assert!((TAU * hertz / line.omega - 1.0).abs() <= within, "{hertz}: {line:?}");
        }
    }

    #[test]
    fn a_signal_without_a_line_has_none() {
        assert!(strongest_line(&[0.0, 1.0, 2.0], &[1.0, 1.0, 1.0]).is_none());
        assert!(strongest_line(&[0.0], &[1.0]).is_none());
        assert!(strongest_line(&[], &[]).is_none());
    }
}
