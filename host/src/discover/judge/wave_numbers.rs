//! Wave numbers at which the unexplained force repeats over position, and angular frequencies at which it repeats over
//! time. They come from a Lomb–Scargle periodogram of the windows' residual. A window counts by how much of the ripple
//! it passes.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::weak_form::WeakForm;
use crate::fit::golden_section;

/// Most windows looked at, and most lines of the spectrum.
const MOST_WINDOWS: usize = 4000;
const MOST_LINES: usize = 12_000;
/// Most lines that are tried to either side of one, where all recordings share a phase.
const MOST_STEPS: i64 = 200;
/// Lines in the resolution of the longest stretch.
const OVERSAMPLING: f64 = 4.0;
/// One window in so many must be slow enough to show a ripple.
const SLOWEST: usize = 40;
/// Turn of a ripple between two samples above which it is not seen, rad.
const FASTEST_TURN: f64 = 1.5;

/// Position or time of a window, its rate, and its residual.
struct Point {
    group: usize,
    at: f64,
    rate: f64,
    residual: f64,
    weight: f64,
    h_s: f64,
}

/// The coordinate of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Position.
    Position,
    /// Session time.
    Time,
}

/// The strongest lines of a spectrum.
#[derive(Clone, Debug, Default)]
pub struct Peaks {
    /// Wave numbers or angular frequencies, the strongest first.
    pub lines: Vec<f64>,
    /// Number of lines that the recordings can resolve, from which these are the strongest.
    pub of_lines: f64,
}

/// The strongest lines of `residual` (drive units, weighted), at most `count`.
pub fn peaks(form: &WeakForm<'_>, residual: &[f64], weights: &[f64], over: Over, count: usize) -> Peaks {
    let points = points(form, residual, weights, over);
    let span = spans(&points).into_iter().fold(0.0, f64::max);
    if !(span > 0.0 && span.is_finite()) || points.len() < 16 {
        return Peaks::default();
    }
    let spacing = TAU / span / OVERSAMPLING;
    let mut rates: Vec<f64> = points.iter().map(|p| (p.rate * p.h_s).abs()).collect();
    rates.sort_by(f64::total_cmp);
    let mut slow: Vec<f64> = points.iter().map(|p| p.rate.abs() * form.half_width_s).collect();
    slow.sort_by(f64::total_cmp);
    // The highest line. Above it the ripple passes between two samples, or within a window, in all but the slowest
    // windows.
    let fastest =
        (FASTEST_TURN / rates[rates.len() / SLOWEST].max(1e-12)).min(6.0 / slow[slow.len() / SLOWEST].max(1e-12));
    // A ripple that is not seen twice is none.
    let first = 2 * OVERSAMPLING as usize;
    let lines = ((fastest / spacing) as usize).clamp(first + 8, MOST_LINES);
    let mut power = spectrum(&points, spacing, lines, form.half_width_s);
    power[..first].fill(0.0);
    let mut found = Vec::new();
    for _ in 0..count {
        let Some((i, best)) = power.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if best <= 0.0 {
            break;
        }
        found.push(refined(&points, i as f64 * spacing, spacing, form.half_width_s));
        let width = OVERSAMPLING as usize + 1;
        power[i.saturating_sub(width)..(i + width + 1).min(lines)].fill(0.0);
    }
    Peaks { lines: found, of_lines: (lines - first) as f64 / OVERSAMPLING }
}

/// The line near `k` that explains most with one phase for all recordings. Their positions must share a zero.
pub fn coherent(form: &WeakForm<'_>, residual: &[f64], weights: &[f64], k: f64) -> f64 {
    let mut points = points(form, residual, weights, Over::Position);
    let own = spans(&points).into_iter().fold(0.0, f64::max);
    for point in &mut points {
        point.group = 0;
    }
    let all = spans(&points).into_iter().fold(0.0, f64::max);
    if !(own > 0.0 && all.is_finite()) {
        return k;
    }
    let fine = TAU / all / OVERSAMPLING;
    let reach = TAU / own / 2.0;
    let steps = ((reach / fine) as i64).min(MOST_STEPS);
    let each = (-steps..=steps).map(|i| k + i as f64 * fine).filter(|k| *k > 0.0);
    let best = each
        .max_by(|a, b| explained(&points, *a, form.half_width_s).total_cmp(&explained(&points, *b, form.half_width_s)));
    refined(&points, best.unwrap_or(k), fine, form.half_width_s)
}

fn points(form: &WeakForm<'_>, residual: &[f64], weights: &[f64], over: Over) -> Vec<Point> {
    let step = form.rows.len().div_ceil(MOST_WINDOWS).max(1);
    // The mean square of the weights is 1, so that sums of squares count windows.
    let scale = 1.0 / (weights.iter().map(|w| w * w).sum::<f64>() / weights.len().max(1) as f64).sqrt();
    let each = form.rows.iter().zip(residual.iter().zip(weights)).zip(&form.row_v).step_by(step).map(
        |((row, (residual, weight)), v)| {
            let piece = &form.dataset.pieces[row.piece];
            let (group, at, rate) = match over {
                Over::Position => (piece.recording, piece.x[row.centre], *v),
                Over::Time => (0, piece.t[row.centre], 1.0),
            };
            Point { group, at, rate, residual: weight * residual, weight: *weight * scale, h_s: piece.h_s }
        },
    );
    each.collect()
}

/// Extent of every recording.
fn spans(points: &[Point]) -> Vec<f64> {
    let groups = points.iter().map(|p| p.group).max().map_or(0, |g| g + 1);
    let mut bounds = vec![(f64::INFINITY, f64::NEG_INFINITY); groups];
    for p in points {
        let bound = &mut bounds[p.group];
        *bound = (bound.0.min(p.at), bound.1.max(p.at));
    }
    bounds.into_iter().map(|(low, high)| high - low).collect()
}

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

/// [`explained`] at every multiple of `spacing`. The waves are turned on from line to line, which saves their sines.
fn spectrum(points: &[Point], spacing: f64, lines: usize, half_width_s: f64) -> Vec<f64> {
    let groups = points.iter().map(|p| p.group).max().map_or(0, |g| g + 1);
    let table: Vec<f64> = (0..=TABLE).map(|i| attenuation(TABLE_TURN * i as f64 / TABLE as f64)).collect();
    let chunks: Vec<usize> = (0..lines).step_by(CHUNK).collect();
    // The largest wave number at which a point shows a ripple. Those that show the highest come first, so that each line
    // looks at the points before one, and no wave is turned on in vain.
    let seen = |p: &Point| {
        (TABLE_TURN / (p.rate * half_width_s).abs().max(f64::MIN_POSITIVE))
            .min(FASTEST_TURN / (p.rate * p.h_s).abs().max(f64::MIN_POSITIVE))
    };
    let mut points: Vec<(f64, &Point)> = points.iter().map(|p| (seen(p), p)).collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let points = &points;
    let power = chunks.into_par_iter().flat_map_iter(|from| {
        let to = (from + CHUNK).min(lines);
        let showing = |line: usize| points.partition_point(|(most, _)| *most > line as f64 * spacing);
        let mut waves: Vec<[f64; 4]> = points[..showing(from)]
            .iter()
            .map(|(_, p)| {
                let (sin, cos) = (from as f64 * spacing * p.at).sin_cos();
                let (turn_sin, turn_cos) = (spacing * p.at).sin_cos();
                [sin, cos, turn_sin, turn_cos]
            })
            .collect();
        let mut powers = Vec::with_capacity(to - from);
        for line in from..to {
            let turn_of_rate = line as f64 * spacing * half_width_s * (TABLE as f64 / TABLE_TURN);
            let mut sums = vec![[0.0; 5]; groups];
            waves.truncate(showing(line));
            for ((_, p), wave) in points.iter().zip(&mut waves) {
                let left = p.weight * table[((turn_of_rate * p.rate).abs() as usize).min(TABLE)];
                add(&mut sums[p.group], left, wave[0], wave[1], p.residual);
                let [sin, cos, turn_sin, turn_cos] = *wave;
                wave[0] = sin * turn_cos + cos * turn_sin;
                wave[1] = cos * turn_cos - sin * turn_sin;
            }
            powers.push(sums.iter().map(explained_by).sum());
        }
        powers
    });
    power.collect()
}

/// Lines whose waves are turned on in one go; entries of the attenuation's table; and the turn at its end, rad. Beyond it
/// a window passes less than 1 % of a ripple.
const CHUNK: usize = 256;
const TABLE: usize = 4096;
const TABLE_TURN: f64 = 12.0;

#[inline]
fn add(sum: &mut [f64; 5], left: f64, sin: f64, cos: f64, residual: f64) {
    sum[0] += left * sin * residual;
    sum[1] += left * cos * residual;
    sum[2] += left * left * sin * sin;
    sum[3] += left * left * cos * cos;
    sum[4] += left * left * sin * cos;
}

/// Sum of squares that a sine and a cosine explain; 0 where the windows do not tell them apart.
fn explained_by([s, c, ss, cc, sc]: &[f64; 5]) -> f64 {
    let determinant = ss * cc - sc * sc;
    if determinant > 1e-3 * (ss + cc).powi(2) && ss + cc > 4.0 {
        (s * s * cc - 2.0 * s * c * sc + c * c * ss) / determinant
    } else {
        0.0
    }
}

/// Sum of squares that sine and cosine of wave number `k` explain, with a phase for each recording.
fn explained(points: &[Point], k: f64, half_width_s: f64) -> f64 {
    let groups = points.iter().map(|p| p.group).max().map_or(0, |g| g + 1);
    let mut sums = vec![[0.0; 5]; groups];
    for p in points {
        let left = p.weight * attenuation(k * p.rate * half_width_s) * audible(k * p.rate * p.h_s);
        let (sin, cos) = (k * p.at).sin_cos();
        add(&mut sums[p.group], left, sin, cos, p.residual);
    }
    sums.iter().map(explained_by).sum()
}

/// The line's place between its neighbours, by golden section.
fn refined(points: &[Point], k: f64, spacing: f64, half_width_s: f64) -> f64 {
    let bracket = [(k - spacing).max(0.25 * spacing), k + spacing];
    golden_section(bracket, 24, |k| -explained(points, k, half_width_s))
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
