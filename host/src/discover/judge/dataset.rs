//! Recordings on an even clock. Each row must have a position of its own. The position is that of the clock's instant;
//! the drive is its mean over the interval about the instant.
//!
//! On an even clock the mean of the held drive over half an interval to either side is (u_k + u_{k−1})/2. Without it
//! the hold of the drive looks like half a sample of delay.

use std::ops::Range;
use std::sync::OnceLock;

use super::settings::Settings;
use crate::recording::between::{Integral, position};
use crate::recording::{Recording, share_a_clock};

/// A stretch of a recording without a gap, on an even clock.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Which recording.
    pub recording: usize,
    /// Interval, s.
    pub h_s: f64,
    /// Session time, s.
    pub t: Vec<f64>,
    /// Position, position units.
    pub x: Vec<f64>,
    /// Mean drive about the instant, drive units.
    pub u: Vec<f64>,
    /// Standard deviation of the position's noise, position units.
    pub sigma: f64,
}

/// All recordings that are judged together.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// Pieces in the order of the recordings.
    pub pieces: Vec<Piece>,
    /// Recordings.
    pub recordings: usize,
    /// Whether time runs on from each recording to the next. Only then can effects of session time be tried.
    pub shared_clock: bool,
    /// Longest delay that a sensor's own clock explains, s (see [`Recording::unsure_s`]).
    pub unsure_s: f64,
    /// See [`Self::fundamentals`]; found at the first call.
    fundamentals: OnceLock<Vec<Option<(f64, f64)>>>,
}

/// A gap that ends a piece is longer than both of these: seconds, and intervals of the clock.
const GAP_S: f64 = 0.05;
const GAP_INTERVALS: f64 = 12.0;

impl Dataset {
    /// Puts recordings on even clocks. Of more than [`Settings::most_samples`] it takes stretches, evenly over all recordings.
    pub fn new(recordings: &[Recording], settings: &Settings) -> Self {
        let shared_clock = share_a_clock(recordings);
        let pieces: Vec<Piece> = recordings.iter().enumerate().flat_map(|(i, r)| pieces_of(i, r, settings)).collect();
        let pieces = stretches(&pieces, settings.most_samples).unwrap_or(pieces);
        let unsure_s = recordings.iter().map(Recording::unsure_s).fold(0.0, f64::max);
        let fundamentals = OnceLock::new();
        Self { pieces, recordings: recordings.len(), shared_clock, unsure_s, fundamentals }
    }
}

impl Dataset {
    /// Least stroke of a bristle whose force the measured motion tells, position units: six deviations of its noise.
    pub fn least_stroke(&self) -> f64 {
        6.0 * self.pieces.iter().map(|piece| piece.sigma).fold(0.0, f64::max)
    }

    /// Session time of the first sample, s.
    pub fn first_s(&self) -> f64 {
        self.pieces.iter().filter_map(|piece| piece.t.first()).copied().fold(f64::INFINITY, f64::min)
    }

    /// Angular frequency at which the drive of each piece repeats, rad/s, and the number of its periods; `None` where it
    /// does not repeat.
    pub(super) fn fundamentals(&self) -> &[Option<(f64, f64)>] {
        self.fundamentals.get_or_init(|| self.pieces.iter().map(Piece::fundamental).collect())
    }

    /// Share of the samples in which an angular frequency, rad/s, cannot be told from a harmonic of the drive.
    pub fn harmonic_of_the_drive(&self, omega: f64) -> f64 {
        let is_harmonic = |(fundamental, cycles): (f64, f64)| {
            let order = omega / fundamental;
            (order - order.round()).abs() < 1.5 / cycles && order.round() >= 1.0
        };
        let samples = |piece: &Piece| piece.x.len() as f64;
        let pieces = self.pieces.iter().zip(self.fundamentals());
        let harmonic = pieces.filter(|(_, own)| own.is_some_and(is_harmonic)).map(|(piece, _)| samples(piece));
        harmonic.sum::<f64>() / self.pieces.iter().map(samples).sum::<f64>().max(1.0)
    }
}

impl Piece {
    /// The samples of a range.
    fn part(&self, range: Range<usize>) -> Self {
        let [t, x, u] = [&self.t, &self.x, &self.u].map(|own| own[range.clone()].to_vec());
        Self { t, x, u, ..*self }
    }

    /// Angular frequency at which the drive repeats, rad/s, and the number of its periods; `None` where it does not
    /// repeat.
    fn fundamental(&self) -> Option<(f64, f64)> {
        // A few thousand samples are enough to find a period of a tenth of them.
        let thin = (self.u.len() / 3000).max(1);
        let u: Vec<f64> = self.u.iter().step_by(thin).copied().collect();
        let n = u.len();
        let mean = u.iter().sum::<f64>() / n.max(1) as f64;
        let product = |lag: usize| -> f64 {
            let pairs = u.iter().zip(&u[lag..]);
            let (mut cross, mut a, mut b) = (0.0, 0.0, 0.0);
            for (x, y) in pairs {
                cross += (x - mean) * (y - mean);
                a += (x - mean).powi(2);
                b += (y - mean).powi(2);
            }
            cross / (a * b).sqrt().max(f64::MIN_POSITIVE)
        };
        let mut fell = false;
        let mut best: Option<(usize, f64)> = None;
        for lag in 2..n / 3 {
            let own = product(lag);
            fell |= own < 0.5;
            if fell && own > REPEATS && best.is_none_or(|(_, most)| own > most) {
                best = Some((lag, own));
            } else if best.is_some() && own < 0.5 {
                break;
            }
        }
        let (lag, _) = best?;
        let period_s = (lag * thin) as f64 * self.h_s;
        // The last multiple of the period within the piece gives the period best.
        let most = n / lag - 1;
        let around = (lag * most).saturating_sub(most.min(lag / 4))..=(lag * most + most.min(lag / 4)).min(n - 2);
        let at = around.max_by(|a, b| product(*a).total_cmp(&product(*b)));
        let refined = at.filter(|_| most >= 2).map_or(period_s, |at| (at * thin) as f64 * self.h_s / most as f64);
        Some((std::f64::consts::TAU / refined, n as f64 / lag as f64))
    }
}

/// Least correlation of the drive with itself a period later at which it counts as periodic.
const REPEATS: f64 = 0.9;

/// Stretches that are taken of recordings with too many samples, at the least. Each instant at which an inertia may step
/// then has its own.
const STRETCHES: usize = 24;
/// Fewest samples of a stretch: 1 s at 2 kHz, which is four blocks.
const LEAST_STRETCH: usize = 2000;
/// Fewest samples of a piece, as [`Rows::even`] has them.
const LEAST_PIECE: usize = 9;

/// The stretches of `pieces` that are judged, where they hold more than `most` samples; `None` where they do not. All pieces
/// make one row of samples, which is cut into equal parts. The middle of each part is taken, as pieces of their own.
fn stretches(pieces: &[Piece], most: usize) -> Option<Vec<Piece>> {
    let total: usize = pieces.iter().map(|piece| piece.x.len()).sum();
    let count = pieces.len().max(STRETCHES).min(most / LEAST_STRETCH).max(1);
    let length = most / count;
    let first = |i: usize| (2 * i + 1) * total / (2 * count) - length / 2;
    let mut end = 0;
    let of_piece = |piece: &Piece| -> Vec<Piece> {
        let start = end;
        end += piece.x.len();
        let within = |at: usize| at.clamp(start, end) - start;
        let ranges = (0..count).map(|i| within(first(i))..within(first(i) + length));
        ranges.filter(|range| range.len() >= LEAST_PIECE).map(|range| piece.part(range)).collect()
    };
    (total > most).then(|| pieces.iter().flat_map(of_piece).collect())
}

fn pieces_of(index: usize, recording: &Recording, settings: &Settings) -> Vec<Piece> {
    let mut intervals: Vec<f64> = recording.t.windows(2).map(|w| w[1] - w[0]).collect();
    if intervals.is_empty() {
        return Vec::new();
    }
    let tick = {
        let middle = intervals.len() / 2;
        *intervals.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let mut bounds = vec![0];
    let longest = GAP_S.max(GAP_INTERVALS * tick);
    bounds.extend((1..recording.t.len()).filter(|k| recording.t[*k] - recording.t[k - 1] > longest));
    bounds.extend(recording.gaps.iter().copied().filter(|k| (1..recording.t.len()).contains(k)));
    bounds.push(recording.t.len());
    bounds.sort_unstable();
    bounds.dedup();
    let average = (settings.least_interval_s / tick).ceil().max(1.0) as usize;
    let each = |range: Range<usize>| {
        let rows = Rows { t: &recording.t[range.clone()], u: &recording.u[range.clone()], x: &recording.x[range] };
        rows.even(tick, average).map(|(t, x, u)| Piece {
            recording: index,
            h_s: tick * average as f64,
            t,
            x,
            u,
            sigma: 0.0,
        })
    };
    let mut pieces: Vec<Piece> = bounds.windows(2).filter_map(|w| each(w[0]..w[1])).collect();
    let quantised = recording.encoder_step.unwrap_or(0.0) / (12.0 * average as f64).sqrt();
    let sigma = noise(&pieces).max(quantised).max(f64::MIN_POSITIVE);
    for piece in &mut pieces {
        piece.sigma = sigma;
    }
    pieces
}

/// Rows of a piece as they were recorded.
struct Rows<'a> {
    t: &'a [f64],
    u: &'a [f64],
    x: &'a [f64],
}

impl Rows<'_> {
    /// Time, position and mean drive on an even clock; `None` where the piece holds fewer than eight intervals.
    fn even(&self, tick: f64, average: usize) -> Option<(Vec<f64>, Vec<f64>, Vec<f64>)> {
        let h = tick * average as f64;
        let (first, last) = (*self.t.first()?, *self.t.last()?);
        let count = ((last - first) / h - if average > 1 { 1.0 } else { 0.0 }).floor();
        if !(count >= 8.0 && count.is_finite()) {
            return None;
        }
        let offset = if average > 1 { 0.5 * h } else { 0.0 };
        let t: Vec<f64> = (0..=count as usize).map(|i| first + offset + i as f64 * h).collect();
        // Divided by the interval itself: the two instants are not exactly that far from each other.
        let drive = Integral::new(self.t, |k| self.u[k]);
        let u = t.iter().map(|t| drive.over(t - 0.5 * h, t + 0.5 * h) / h).collect();
        let x = if average > 1 {
            let line = |k: usize| 0.5 * (self.x[k] + self.x[(k + 1).min(self.x.len() - 1)]);
            let positions = Integral::new(self.t, line);
            t.iter().map(|t| positions.over(t - 0.5 * h, t + 0.5 * h) / h).collect()
        } else {
            t.iter().map(|at| position(self.t, self.x, *at)).collect()
        };
        Some((t, x, u))
    }
}

/// Standard deviation of the position's noise from its third differences, which are near zero in a smooth motion.
/// Outliers are left out.
fn noise(pieces: &[Piece]) -> f64 {
    let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
    let mut thirds: Vec<f64> = pieces.iter().flat_map(|p| p.x.windows(4).map(third)).collect();
    if thirds.is_empty() {
        return 0.0;
    }
    let middle = thirds.len() / 2;
    let median = *thirds.select_nth_unstable_by(middle, f64::total_cmp).1;
    let kept: Vec<f64> = thirds.into_iter().filter(|d| *d <= 6.0 * median).collect();
    let square = kept.iter().map(|d| d * d).sum::<f64>() / kept.len().max(1) as f64;
    // The third difference of white noise has 20 times its variance.
    (square / 20.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three recordings of 100, 50 and 250 s are 200 000 samples at 500 Hz. Of them 24 stretches of 4 s are taken, from
    /// the middles of parts of 16.7 s. A stretch over two recordings makes two pieces.
    #[test]
    fn of_too_many_samples_stretches_are_taken_evenly() {
        let lengths = [50_000, 25_000, 125_000];
        let mut from = 0;
        let recordings = lengths.map(|n| {
            let t: Vec<f64> = (from..from + n).map(|k| 2e-3 * f64::from(k)).collect();
            from += n;
            let x = t.iter().map(|t| t.sin()).collect();
            Recording { u: t.clone(), t, x, ..Recording::default() }
        });
        let settings = Settings { most_samples: 48_000, ..Settings::default() };
        let pieces = Dataset::new(&recordings, &settings).pieces;
        let of = |i: usize| pieces.iter().filter(|p| p.recording == i).map(|p| p.x.len()).sum::<usize>();
        assert_eq!([of(0), of(1), of(2)], [12_000, 6_000, 30_000]);
        let starts: Vec<f64> = pieces.iter().map(|piece| piece.t[0]).collect();
        assert!(starts.windows(2).all(|w| w[1] - w[0] < 17.0), "{starts:?}");
        assert!((starts[0] - 6.3).abs() < 0.1 && starts[pieces.len() - 1] > 380.0, "{starts:?}");
        let all = Dataset::new(&recordings, &Settings { most_samples: 200_000, ..settings }).pieces;
        assert_eq!(all.len(), 3, "the recordings as they are");
    }

    /// 10 s at 500 Hz from an instant on, driven by a sine and a tenth of a second one, both by their angular frequencies, rad/s.
    fn driven(from_s: f64, [omega, other]: [f64; 2]) -> Recording {
        let t: Vec<f64> = (0..5000).map(|k| from_s + 2e-3 * f64::from(k)).collect();
        let u = t.iter().map(|t| (omega * t).sin() + 0.1 * (other * t).sin()).collect();
        let x = t.iter().map(|t| (omega * t).cos()).collect();
        Recording { t, u, x, ..Recording::default() }
    }

    /// One recording repeats at 6 rad/s, 9.5 times: 12 and 12.5 rad/s cannot be told from its second harmonic, 15 rad/s can. The other,
    /// of the same length, repeats at 7 rad/s: 12 rad/s is none of its harmonics, 14 rad/s is.
    #[test]
    fn a_frequency_may_be_a_harmonic_of_some_recordings() {
        let recordings = [driven(0.0, [6.0, 6.0]), driven(10.0, [7.0, 7.0])];
        let dataset = Dataset::new(&recordings, &Settings::default());
        for (omega, share) in [(12.0, 0.5), (12.5, 0.5), (15.0, 0.0), (14.0, 0.5), (42.0, 1.0)] {
            assert!((dataset.harmonic_of_the_drive(omega) - share).abs() < 1e-3, "{omega} rad/s");
        }
        let alone = Dataset::new(&recordings[..1], &Settings::default());
        assert!((alone.harmonic_of_the_drive(12.0) - 1.0).abs() < 1e-9);
    }
}
