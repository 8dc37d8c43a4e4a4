//! A recording prepared for estimation: smoothed motion, noise floor, session time.

use crate::recording::Recording;

/// Half-width of the local cubic, s (docs/theory.md, section 5); at least [`MIN_HALF_SAMPLES`] samples.
pub(super) const HALF_WIDTH_S: f64 = 0.010;
const MIN_HALF_SAMPLES: usize = 4;

/// Largest difference of an interval from a whole number of median ones, as a share of the median. A clock with a larger one
/// is not believed: its other stamps may be wrong too.
const IRREGULAR: f64 = 0.3;
/// Interval over which the typical acceleration is taken, s: long enough that the noise does not count.
const ACCELERATION_S: f64 = 0.1;
/// Share of the largest position below which residuals are the rounding of numbers.
const ROUNDING: f64 = 1e-10;
/// Classes of speed in which a jittered clock's noise is looked at.
const SPEED_CLASSES: usize = 24;

/// A recording with smoothed position, velocity and acceleration. The smoothed ones serve as starting values and for
/// the screen; fits use the measured position.
#[derive(Clone, Debug)]
pub struct Track {
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
    /// Standard deviation of the position's noise, quantisation included; with a jittered clock, at rest.
    pub sigma: f64,
    /// Standard deviation of the instants of sampling about the clock's, s, as far as the position shows it; 0 with a
    /// regular clock.
    pub jitter_s: f64,
}

/// Standard deviation of the position's noise from the residuals of the local cubic: the median over blocks in motion of
/// their mean square, so that reversals, switching edges and quantised rest do not count.
fn noise(residuals: &[f64], velocity: &[f64], half: usize) -> f64 {
    let points = (2 * half + 1) as f64;
    // Share of a sample's own noise that the cubic follows at its centre.
    let leverage = (2.25 / points).min(0.9);
    let typical = median(velocity.iter().map(|v| v.abs()).collect());
    let blocks = residuals.chunks(64).zip(velocity.chunks(64)).filter(|(r, _)| r.len() == 64);
    let mean_square = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>() / r.len() as f64;
    let moving: Vec<f64> = blocks
        .clone()
        .filter(|(_, v)| v.iter().map(|v| v.abs()).sum::<f64>() / 64.0 >= 0.5 * typical)
        .map(|(r, _)| mean_square(r))
        .collect();
    let squares = if moving.len() >= 8 { moving } else { vec![mean_square(residuals)] };
    (median(squares) / (1.0 - leverage)).sqrt()
}

/// Noise at rest and jitter of the clock from the residuals of the local cubic, as σ² + (jitter·v)² over classes of speed;
/// `None` where the residuals do not grow with speed.
fn jitter(residuals: &[f64], velocity: &[f64], half: usize) -> Option<(f64, f64)> {
    let leverage = (2.25 / (2 * half + 1) as f64).min(0.9);
    let mut order: Vec<usize> = (0..residuals.len()).collect();
    order.sort_by(|a, b| velocity[*a].abs().total_cmp(&velocity[*b].abs()));
    // (mean square speed, variance) of every class; the median, so that reversals do not count.
    let classes: Vec<(f64, f64)> = order
        .chunks(residuals.len().div_ceil(SPEED_CLASSES).max(8))
        .map(|class| {
            let speed = class.iter().map(|k| velocity[*k].powi(2)).sum::<f64>() / class.len() as f64;
            let deviation = median(class.iter().map(|k| residuals[*k].abs()).collect()) / 0.6745;
            (speed, deviation * deviation / (1.0 - leverage))
        })
        .collect();
    let fast = &classes[classes.len() / 2..];
    let square = median(fast.iter().filter(|c| c.0 > 0.0).map(|(speed, variance)| variance / speed).collect());
    let rest = classes
        .iter()
        .map(|(speed, variance)| (variance - square * speed).max(0.1 * variance))
        .fold(f64::INFINITY, f64::min);
    let fastest = classes.last()?.0;
    (rest > 0.0 && square * fastest > rest).then(|| (rest.sqrt(), square.sqrt()))
}

/// Root of the mean square; 0 of nothing.
pub(super) fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (square, n) = values.fold((0.0, 0), |(square, n), value| (square + value * value, n + 1));
    (square / f64::from(n.max(1))).sqrt()
}

/// Median of a set of numbers; 0 if there are none.
pub fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

impl Track {
    /// Prepares one recording; gaps (more than five median intervals) cut it into pieces.
    pub fn new(recording: &Recording) -> Self {
        let n = recording.t.len();
        let intervals: Vec<f64> = recording.t.windows(2).map(|w| w[1] - w[0]).collect();
        let ts = median(intervals.clone());
        let mut pieces = vec![0];
        pieces.extend(intervals.iter().enumerate().filter(|(_, dt)| **dt > 5.0 * ts).map(|(k, _)| k + 1));
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
        let least = recording.encoder_step.unwrap_or(0.0) * 0.05;
        track.sigma = noise(&residuals, &track.vs, half).max(least);
        // Where rows are lost, a regular clock has gone on by whole intervals.
        let regular = intervals.iter().all(|dt| (dt / ts - (dt / ts).round().max(1.0)).abs() < IRREGULAR);
        if let Some((sigma, jitter_s)) = (!regular).then(|| jitter(&residuals, &track.vs, half)).flatten()
            && sigma > ROUNDING * track.x.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
        {
            track.sigma = sigma.max(least);
            track.jitter_s = jitter_s;
        }
        track
    }

    /// Noise at rest over the noise at sample `k`, at most 1: at speed v a jittered clock adds jitter·v to the position's.
    pub fn weight(&self, k: usize) -> f64 {
        if self.jitter_s > 0.0 { self.sigma / self.sigma.hypot(self.jitter_s * self.vs[k]) } else { 1.0 }
    }

    /// Local least squares around every sample of `from..to`.
    fn smooth(&mut self, from: usize, to: usize, half: usize, residuals: &mut [f64]) {
        if to - from < 5 {
            return;
        }
        let scale = half as f64 * self.ts;
        let uniform = (from + 1..to).all(|k| ((self.t[k] - self.t[k - 1]) / self.ts - 1.0).abs() < 0.01);
        let interior =
            uniform.then(|| kernels(&(0..=2 * half).map(|i| i as f64 / half as f64 - 1.0).collect::<Vec<_>>(), true));
        #[allow(clippy::needless_range_loop, reason = "k is the centre of a window into several columns")]
        for k in from..to {
            // At the ends as many samples on one side, and a parabola: a cubic's slope there is mostly noise.
            let first = k.saturating_sub(half).min((to - 1).saturating_sub(2 * half)).max(from);
            let last = (first + 2 * half).min(to - 1);
            let centred = k - first == half && last - k == half;
            let own;
            let weights = match &interior {
                Some(weights) if centred => weights,
                _ => {
                    let s: Vec<f64> = (first..=last).map(|i| (self.t[i] - self.t[k]) / scale).collect();
                    own = kernels(&s, centred);
                    &own
                }
            };
            let centre = self.x[k];
            let mut fit = [0.0; 3];
            for (i, weight) in (first..=last).zip(weights) {
                let y = self.x[i] - centre;
                fit[0] += weight[0] * y;
                fit[1] += weight[1] * y;
                fit[2] += weight[2] * y;
            }
            self.xs[k] = centre + fit[0];
            self.vs[k] = fit[1] / scale;
            self.acceleration[k] = 2.0 * fit[2] / (scale * scale);
            residuals[k] = fit[0];
        }
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

/// Least-squares weights of value, slope and curvature at s = 0 for a cubic, or else a parabola, on the abscissae `s`.
fn kernels(s: &[f64], cubic: bool) -> Vec<[f64; 3]> {
    let row = |si: f64| nalgebra::Vector4::new(1.0, si, si * si, if cubic { si * si * si } else { 0.0 });
    let mut gram = nalgebra::Matrix4::<f64>::zeros();
    for &si in s {
        gram += row(si) * row(si).transpose();
    }
    if !cubic {
        gram[(3, 3)] = 1.0;
    }
    let Some(inverse) = gram.try_inverse() else {
        return vec![[1.0 / s.len() as f64, 0.0, 0.0]; s.len()];
    };
    s.iter()
        .map(|&si| {
            let weights = inverse * row(si);
            [weights[0], weights[1], weights[2]]
        })
        .collect()
}

/// Prepares several recordings on one session clock: those that share a running time axis keep it; where a
/// recording's clock starts before the previous one's end, it is taken to follow it.
pub fn session<'a>(recordings: impl IntoIterator<Item = &'a Recording>) -> Vec<Track> {
    let mut end = f64::NEG_INFINITY;
    recordings
        .into_iter()
        .map(|recording| {
            let mut track = Track::new(recording);
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

#[cfg(test)]
mod tests;
