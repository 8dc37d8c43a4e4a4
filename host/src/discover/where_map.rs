//! The map of the gap: the residual force over the coordinates of the motion.

use super::data::Data;
use super::outcome::WhereRow;
use super::screen::Screen;
use super::spectrum;
use breakaway_core::plant::effect::Over;

/// Folds of the cross-validation. They are blocks of the session, because neighbouring windows are not independent.
const FOLDS: usize = 8;
/// Bins of a smooth coordinate.
const BINS: usize = 16;
/// Bins of the position, over which ripples are sought.
const FINE_BINS: usize = 96;

/// One coordinate.
struct Coordinate {
    name: &'static str,
    /// Its unit, with `U` and `X`.
    unit: &'static str,
    /// Its value at every window.
    value: Vec<f64>,
    /// The sign given to the force.
    sign: Vec<f64>,
    bins: usize,
    /// Whether it is made of the drive. The residual of the drive holds the drive. So the residual of the motion is mapped.
    of_drive: bool,
}

/// The coordinates at every window of the screen.
fn coordinates(data: &Data, screen: &Screen<'_>) -> Vec<Coordinate> {
    let windows = screen.windows();
    let n = windows.len();
    let (mut since_reversal, mut since_edge) = (vec![0.0; n], vec![0.0; n]);
    for (i, w) in windows.iter().enumerate() {
        let track = &data.tracks[w.track];
        let k = w.centre;
        let direction = track.vs[k] > 0.0;
        let mut j = k;
        while j > 0 && (track.vs[j - 1] > 0.0) == direction && k - j < 2000 {
            j -= 1;
        }
        since_reversal[i] = (track.xs[k] - track.xs[j]).abs();
        let mut j = k;
        // At an edge the drive moves by more than a smooth excitation moves it from sample to sample.
        let edge = 0.2 * track.u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        while j > 0 && (track.u[j] - track.u[j - 1]).abs() < edge && k - j < 2000 {
            j -= 1;
        }
        since_edge[i] = track.t[k] - track.t[j];
    }
    let at = |f: &dyn Fn(&crate::fit::MeasuredMotion, usize) -> f64| -> Vec<f64> {
        windows.iter().map(|w| f(&data.tracks[w.track], w.centre)).collect()
    };
    let one = vec![1.0; n];
    let direction = at(&|t, k| t.vs[k].signum());
    let signed =
        |name, unit, value, bins| Coordinate { name, unit, value, sign: direction.clone(), bins, of_drive: false };
    let plain = |name, unit, value, bins| Coordinate { sign: one.clone(), ..signed(name, unit, value, bins) };
    let of_drive = |name, unit, value| Coordinate { of_drive: true, ..plain(name, unit, value, BINS) };
    vec![
        plain("velocity", "X/s", at(&|t, k| t.vs[k]), BINS),
        plain("position", "X", at(&|t, k| t.xs[k]), FINE_BINS),
        signed("position × direction", "X", at(&|t, k| t.xs[k]), FINE_BINS),
        plain("direction", "", direction.clone(), 2),
        of_drive("drive level", "U", at(&|t, k| t.u[k])),
        plain("acceleration", "X/s²", at(&|t, k| t.acceleration[k]), BINS),
        signed("distance since reversal", "X", since_reversal, BINS),
        of_drive("time since drive edge", "s", since_edge),
        signed("session time × direction", "s", at(&|t, k| t.t[k]), BINS),
        plain("session time", "s", at(&|t, k| t.t[k]), BINS),
    ]
}

/// The map of the residual of one model, in a fixed order of the coordinates: name, unit, R², binned curve.
pub fn map(data: &Data, screen: &Screen<'_>) -> Vec<(&'static str, &'static str, f64, Vec<[f64; 3]>)> {
    let force = screen.residual_force();
    let of_motion = screen.residual_force_of_motion().unwrap_or_default();
    let mut rows: Vec<_> = coordinates(data, screen)
        .into_iter()
        .map(|c| {
            let force = if c.of_drive { &of_motion } else { &force };
            let signed: Vec<f64> = force.iter().zip(&c.sign).map(|(f, s)| f * s).collect();
            (c.name, c.unit, cross_validated(&c.value, &signed, c.bins), curve(&c.value, &signed, c.bins.min(48)))
        })
        .collect();
    rows.push(("frequency", "rad/s", periodic_share(data, screen, &force), Vec::new()));
    rows
}

/// The maps of two models side by side, in the order of the first model's R².
pub fn rows(data: &Data, before: &Screen<'_>, after: &Screen<'_>, units: &crate::recording::Units) -> Vec<WhereRow> {
    let mut rows: Vec<WhereRow> = map(data, before)
        .into_iter()
        .zip(map(data, after))
        .map(|((coordinate, unit, r2, curve), (_, _, r2_after, curve_after))| WhereRow {
            coordinate,
            unit: crate::model::catalogue::unit(unit, units),
            r2,
            r2_after,
            curve,
            curve_after,
        })
        .collect();
    rows.sort_by(|a, b| b.r2.total_cmp(&a.r2));
    rows
}

/// Index of the bin of every value. All bins hold as many values.
fn bin(values: &[f64], bins: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut index = vec![0; values.len()];
    for (rank, i) in order.into_iter().enumerate() {
        index[i] = rank * bins / values.len();
    }
    index
}

/// Share of the force that averages over bins of the coordinate explain, 0..1. The averages come from other blocks.
fn cross_validated(values: &[f64], force: &[f64], bins: usize) -> f64 {
    let n = force.len();
    if n < 4 * FOLDS {
        return 0.0;
    }
    let index = bin(values, bins.min(n / 8).max(2));
    let bins = index.iter().max().map_or(1, |m| m + 1);
    let (mut left, mut total) = (0.0, 0.0);
    for fold in 0..FOLDS {
        let block = fold * n / FOLDS..(fold + 1) * n / FOLDS;
        let (mut sum, mut count) = (vec![0.0; bins], vec![0.0; bins]);
        let (mut all, mut of) = (0.0, 0.0);
        for i in (0..n).filter(|i| !block.contains(i)) {
            sum[index[i]] += force[i];
            count[index[i]] += 1.0;
            all += force[i];
            of += 1.0;
        }
        let mean = all / f64::max(of, 1.0);
        for i in block {
            // The average of a bin with few samples is drawn towards the mean.
            let average = (sum[index[i]] + 4.0 * mean) / (count[index[i]] + 4.0);
            left += (force[i] - average).powi(2);
            total += force[i].powi(2);
        }
    }
    (1.0 - left / total.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

fn curve(values: &[f64], force: &[f64], bins: usize) -> Vec<[f64; 3]> {
    if force.is_empty() {
        return Vec::new();
    }
    let index = bin(values, bins.min(force.len()));
    (0..=index.iter().copied().max().unwrap_or(0))
        .filter_map(|b| {
            let members: Vec<usize> = (0..force.len()).filter(|i| index[*i] == b).collect();
            let n = members.len() as f64;
            if n < 3.0 {
                return None;
            }
            let centre = members.iter().map(|i| values[*i]).sum::<f64>() / n;
            let mean = members.iter().map(|i| force[*i]).sum::<f64>() / n;
            let variance = members.iter().map(|i| (force[*i] - mean).powi(2)).sum::<f64>() / (n - 1.0);
            // Windows overlap fourfold.
            Some([centre, mean, (4.0 * variance / n).sqrt()])
        })
        .collect()
}

/// Share of the residual force in its strongest line over session time.
fn periodic_share(data: &Data, screen: &Screen<'_>, force: &[f64]) -> f64 {
    let total: f64 = force.iter().zip(screen.windows()).map(|(f, w)| (w.scale * f).powi(2)).sum();
    spectrum::strongest_share(&data.tracks, screen.windows(), force, Over::Time, total)
}

#[cfg(test)]
mod tests;
