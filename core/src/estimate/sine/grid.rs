//! Global search over ω: a grid of 1/(4T) at the cost of one record of 16 cycles, whatever the record's length.
//!
//! A plain grid over 0.5..2 times the estimate takes 6 points per cycle, each a pass over all samples: too slow for
//! 10⁴ cycles. So long records are first cut into segments of at most 16 cycles. Their costs, each segment with its
//! own phase, are added on a grid of 1/(4·segment). Then segments 8 times as long are searched within ±2 cells, until
//! one segment is the record.

use super::columns::SineModel;
use super::normal::Normal;
use core::f64::consts::PI;

/// Cycles of a segment at the first level.
const SEGMENT_CYCLES: f64 = 16.0;
/// Growth of the segments from level to level.
const GROWTH: f64 = 8.0;
/// Frequencies evaluated in one pass over the samples.
const BATCH: usize = 8;

/// A bracket around the best grid point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub low: f64,
    pub best: f64,
    pub high: f64,
}

/// The best cell in `low..high` for samples `(tau, y)`, tau increasing in −1..1, frequencies in rad per unit of tau.
///
/// None if the columns are dependent at every frequency.
pub(super) fn search<const N: usize>(
    samples: &(impl Iterator<Item = (f64, f64)> + Clone),
    model: SineModel,
    low: f64,
    high: f64,
) -> Option<Cell> {
    // The record spans 2 units, hence ω/π cycles.
    let cycles = libm::sqrt(low * high) / PI;
    let mut segments = libm::ceil(cycles / SEGMENT_CYCLES).max(1.0);
    let (mut from, mut to) = (low, high);
    loop {
        // 1/(4T) hertz is 2π/(4T) rad per unit of time, with T = 2/segments.
        let spacing = 0.25 * PI * segments;
        let cells = libm::ceil((to - from) / spacing).max(2.0);
        let step = (to - from) / cells;
        let best = level::<N>(samples, model, from, step, cells as u32, segments)?;
        if segments <= 1.0 {
            return Some(Cell { low: (best - step).max(low), best, high: (best + step).min(high) });
        }
        from = (best - 2.0 * step).max(low);
        to = (best + 2.0 * step).min(high);
        segments = libm::ceil(segments / GROWTH);
    }
}

/// The frequency `from + k·step`, k = 0..=cells, that explains most.
fn level<const N: usize>(
    samples: &(impl Iterator<Item = (f64, f64)> + Clone),
    model: SineModel,
    from: f64,
    step: f64,
    cells: u32,
    segments: f64,
) -> Option<f64> {
    let mut best: Option<(f64, f64)> = None;
    for first in (0..=cells).step_by(BATCH) {
        let omega = from + step * f64::from(first);
        let explained = explain::<N>(samples, model, omega, step, segments);
        for (k, value) in (first..=cells).zip(explained) {
            if value > best.map_or(0.0, |(_, v)| v) {
                best = Some((from + step * f64::from(k), value));
            }
        }
    }
    best.map(|(omega, _)| omega)
}

/// The explained sums of squares at `omega + k·step`, k < [`BATCH`], each segment with its own linear parameters.
fn explain<const N: usize>(
    samples: &(impl Iterator<Item = (f64, f64)> + Clone),
    model: SineModel,
    omega: f64,
    step: f64,
    segments: f64,
) -> [f64; BATCH] {
    let mut totals = [0.0; BATCH];
    let mut sums = [Normal::<f64, N>::EMPTY; BATCH];
    let mut close = |sums: &mut [Normal<f64, N>; BATCH]| {
        for (total, sum) in totals.iter_mut().zip(sums.iter_mut()) {
            if let Some((_, _, explained)) = sum.solve() {
                *total += explained;
            }
            *sum = Normal::EMPTY;
        }
    };
    let mut end = 2.0 / segments - 1.0;
    for (tau, y) in samples.clone() {
        while tau > end && end < 1.0 {
            close(&mut sums);
            end += 2.0 / segments;
        }
        // The neighbouring frequencies follow by rotation; over 8 steps its rounding stays below 1e-15.
        let (mut sin, mut cos) = libm::sincos(omega * tau);
        let (turn_sin, turn_cos) = libm::sincos(step * tau);
        for sum in &mut sums {
            sum.add(&model.row(sin, cos, tau), y);
            (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
        }
    }
    close(&mut sums);
    totals
}

#[cfg(test)]
mod tests;
