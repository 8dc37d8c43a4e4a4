//! A recording prepared for estimation: its smoothed motion, its noise and its session time.

use super::noise::{jitter, noise};
use super::settings::{
    ACCELERATION_S, GAP_INTERVALS, HALF_WIDTH_S, IRREGULAR, LEAST_NOISE, MIN_HALF_SAMPLES, ROUNDING,
};
use super::statistics::{median, root_mean_square};
use crate::recording::{Recording, share_a_clock};

/// A recording with smoothed position, velocity and acceleration. These are starting values, and the motion of the
/// screen. Fits use the measured position.
#[derive(Clone, Debug)]
pub struct MeasuredMotion {
    /// The recording's name.
    pub name: String,
    /// Session time, s, strictly increasing.
    pub t: Vec<f64>,
    /// Applied drive, held from sample to sample.
    pub u: Vec<f64>,
    /// Largest size of the drive.
    pub largest_drive: f64,
    /// Root mean square of the smoothed velocity.
    pub typical_speed: f64,
    /// Root mean square of its change over 0.1 s, per second.
    pub typical_acceleration: f64,
    /// Measured position.
    pub x: Vec<f64>,
    /// Smoothed position.
    pub xs: Vec<f64>,
    /// Smoothed velocity.
    pub vs: Vec<f64>,
    /// Smoothed acceleration.
    pub acceleration: Vec<f64>,
    /// Median sample interval, s.
    pub ts: f64,
    /// First index of every piece without gaps; ends with the number of samples.
    pub pieces: Vec<usize>,
    /// Standard deviation of the position's noise, with its quantisation, position units; with a jittered clock, at
    /// rest.
    pub sigma: f64,
    /// Standard deviation of the instants of sampling about the clock's, s, as far as the position shows it. It is 0
    /// with a regular clock.
    pub jitter_s: f64,
}

impl MeasuredMotion {
    /// Prepares one recording. A gap, longer than five median intervals, cuts it into pieces.
    pub fn new(recording: &Recording) -> Self {
        let n = recording.t.len();
        let intervals: Vec<f64> = recording.t.windows(2).map(|w| w[1] - w[0]).collect();
        let ts = median(intervals.clone());
        let mut pieces = vec![0];
        pieces.extend(intervals.iter().enumerate().filter(|(_, dt)| **dt > GAP_INTERVALS * ts).map(|(k, _)| k + 1));
        pieces.extend(recording.gaps.iter().copied().filter(|k| (1..n).contains(k)));
        pieces.push(n);
        pieces.sort_unstable();
        pieces.dedup();
        let mut track = Self {
            name: recording.name.clone(),
            t: recording.t.clone(),
            u: recording.u.clone(),
            largest_drive: recording.u.iter().fold(0.0, |most, u| u.abs().max(most)),
            typical_speed: 0.0,
            typical_acceleration: 0.0,
            x: recording.x.clone(),
            xs: recording.x.clone(),
            vs: vec![0.0; n],
            acceleration: vec![0.0; n],
            ts,
            pieces,
            sigma: 0.0,
            jitter_s: 0.0,
        };
        let half = ((HALF_WIDTH_S / ts).round() as usize).max(MIN_HALF_SAMPLES);
        let mut residuals = vec![0.0; n];
        for piece in track.pieces.clone().windows(2) {
            track.smooth(piece[0], piece[1], half, &mut residuals);
        }
        let apart = ((ACCELERATION_S / ts).round() as usize).max(1);
        let change = track
            .vs
            .iter()
            .zip(track.vs.get(apart..).unwrap_or_default())
            .map(|(from, to)| (to - from) / (apart as f64 * ts));
        track.typical_acceleration = root_mean_square(change);
        track.typical_speed = root_mean_square(track.vs.iter().copied());
        let least = recording.encoder_step.unwrap_or(0.0) * LEAST_NOISE;
        track.sigma = noise(&residuals, &track.vs, half).max(least);
        // Lost rows take whole intervals of a regular clock.
        let regular = intervals.iter().all(|dt| (dt / ts - (dt / ts).round().max(1.0)).abs() < IRREGULAR);
        if let Some((sigma, jitter_s)) = (!regular).then(|| jitter(&residuals, &track.vs, half)).flatten()
            && sigma > ROUNDING * track.x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
        {
            track.sigma = sigma.max(least);
            track.jitter_s = jitter_s;
        }
        track
    }

    /// Noise at rest over the noise at sample `k`, at most 1. At speed v a jittered clock adds jitter·v to the
    /// position's noise.
    pub fn weight(&self, k: usize) -> f64 {
        if self.jitter_s > 0.0 { self.sigma / self.sigma.hypot(self.jitter_s * self.vs[k]) } else { 1.0 }
    }

    /// Time from sample `k` to the next; the median interval at the end of a piece.
    pub fn dt(&self, k: usize) -> f64 {
        let next = k + 1;
        if next < self.t.len() && self.pieces.binary_search(&next).is_err() {
            self.t[next] - self.t[k]
        } else {
            self.ts
        }
    }
}

/// Prepares several recordings on one session clock. Recordings that share a running clock keep it. Otherwise a recording
/// whose clock starts before the previous one's end is moved to follow it.
pub fn session<'a>(recordings: impl IntoIterator<Item = &'a Recording>) -> Vec<MeasuredMotion> {
    let recordings: Vec<&Recording> = recordings.into_iter().collect();
    if share_a_clock(recordings.iter().copied()) {
        return recordings.into_iter().map(MeasuredMotion::new).collect();
    }
    let mut end = f64::NEG_INFINITY;
    recordings
        .into_iter()
        .map(|recording| {
            let mut track = MeasuredMotion::new(recording);
            let first = track.t.first().copied().unwrap_or(0.0);
            if first < end {
                let shift = end + track.ts - first;
                track.t.iter_mut().for_each(|t| *t += shift);
            }
            end = track.t.last().copied().unwrap_or(end);
            track
        })
        .collect()
}
