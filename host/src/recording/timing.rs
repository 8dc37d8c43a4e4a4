//! The clock of a recording: jitter, gaps, pieces.

use std::ops::Range;

use super::Recording;

/// An interval longer than this many times the median is a gap: samples are missing there.
pub const GAP_FACTOR: f64 = 5.0;

/// A recording whose intervals all lie within this fraction of the median is evenly sampled.
pub const EVEN_WITHIN: f64 = 0.01;

/// Intervals between samples, gaps left out, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Median interval, s.
    pub median_s: f64,
    /// Mean interval, s.
    pub mean_s: f64,
    /// Shortest interval, s.
    pub min_s: f64,
    /// Longest interval that is no gap, s.
    pub max_s: f64,
    /// Number of gaps.
    pub gaps: usize,
    /// All intervals within [`EVEN_WITHIN`] of the median, and no gap.
    pub even: bool,
}

/// Median of some numbers; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Median of the intervals; 0 for fewer than two times.
pub(super) fn median_interval(t: &[f64]) -> f64 {
    median(t.windows(2).map(|w| w[1] - w[0]).collect())
}

/// Rows at which a new piece begins: after an interval longer than [`GAP_FACTOR`] medians, and where `known` says so. Increasing.
pub(super) fn gaps(t: &[f64], known: &[usize]) -> Vec<usize> {
    let limit = GAP_FACTOR * median_interval(t);
    let long = t.windows(2).enumerate().filter(|(_, w)| w[1] - w[0] > limit);
    let mut all: Vec<usize> = long.map(|(k, _)| k + 1).collect();
    all.extend(known.iter().filter(|&&k| k > 0 && k < t.len()));
    all.sort_unstable();
    all.dedup();
    all
}

/// Index ranges between `gaps`, those of at least two samples.
pub(super) fn pieces(samples: usize, gaps: &[usize]) -> Vec<Range<usize>> {
    let starts = std::iter::once(0).chain(gaps.iter().copied());
    let ends = gaps.iter().copied().chain(std::iter::once(samples));
    starts.zip(ends).map(|(start, end)| start..end.min(samples)).filter(|piece| piece.len() >= 2).collect()
}

impl Recording {
    /// Jitter statistics. All zero for fewer than two samples, or when nothing lies between gaps.
    pub fn timing(&self) -> Timing {
        let median_s = median_interval(&self.t);
        let (mut min_s, mut max_s, mut sum, mut count) = (f64::INFINITY, 0.0_f64, 0.0, 0_usize);
        for piece in self.pieces() {
            for w in self.t.get(piece).unwrap_or_default().windows(2) {
                let interval = w[1] - w[0];
                min_s = min_s.min(interval);
                max_s = max_s.max(interval);
                sum += interval;
                count += 1;
            }
        }
        if count == 0 {
            min_s = 0.0;
        }
        let within = EVEN_WITHIN * median_s;
        Timing {
            median_s,
            mean_s: sum / count.max(1) as f64,
            min_s,
            max_s,
            gaps: self.gaps.len(),
            even: count > 0 && self.gaps.is_empty() && max_s - median_s <= within && median_s - min_s <= within,
        }
    }

    /// The sampling interval in s, if every interval lies within 1 % of the median and there is no gap.
    ///
    /// It is the mean interval, which rounding of the printed times does not bias.
    pub fn evenly_sampled(&self) -> Option<f64> {
        let timing = self.timing();
        timing.even.then_some(timing.mean_s)
    }

    /// Index ranges of the pieces between gaps, each of at least two samples.
    pub fn pieces(&self) -> Vec<Range<usize>> {
        pieces(self.t.len(), &self.gaps)
    }

    /// The pieces between gaps as recordings of their own, on the same time axis.
    ///
    /// Pieces of a single sample are left out. The drive of a piece's last sample acts into the gap and is not observed.
    pub fn segments(&self) -> Vec<Recording> {
        let pieces = self.pieces();
        let several = pieces.len() > 1;
        let cut = |column: &[f64], piece: &Range<usize>| column.get(piece.clone()).unwrap_or_default().to_vec();
        pieces
            .iter()
            .enumerate()
            .map(|(k, piece)| Recording {
                name: if several { format!("{} part {}", self.name, k + 1) } else { self.name.clone() },
                t: cut(&self.t, piece),
                u: cut(&self.u, piece),
                x: cut(&self.x, piece),
                current: cut(&self.current, piece),
                encoder_step: self.encoder_step,
                read_every_s: self.read_every_s,
                seen_every_s: self.seen_every_s,
                units: self.units.clone(),
                counts_per_turn: self.counts_per_turn,
                meta: self.meta.clone(),
                gaps: Vec::new(),
                found: Vec::new(),
            })
            .collect()
    }
}
