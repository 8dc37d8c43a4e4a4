//! Wave numbers at which the unexplained force repeats over position, and angular frequencies at which it repeats over
//! time. They come from a Lomb–Scargle periodogram of the windows' residual. A window counts by how much of the ripple
//! it passes.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::periodogram::{FASTEST_TURN, Lines, Near, Point, spectrum};
use super::weak_form::WeakForm;
use crate::fit::golden_section;

/// Most windows looked at, and most lines of the spectrum.
const MOST_WINDOWS: usize = 4000;
const MOST_LINES: usize = 12_000;
/// Most lines that are tried to either side of one, where all recordings share a phase.
const MOST_STEPS: usize = 200;
/// Lines in the resolution of the longest stretch.
const OVERSAMPLING: f64 = 4.0;
/// One window in so many must be slow enough to show a ripple.
const SLOWEST: usize = 40;

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
    let mut power = spectrum(&points, Lines { first: 0.0, spacing, count: lines }, form.half_width_s);
    power[..first].fill(0.0);
    let mut found = Vec::new();
    for _ in 0..count {
        let Some((i, best)) = power.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        if best <= 0.0 {
            break;
        }
        found.push(i as f64 * spacing);
        let width = OVERSAMPLING as usize + 1;
        power[i.saturating_sub(width)..(i + width + 1).min(lines)].fill(0.0);
    }
    let found = found.into_par_iter().map(|line| refined(&points, line, spacing, form.half_width_s)).collect();
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
    let steps = ((reach / fine) as usize).min(MOST_STEPS);
    let below = steps.min(((k / fine).ceil() as usize).saturating_sub(1));
    let lines = Lines { first: k - below as f64 * fine, spacing: fine, count: below + 1 + steps };
    let power = spectrum(&points, lines, form.half_width_s);
    let best = (0..lines.count).max_by(|a, b| power[*a].total_cmp(&power[*b]));
    refined(&points, best.map_or(k, |best| lines.at(best)), fine, form.half_width_s)
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

/// The line's place between its neighbours, by golden section.
fn refined(points: &[Point], k: f64, spacing: f64, half_width_s: f64) -> f64 {
    let bracket = [(k - spacing).max(0.25 * spacing), k + spacing];
    let near = Near::new(points, k, half_width_s);
    golden_section(bracket, 24, |k| -near.explained(k))
}
