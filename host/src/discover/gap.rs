//! The error of a model on data that it was not fitted to, and whether an effect holds there.

use rayon::prelude::*;

use super::data::{Data, FIT_SEGMENT_S};
use crate::fit::{Fit, SCORE_ITERATIONS, Segment};

/// Held-out simulation error, over the sensor's noise, up to which nothing but that noise is left.
pub(super) const AT_THE_NOISE: f64 = 1.1;
/// The same ratio, above which the forces tell more of what is left than the motion. Nearer to the noise the motion tells
/// effects that act in few samples, as a drive that is clipped now and then.
pub(super) const FAR: f64 = 10.0;
/// The gap, the mean of ln((σ² + mse)/2σ²) over held-out segments, below which it is within the noise.
const GAP_NOISE: f64 = 0.06;
/// Share of held-out segments that may stay above twice the noise's mean square in an explained record.
const LEFT_OVER: f64 = 0.05;
/// Mean square of the median segment over the noise's. Below it, what is left lies in a few segments.
const OUTLIERS: f64 = 1.15;
/// The gap above which something is left. It is three standard deviations of the gap over 50 segments of 400 samples of
/// noise.
pub(super) const LEFT: f64 = 0.015;
/// Share of a gap that may stay where a further effect closes it. The gap lies in a few segments.
const CLOSED: f64 = 0.5;
/// Least share of the mean square gap that an effect must explain to be named. One that explains half of the
/// logarithmic gap may explain less.
pub(super) const LEAST_SHARE: f64 = 0.25;
/// The same for all effects together, see [`LEAST_SHARE`].
pub(super) const LEAST_TOTAL: f64 = 0.5;
/// Growth of the open-loop mean square error on held-out data above which an effect is not believed.
const OPEN_LOOP_GROWTH: f64 = 1.5;

/// Share of the open-loop mean square above the noise's that a second body may leave.
const BODY_LEAVES: f64 = 0.5;
/// Open-loop mean square over the noise's that the base's own drift adds within a second. A second body that leaves
/// less counts as followed. The drift grows with the square of the time.
const OWN_DRIFT: f64 = 1.0;

/// The errors of a model on the held-out data.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    mean_log: f64,
    /// Root mean square error.
    rmse: f64,
    /// Mean square error beyond the noise's, without the worst tenth of the segments.
    excess: f64,
    /// Mean square of the median segment over the noise's.
    median: f64,
    /// Share of segments above twice the noise's mean square.
    above: f64,
    /// Mean square error of the open-loop windows over the noise's.
    open_loop: f64,
    /// Length of the windows over [`OPEN_LOOP_S`](super::data::OPEN_LOOP_S).
    ahead: f64,
}

impl Gap {
    pub(super) fn of(data: &Data, fit: &Fit) -> Self {
        let floor = data.sigma * data.sigma;
        let mse = data.over(&data.score).score(&fit.candidate);
        let n = mse.len() as f64;
        // A few segments diverge, after an impact or a missed stick. The worst tenth is cut, so that they do not set
        // the mean.
        let trimmed = |sorted: &[f64]| {
            let kept = &sorted[..(sorted.len() * 9).div_ceil(10)];
            kept.iter().sum::<f64>() / kept.len().max(1) as f64
        };
        let mut sorted = mse.clone();
        sorted.sort_by(f64::total_cmp);
        let mut open: Vec<f64> =
            open_loop_squares(data, &data.ahead, fit).iter().map(|(square, n)| square / *n as f64).collect();
        open.sort_by(f64::total_cmp);
        Self {
            open_loop: trimmed(&open) / floor,
            ahead: data.segment_s / FIT_SEGMENT_S,
            rmse: root_mean(&mse),
            median: sorted[sorted.len() / 2] / floor,
            mean_log: mean_log(&mse, data.sigma),
            excess: (trimmed(&sorted) - floor).max(1e-3 * floor),
            above: mse.iter().filter(|m| **m > 2.0 * floor).count() as f64 / n,
        }
    }
    /// Why a model with the gap `after` is no progress on held-out data; `None` if it is.
    pub(super) fn refuses(&self, after: &Self) -> Option<String> {
        if !after.below(self) || after.excess > 1.05 * self.excess || after.rmse > 1.5 * self.rmse {
            return Some("fits, but does not hold on held-out data".to_owned());
        }
        // Starts that are fitted in every segment can hide an error that grows within a second.
        if after.open_loop > OPEN_LOOP_GROWTH * self.open_loop {
            return Some("fits short segments, but drifts off in open loop".to_owned());
        }
        self.leaves(after, LEAST_SHARE)
            .then(|| format!("would explain only {:.0} % of the mean square gap", 100.0 * self.share(after)))
    }
    /// Whether this gap is smaller than `other`, by the mean logarithm over segments.
    pub(super) fn below(&self, other: &Self) -> bool {
        self.mean_log < other.mean_log
    }
    /// Share of the mean square gap that the model with the gap `after` explains.
    pub(super) fn share(&self, after: &Self) -> f64 {
        1.0 - after.excess / self.excess
    }
    /// Whether it explains less than `least` of the mean square gap, and less than half of the logarithmic one.
    pub(super) fn leaves(&self, after: &Self, least: f64) -> bool {
        self.share(after) < least && after.mean_log > 0.5 * self.mean_log
    }
    /// Whether the root mean square error, with all its worst segments, is lower than that of `other`.
    pub(super) fn shrinks(&self, other: &Self) -> bool {
        self.rmse < other.rmse
    }
    pub(super) fn real(&self) -> bool {
        self.mean_log > GAP_NOISE && self.above > LEFT_OVER
    }
    /// Whether the typical segment is down to the noise: what is left lies in a few.
    pub(super) fn only_outliers(&self) -> bool {
        self.median < OUTLIERS
    }
    /// Whether the model with the gap `after`, which has one second body more, follows the motion. The body's start is
    /// free in every segment, so it can follow a disturbance that no body causes. In open loop it gains nothing by
    /// that. On the blind tests' calibration cases a true body leaves at most a quarter of what is above the noise
    /// there. A false one leaves more than .55. Where hardly anything is above the noise, the base's own drift is left,
    /// and the model passes.
    pub(super) fn followed_by_bodies(&self, after: &Self) -> bool {
        after.drifts_as_the_base() || after.open_loop - 1.0 < BODY_LEAVES * (self.open_loop - 1.0)
    }
    /// Whether it is worth looking for a further effect.
    pub(super) fn something_left(&self) -> bool {
        !self.only_outliers() || self.mean_log > LEFT
    }
    /// Whether the model with the gap `after` brings what is left down to the noise. Any flexible effect makes a few
    /// outliers fewer. Only the missing effect closes them on data that were not fitted.
    pub(super) fn closed_by(&self, after: &Self) -> bool {
        after.explained() && after.mean_log < CLOSED * self.mean_log
    }
    /// Whether a model with second bodies explains `self`, the base's gap. Their starts are free in every segment, so
    /// they can follow a disturbance that no body causes. So the base must have a gap on held-out data, and it must
    /// close in open loop.
    pub(super) fn explained_by_bodies(&self, after: &Self) -> bool {
        after.explained() && self.real() && after.drifts_as_the_base()
    }
    /// Whether at most the base's own drift is above the noise in open loop.
    fn drifts_as_the_base(&self) -> bool {
        self.open_loop - 1.0 < OWN_DRIFT * self.ahead * self.ahead
    }
    pub(super) fn explained(&self) -> bool {
        self.mean_log < GAP_NOISE && self.above <= LEFT_OVER
    }
}

/// Mean of ln((σ² + mse)/2σ²) over the segments: 0 at the noise.
pub(super) fn mean_log(mse: &[f64], sigma: f64) -> f64 {
    let floor = sigma * sigma;
    mse.iter().map(|m| ((floor + m) / (2.0 * floor)).ln()).sum::<f64>() / mse.len().max(1) as f64
}

/// Sum of squares and number of samples of each of the `windows`. A window's start is fitted over its first segment
/// length. The simulation goes on from there without the measurement.
pub(super) fn open_loop_squares(data: &Data, windows: &[Segment], fit: &Fit) -> Vec<(f64, usize)> {
    let starts: Vec<Segment> = windows.iter().map(|window| beginning(data, *window)).collect();
    let open = data.over(windows);
    let windows = windows.par_iter().zip(&starts).with_max_len(1);
    windows
        .map(|(window, start)| {
            let one = data.over(std::slice::from_ref(start));
            let track = &data.tracks[window.track];
            let initial = one
                .fit(&fit.candidate, &[], None, SCORE_ITERATIONS)
                .map_or_else(|_| one.smoothed_initial(&fit.candidate)[0], |fitted| fitted.initial[0]);
            let simulated = open.positions(&fit.candidate, *window, initial);
            let samples = simulated.iter().zip(window.start..);
            (samples.map(|(x, k)| (track.weight(k) * (x - track.x[k])).powi(2)).sum(), window.len)
        })
        .collect()
}

/// The part of a window to which its start is fitted.
fn beginning(data: &Data, window: Segment) -> Segment {
    let len = (data.segment_s / data.tracks[window.track].ts).round() as usize;
    Segment { len: len.clamp(2, window.len), ..window }
}

pub(super) fn root_mean(mse: &[f64]) -> f64 {
    (mse.iter().sum::<f64>() / mse.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests;
