//! Wave numbers and frequencies of the residual force.

use breakaway_core::plant::effect::Over;

use crate::fit::{MeasuredMotion, golden_section};
use crate::identify::weak::Window;

/// Most peaks that are returned.
const PEAKS: usize = 6;
/// Most windows that are used. Where there are more, they are thinned.
const MAX_WINDOWS: usize = 1500;
/// Most wave numbers that are tried.
const MAX_LINES: usize = 8000;
/// Standard deviation of the windows' test function as a density, as a share of their half-width: `√(I2/I0)`.
const SPREAD: f64 = 0.3013;

/// Share of the force's sum of squares `total` in its strongest line, 0..1. The share that chance gives the best of
/// many lines is taken off.
pub fn strongest_share(tracks: &[MeasuredMotion], windows: &[Window], force: &[f64], over: Over, total: f64) -> f64 {
    let points = points(tracks, windows, force, over);
    let width_s = windows.first().map_or(0.0, Window::half_width_s);
    let best = peaks(tracks, windows, force, over).first().map_or(0.0, |n| line_power(&points, *n, width_s));
    let scale = force.len() as f64 / points.len().max(1) as f64;
    let chance = 2.0 * (MAX_LINES as f64).ln() / points.len().max(1) as f64;
    (best * scale / total.max(f64::MIN_POSITIVE) - chance).clamp(0.0, 1.0)
}

/// The strongest wave numbers (or angular frequencies) of the residual force, the strongest first.
pub fn peaks(tracks: &[MeasuredMotion], windows: &[Window], force: &[f64], over: Over) -> Vec<f64> {
    let points = points(tracks, windows, force, over);
    let width_s = windows.first().map_or(0.0, Window::half_width_s);
    let low = points.iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
    let span = high - low;
    if !(span > 0.0 && span.is_finite()) {
        return Vec::new();
    }
    let spacing = std::f64::consts::TAU / span * 0.25;
    let fastest = if over == Over::Time {
        200.0
    } else {
        // Above this the ripple passes within a window even in the slowest parts of the motion.
        let mut speeds: Vec<f64> = points.iter().map(|p| p[2].abs()).collect();
        speeds.sort_by(f64::total_cmp);
        1.5 / (SPREAD * width_s * speeds[speeds.len() / 32].max(1e-12))
    };
    let lines = ((fastest / spacing) as usize).clamp(8, MAX_LINES);
    let mut power = comb_power(&points, spacing, lines, width_s);
    let mut found = Vec::new();
    for _ in 0..PEAKS {
        let Some((i, _)) = power.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) else { break };
        if power[i] <= 0.0 {
            break;
        }
        found.push(polish(&points, (i + 1) as f64 * spacing, spacing, width_s));
        // The main lobe is eight lines wide at a quarter of the resolution.
        for slot in power.iter_mut().take(i + 5).skip(i.saturating_sub(4)) {
            *slot = 0.0;
        }
    }
    found
}

/// Coordinate, force, speed of the coordinate and weight at a part of the windows.
fn points(tracks: &[MeasuredMotion], windows: &[Window], force: &[f64], over: Over) -> Vec<[f64; 4]> {
    let step = windows.len().div_ceil(MAX_WINDOWS).max(1);
    let mut chosen: Vec<usize> = (0..windows.len()).step_by(step).collect();
    if windows.iter().any(|w| w.scale < 1.0) {
        // Where the noise grows with speed, slow windows tell more than evenly spaced ones.
        let mut heaviest: Vec<usize> = (0..windows.len()).collect();
        heaviest.sort_by(|a, b| windows[*b].scale.total_cmp(&windows[*a].scale));
        heaviest.truncate(MAX_WINDOWS);
        chosen = heaviest;
    }
    chosen
        .into_iter()
        .map(|i| (&windows[i], &force[i]))
        .map(|(w, force)| {
            let track = &tracks[w.track];
            let (x, v) = (track.xs[w.centre], track.vs[w.centre]);
            match over {
                Over::Position => [x, *force, v, w.scale],
                Over::PositionAndDirection => [x, *force * v.signum(), v, w.scale],
                Over::Time => [track.t[w.centre], *force, 1.0, w.scale],
            }
        })
        .collect()
}

/// Sums over the points of products of force, cosine and sine, for the least squares of a line.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    cc: f64,
    cs: f64,
    ss: f64,
    fc: f64,
    fs: f64,
}

impl Sums {
    fn add(&mut self, weight: f64, force: f64, sine: f64, cosine: f64) {
        let (force, sine, cosine) = (weight * force, weight * sine, weight * cosine);
        self.cc += cosine * cosine;
        self.cs += cosine * sine;
        self.ss += sine * sine;
        self.fc += force * cosine;
        self.fs += force * sine;
    }

    /// Reduction of the sum of squares by a sine and a cosine; 0 where the points do not tell them apart.
    fn power(self) -> f64 {
        let Self { cc, cs, ss, fc, fs } = self;
        let determinant = cc * ss - cs * cs;
        if determinant <= 1e-9 * cc * ss {
            return 0.0;
        }
        (fc * fc * ss - 2.0 * fc * fs * cs + fs * fs * cc) / determinant
    }
}

/// Share of a ripple of wave number `n` that a window passes, of half-width `width_s` at speed `v`.
fn attenuation(n: f64, v: f64, width_s: f64) -> f64 {
    let a = n * v * SPREAD * width_s;
    1.0 / (1.0 + 0.5 * a * a)
}

/// Reduction of the sum of squares by a sine and a cosine at wave number `n`, as windows of half-width `width_s` pass
/// them.
fn line_power(points: &[[f64; 4]], n: f64, width_s: f64) -> f64 {
    let mut sums = Sums::default();
    for [x, force, v, weight] in points {
        let (sine, cosine) = (n * x).sin_cos();
        let left = attenuation(n, *v, width_s);
        sums.add(*weight, *force, left * sine, left * cosine);
    }
    sums.power()
}

/// [`line_power`] at the first `lines` multiples of `spacing`. Every point's angle is turned on from line to line.
fn comb_power(points: &[[f64; 4]], spacing: f64, lines: usize, width_s: f64) -> Vec<f64> {
    let turns: Vec<(f64, f64)> = points.iter().map(|[x, ..]| (spacing * x).sin_cos()).collect();
    let mut angles = vec![(0.0, 1.0); points.len()];
    (1..=lines)
        .map(|i| {
            let n = i as f64 * spacing;
            let mut sums = Sums::default();
            for (([_, force, v, weight], (sine, cosine)), (ds, dc)) in points.iter().zip(&mut angles).zip(&turns) {
                (*sine, *cosine) = (*sine * dc + *cosine * ds, *cosine * dc - *sine * ds);
                let left = attenuation(n, *v, width_s);
                sums.add(*weight, *force, left * *sine, left * *cosine);
            }
            sums.power()
        })
        .collect()
}

/// The maximum within a spacing of `n`, by golden section.
fn polish(points: &[[f64; 4]], n: f64, spacing: f64, width_s: f64) -> f64 {
    let bracket = [(n - spacing).max(0.2 * spacing), n + spacing];
    golden_section(bracket, 12, |n| -line_power(points, n, width_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The turned angles give the same as the sines themselves, to 1e-9 after 8000 lines. Each turn loses about 1e-16.
    #[test]
    fn comb_agrees_with_the_lines() {
        let point = |i: i32| {
            let x = 7.3 * (0.37 * f64::from(i)).sin();
            [
                x,
                (11.0 * x).cos() + 0.1 * f64::from(i % 7),
                2.0 * (0.11 * f64::from(i)).cos(),
                1.0 / f64::from(1 + i % 3),
            ]
        };
        let points: Vec<[f64; 4]> = (0..200).map(point).collect();
        let comb = comb_power(&points, 0.05, MAX_LINES, 0.02);
        for (i, power) in comb.iter().enumerate().step_by(97) {
            let line = line_power(&points, (i + 1) as f64 * 0.05, 0.02);
            assert!((power - line).abs() <= 1e-9 * (1.0 + line), "line {i}: {power} against {line}");
        }
    }
}
