//! Held positions: a sensor that is refreshed less often than rows are written repeats its last value in between.
//!
//! A coarse encoder at slow speed repeats its value too, but then moves by one step, and the slower the axis the
//! later. A held sensor moves by many steps at once, and at the same interval whatever the speed. So only *refreshes
//! at speed* count. These are two successive changes the same way, of about the same size, each at least [`FAST`]
//! times the smallest change of the recording. Between them a sensor that is read for every row has no row to repeat.
//!
//! Noise that is drawn with each reading tells the refresh at any speed: it brings changes of either sign in successive readings. So
//! of a sensor that is read for every row some changes follow in the next row, and of a held one none does.

use super::Recording;
use super::timing::median;

/// Size of a change, in smallest changes, from which the axis is too fast for a value to repeat by itself. An encoder's
/// smallest change is its step; at two steps per row a value lasts half a row.
const FAST: f64 = 2.0;
/// Largest ratio of two successive changes; a change that is several times the other is not at one speed.
const SAME_SPEED: f64 = 2.0;
/// Fewest refreshes at speed that give a period.
const LEAST: usize = 16;
/// Least share of refreshes that come later than the next row: a period of 1.2 rows. A sensor that is read for every row has
/// at most some 5 %, where the axis sticks and slips within a few rows.
const LATE: f64 = 0.2;
/// Share of changes against the one before from which the position is noisy: of an encoder's step, or more. A value then
/// repeats by chance up to two steps per row, and moves by several at once.
const NOISY: f64 = 0.05;
/// Steps per row from which a noisy position repeats in less than a tenth of the rows, whatever its noise.
const FAST_IN_NOISE: f64 = 3.0;

/// Rows from which noise repeats no value by chance in nearly all changes, see [`EARLY`].
const OVER_CHANCE: usize = 2;
/// Share of the changes that may come earlier than a refresh. Then the share that comes within a row or a fifth of
/// the period from there.
const EARLY: f64 = 0.02;
/// See [`EARLY`].
const NEXT_REFRESH: f64 = 0.3;
/// Share of a period by which the intervals to the next refresh differ, from a clock that jitters.
const JITTER: f64 = 0.2;

/// Fewest different sizes of change at speed: an encoder whose step is printed with few digits has two at one speed.
const SIZES: usize = 3;
/// Sizes of change within this share are one size: 0.001 rad printed to 1e-6 rad differ by at most 0.2 %.
const ONE_SIZE: f64 = 3e-3;
/// Largest ratio of the interval in the slower half of the refreshes to that in the faster half. A value that lasts until
/// the next step lasts longer the slower the axis.
const SAME_PERIOD: f64 = 2.0;

/// How a position is held between refreshes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Interval between two refreshes while the axis moves, s.
    pub period_s: f64,
    /// The same in rows, ≥ 1.
    pub period_rows: f64,
    /// Share of the rows in motion that repeat the position of the row before, 0 to 1.
    pub repeated: f64,
    /// Number of refreshes at speed that this was read from.
    pub refreshes: usize,
}

/// An interval between two refreshes at speed.
struct Interval {
    rows: usize,
    seconds: f64,
    /// Size of the change at its end, or of the smaller one at its ends, position units.
    size: f64,
    /// Whether the change at its end is against the one at its beginning.
    against: bool,
}

impl Recording {
    /// How the position is held between refreshes of its sensor. `None` where every row has a position of its own, and
    /// where too little motion, or motion at one speed, does not tell.
    pub fn held(&self) -> Option<Held> {
        self.held_in_noise().or_else(|| self.held_at_speed())
    }

    /// The same from changes of any size, where noise comes with each reading.
    fn held_in_noise(&self) -> Option<Held> {
        let mut intervals = self.intervals_of_changes();
        if intervals.len() < LEAST {
            return None;
        }
        intervals.sort_unstable_by_key(|interval| interval.rows);
        let quantile = |share: f64| intervals[(share * (intervals.len() - 1) as f64) as usize].rows;
        let (early, next) = (quantile(EARLY), quantile(NEXT_REFRESH));
        let late = early + ((JITTER * early as f64) as usize).max(1);
        let near: Vec<&Interval> = intervals.iter().filter(|i| (early..=late).contains(&i.rows)).collect();
        // An axis that turns back is slow: its change against the one before comes late.
        let noise = near.iter().filter(|interval| interval.against).count();
        if early < OVER_CHANCE || next > late || noise < LEAST {
            return None;
        }
        let mean = |of: fn(&Interval) -> f64| near.iter().map(|i| of(i)).sum::<f64>() / near.len() as f64;
        let period_rows = mean(|interval| interval.rows as f64);
        let repeated = 1.0 - 1.0 / period_rows;
        Some(Held { period_s: mean(|i| i.seconds), period_rows, repeated, refreshes: near.len() })
    }

    /// The same from changes at speed.
    fn held_at_speed(&self) -> Option<Held> {
        let mut intervals = self.intervals_at_speed();
        let count = intervals.len();
        let late = intervals.iter().filter(|interval| interval.rows > 1).count();
        if count < LEAST || (late as f64) < LATE * count as f64 {
            return None;
        }
        intervals.sort_unstable_by(|a, b| a.size.total_cmp(&b.size));
        let (slow, fast) = intervals.split_at(count / 2);
        if sizes(&intervals) < SIZES || median_rows(slow) > SAME_PERIOD * median_rows(fast) {
            return None;
        }
        // Half of the refreshes come no later: an axis that stops for a while lengthens the others.
        let typical = median_rows(&intervals);
        let near = || intervals.iter().filter(|i| (i.rows as f64 - typical).abs() <= (0.5 * typical).max(1.0));
        let mean = |of: fn(&Interval) -> f64| near().map(of).sum::<f64>() / near().count() as f64;
        let rows: usize = intervals.iter().map(|interval| interval.rows).sum();
        Some(Held {
            period_s: mean(|interval| interval.seconds),
            period_rows: mean(|interval| interval.rows as f64),
            repeated: (rows - count) as f64 / rows as f64,
            refreshes: count,
        })
    }

    /// Whether the rows may be those of a sensor with this refresh: hardly one change follows another much earlier.
    pub(super) fn may_be_held(&self, period_s: f64) -> bool {
        let intervals = self.intervals_of_changes();
        let early = intervals.iter().filter(|interval| interval.seconds < 0.5 * period_s).count();
        !intervals.is_empty() && early as f64 <= EARLY * intervals.len() as f64
    }

    /// Intervals between successive changes of the position, within the pieces.
    fn intervals_of_changes(&self) -> Vec<Interval> {
        let mut found = Vec::new();
        for piece in self.pieces() {
            let mut last: Option<(usize, f64)> = None;
            for row in piece.start + 1..piece.end {
                let change = self.x[row] - self.x[row - 1];
                if change == 0.0 {
                    continue;
                }
                if let Some((before, other)) = last.replace((row, change)) {
                    found.push(Interval {
                        rows: row - before,
                        seconds: self.t[row] - self.t[before],
                        size: change.abs(),
                        against: (change > 0.0) != (other > 0.0),
                    });
                }
            }
        }
        found
    }

    /// Intervals between successive changes of the position, within the pieces, where both changes are at speed.
    fn intervals_at_speed(&self) -> Vec<Interval> {
        let step = smallest_change(&self.x);
        let fast = FAST * step;
        let fast_per_row = if self.is_noisy() { FAST_IN_NOISE * step } else { 0.0 };
        let mut found = Vec::new();
        for piece in self.pieces() {
            // Row of the last change, and its size.
            let mut last: Option<(usize, f64)> = None;
            for row in piece.start + 1..piece.end {
                let change = self.x[row] - self.x[row - 1];
                if change == 0.0 {
                    continue;
                }
                if let Some((before, size)) = last {
                    let (small, large) = (size.abs().min(change.abs()), size.abs().max(change.abs()));
                    // Differences of rounded positions are off in their last digits.
                    let least = fast.max(fast_per_row * (row - before) as f64);
                    let at_speed = small > 0.99 * least && large <= SAME_SPEED * small;
                    if at_speed && (size > 0.0) == (change > 0.0) {
                        let seconds = self.t[row] - self.t[before];
                        found.push(Interval { rows: row - before, seconds, size: small, against: false });
                    }
                }
                last = Some((row, change));
            }
        }
        found
    }

    /// Whether the position often changes against its change before.
    fn is_noisy(&self) -> bool {
        let (mut changes, mut against) = (0_usize, 0_usize);
        for piece in self.pieces() {
            let steps = self.x[piece].windows(2).map(|w| w[1] - w[0]).filter(|change| *change != 0.0);
            let signs: Vec<bool> = steps.map(|change| change > 0.0).collect();
            changes += signs.len();
            against += signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        }
        against as f64 > NOISY * changes as f64
    }
}

fn median_rows(intervals: &[Interval]) -> f64 {
    median(intervals.iter().map(|interval| interval.rows as f64).collect())
}

/// Number of different sizes of change among intervals in the order of size.
fn sizes(intervals: &[Interval]) -> usize {
    let mut different: Vec<f64> = Vec::new();
    for Interval { size, .. } in intervals {
        if different.last().is_none_or(|last| *size > (1.0 + ONE_SIZE) * last) {
            different.push(*size);
        }
    }
    different.len()
}

/// The smallest change of a signal; 0 if it never changes.
fn smallest_change(x: &[f64]) -> f64 {
    let sizes = x.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|size| *size > 0.0);
    sizes.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 s at `rate_hz` of an axis at x(t), read every `refresh_s`, in whole steps of `step`.
    fn recorded(rate_hz: f64, refresh_s: f64, step: f64, x: impl Fn(f64) -> f64) -> Recording {
        let t: Vec<f64> = (0..(10.0 * rate_hz) as usize).map(|k| k as f64 / rate_hz).collect();
        // A ten-thousandth of a row: refreshes that fall on a row are not late by rounding.
        let read = |t: &f64| ((t + 1e-4 / rate_hz) / refresh_s).floor() * refresh_s;
        let round = |x: f64| if step > 0.0 { (x / step).round() * step } else { x };
        Recording {
            x: t.iter().map(|t| round(x(read(t)))).collect(),
            u: vec![0.0; t.len()],
            encoder_step: (step > 0.0).then_some(step),
            t,
            ..Recording::default()
        }
    }

    /// A sine of 1 rad at 0.5 Hz: speeds from 0 to 3.1 rad/s.
    fn swing(t: f64) -> f64 {
        (std::f64::consts::PI * t).sin()
    }

    /// Periods of 2, 3.2, 4, 1.4 and 20 rows are found to 2 %, with an encoder of 4096 counts, a coarse one and one
    /// without steps. The refreshes fall on rows, so that a period is off by at most one row at either end of some
    /// hundred.
    #[test]
    fn the_refresh_period_is_found_whatever_the_encoder() {
        for step in [0.0, std::f64::consts::TAU / 4096.0, 0.01] {
            for (rate_hz, refresh_s) in [(200.0, 0.02), (200.0, 0.016), (1000.0, 0.002), (1000.0, 0.02), (200.0, 0.007)]
            {
                // The coarse encoder needs two steps per refresh.
                if 3.1 * refresh_s < 3.0 * step {
                    continue;
                }
                let held = recorded(rate_hz, refresh_s, step, swing).held();
                let held = held.unwrap_or_else(|| panic!("not found: {step} {rate_hz} {refresh_s}"));
                assert!((held.period_s / refresh_s - 1.0).abs() < 0.02, "{step} {rate_hz} {refresh_s}: {held:?}");
                assert!((held.period_rows / (refresh_s * rate_hz) - 1.0).abs() < 0.02, "{held:?}");
                assert!((held.repeated - (1.0 - 1.0 / (refresh_s * rate_hz))).abs() < 0.05, "{held:?}");
            }
        }
    }

    /// A coarse encoder repeats its value at slow speed, and is not held. The speeds are a fiftieth of a step per row
    /// to three steps per row, then a swing, and a flicker of noise.
    #[test]
    fn a_coarse_encoder_at_slow_speed_is_not_held() {
        for steps_per_row in [0.02, 0.3, 0.5, 0.9, 1.0, 1.3, 1.9, 2.0, 2.4, 3.0] {
            let slow = recorded(1000.0, 0.001, 0.01, |t| 0.01 * steps_per_row * 1000.0 * t);
            assert_eq!(slow.held(), None, "{steps_per_row}");
        }
        for amplitude in [0.05, 0.5, 5.0] {
            assert_eq!(recorded(1000.0, 0.001, 0.01, |t| amplitude * swing(t)).held(), None, "{amplitude}");
            let flicker = |t: f64| amplitude * swing(t) + 0.004 * (7919.0 * t).sin();
            assert_eq!(recorded(1000.0, 0.001, 0.01, flicker).held(), None, "{amplitude}");
        }
    }

    /// Noise of a step repeats values at two steps per row too, as in the standard suite's slow sines. Speeds up to 0.9, 1.9,
    /// 3.1 and 6.3 steps per row.
    #[test]
    fn noise_of_a_step_is_not_held() {
        for amplitude in [3.0, 6.0, 10.0, 20.0] {
            let mut state = 1_u32;
            let mut uniform = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state) / f64::from(u32::MAX) - 0.5
            };
            let mut noisy = recorded(1000.0, 0.001, 0.0, |t| amplitude * swing(t));
            // The sum of twelve has a standard deviation of 1.
            noisy.x.iter_mut().for_each(|x| *x += 0.01 * (0..12).map(|_| uniform()).sum::<f64>());
            noisy.x.iter_mut().for_each(|x| *x = (*x / 0.01).round() * 0.01);
            assert_eq!(noisy.held(), None, "{amplitude}");
        }
    }

    /// A coarse encoder with noise of half a step, read every 16, 1.4 and 4 ms, moves by a step or less in a refresh.
    #[test]
    fn a_slow_refresh_is_found_in_noise() {
        for (rate_hz, refresh_s) in [(9000.0, 0.016), (4000.0, 0.0014), (1000.0, 0.004)] {
            let mut state = 1_u32;
            let mut uniform = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(state) / f64::from(u32::MAX) - 0.5
            };
            let step = std::f64::consts::PI * refresh_s;
            let mut noisy = recorded(rate_hz, refresh_s, 0.0, swing);
            let (mut read, mut reported) = (f64::NAN, 0.0);
            for x in &mut noisy.x {
                if *x != read {
                    read = *x;
                    reported = (*x / step + 0.5 * (0..12).map(|_| uniform()).sum::<f64>()).round() * step;
                }
                *x = reported;
            }
            let held = noisy.held().unwrap_or_else(|| panic!("not found: {rate_hz} {refresh_s}"));
            assert!((held.period_s / refresh_s - 1.0).abs() < 0.02, "{rate_hz} {refresh_s}: {held:?}");
        }
    }

    /// At rest, and in too short a motion, nothing is said.
    #[test]
    fn rest_tells_nothing() {
        assert_eq!(recorded(200.0, 0.02, 0.001, |_| 1.0).held(), None);
        assert_eq!(recorded(200.0, 0.02, 0.001, |t| if t < 0.2 { t } else { 0.2 }).held(), None);
    }
}
