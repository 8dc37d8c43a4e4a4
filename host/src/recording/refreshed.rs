//! Held positions merged: one row for each reading of the sensor, with the mean drive until the next.

use std::borrow::Cow;

use super::Recording;
use super::timing::{median, median_interval};

/// Intervals of the sensor after which a position that is still the same counts as read anew: the axis rests.
const AT_REST: f64 = 1.5;

/// Intervals within which a delay may be that of the readings. A reading is up to one interval old, and half an interval
/// is the least error of its instant.
const CLOCK_INTERVALS: f64 = 1.5;

impl Recording {
    /// Delays up to which the sensor's own clock explains, s; 0 where each row has a reading of its own.
    pub fn unsure_s(&self) -> f64 {
        self.read_every_s.map_or(0.0, |interval_s| CLOCK_INTERVALS * interval_s)
    }

    /// The recording with one row for each refresh of a held position (see [`Recording::held`]); itself where each row has a
    /// position of its own. The drive of a row is its mean until the next, which moves the axis as far as the drive itself
    /// did.
    pub fn refreshed(&self) -> Cow<'_, Self> {
        match self.held_s() {
            Some(period_s) => Cow::Owned(self.read_every(period_s)),
            None => Cow::Borrowed(self),
        }
    }

    /// The [`refreshed`](Self::refreshed) recording, with readings that are no older than the rows in which they were seen. A longer delay is then one of the loop, be it in the drive or on the way of the reading.
    pub fn seen_by_rows(self) -> Self {
        Self { read_every_s: self.seen_every_s, ..self }
    }

    /// Recordings of one sensor, each [`refreshed`](Self::refreshed). A recording that is too slow to tell its refresh has that of
    /// the others, if its rows do not speak against it.
    pub fn refreshed_together(all: &[Self]) -> Vec<Self> {
        let own: Vec<Option<f64>> = all.iter().map(Self::held_s).collect();
        let known: Vec<f64> = own.iter().flatten().copied().collect();
        let common = (!known.is_empty()).then(|| median(known));
        let each = all.iter().zip(own).map(|(recording, own)| {
            let period_s = own.or_else(|| common.filter(|period_s| recording.may_be_held(*period_s)));
            period_s.map_or_else(|| recording.clone(), |period_s| recording.read_every(period_s))
        });
        each.collect()
    }

    /// The recording of a sensor whose readings are `age_s` old: the drive of a row is what was applied as long before it.
    pub fn with_readings_of(&self, age_s: f64) -> Self {
        let mut u = self.u.clone();
        for piece in self.pieces() {
            let t = &self.t[piece.clone()];
            let mut impulse = vec![0.0];
            for k in piece.start..piece.end - 1 {
                impulse.push(impulse[k - piece.start] + self.u[k] * (self.t[k + 1] - self.t[k]));
            }
            // Before the first row the drive is that of the first row.
            let until = |at: f64| {
                let k = t.partition_point(|t| *t <= at).saturating_sub(1);
                impulse[k] + self.u[piece.start + k] * (at - t[k])
            };
            for k in 0..t.len().saturating_sub(1) {
                u[piece.start + k] = (until(t[k + 1] - age_s) - until(t[k] - age_s)) / (t[k + 1] - t[k]);
            }
        }
        Self { u, ..self.clone() }
    }

    /// Interval at which a held position is refreshed, s.
    fn held_s(&self) -> Option<f64> {
        self.held().filter(|held| held.period_rows >= AT_REST).map(|held| held.period_s)
    }

    /// The rows at which a sensor with this refresh is read, without the current between them.
    fn read_every(&self, period_s: f64) -> Self {
        let (t, u, x, current, gaps) = Default::default();
        let mut own = Self { t, u, x, current, gaps, ..self.clone() };
        own.read_every_s = Some(period_s);
        own.seen_every_s = Some(median_interval(&self.t));
        for piece in self.pieces() {
            let mut fresh: Vec<usize> = Vec::new();
            for row in piece.clone() {
                let anew = fresh.last().is_none_or(|last| {
                    self.x[row] != self.x[*last] || self.t[row] - self.t[*last] > AT_REST * period_s
                });
                if anew {
                    fresh.push(row);
                }
            }
            if piece.start > 0 {
                own.gaps.push(own.t.len());
            }
            for (i, row) in fresh.iter().copied().enumerate() {
                let next = fresh.get(i + 1).copied().unwrap_or(piece.end - 1).max(row + 1).min(piece.end);
                let until = |k: usize| if k + 1 < piece.end { self.t[k + 1] - self.t[k] } else { period_s };
                let (charge, time) =
                    (row..next).fold((0.0, 0.0), |(charge, time), k| (charge + self.u[k] * until(k), time + until(k)));
                own.t.push(self.t[row]);
                own.x.push(self.x[row]);
                own.u.push(if time > 0.0 { charge / time } else { self.u[row] });
            }
        }
        own
    }
}

#[cfg(test)]
mod tests {
    use super::Recording;

    /// A sensor that is read every fourth row: a fourth of the rows is left, and the drive's integral is what it was.
    #[test]
    fn a_row_for_each_reading_and_the_same_impulse() {
        let position = |k: usize| (k / 4 * 4) as f64 * 0.001 + 0.3 * ((k / 4 * 4) as f64 * 0.01).sin();
        let recording = Recording {
            t: (0..4000).map(|k| k as f64 * 0.005).collect(),
            u: (0..4000).map(|k| (k as f64 * 0.37).sin()).collect(),
            x: (0..4000).map(position).collect(),
            ..Recording::default()
        };
        let own = recording.refreshed();
        assert!((990..=1010).contains(&own.t.len()), "{}", own.t.len());
        let impulse = |r: &Recording| r.t.windows(2).zip(&r.u).map(|(t, u)| (t[1] - t[0]) * u).sum::<f64>();
        // The last reading's own interval is in neither sum in full: .02 s of a drive of at most 1.
        assert!((impulse(&own) - impulse(&recording)).abs() < 0.021);
    }

    /// A drive of single rows arrives 2.5 rows later: half in either row, its impulse whole.
    #[test]
    fn the_drive_of_old_readings_is_the_one_before() {
        let recording = Recording {
            t: (0..20).map(|k| k as f64 * 0.01).collect(),
            u: (0..20).map(|k| if k == 8 { 1.0 } else { 0.0 }).collect(),
            x: vec![0.0; 20],
            ..Recording::default()
        };
        let own = recording.with_readings_of(0.025);
        let expected = |k: usize| if k == 10 || k == 11 { 0.5 } else { 0.0 };
        assert!(own.u.iter().enumerate().all(|(k, u)| (u - expected(k)).abs() < 1e-9), "{:?}", own.u);
        assert_eq!(recording.with_readings_of(0.0), recording);
    }

    /// Of a swing and a creep with one sensor, the creep does not tell: a step of it lasts longer than a refresh. Together it has the
    /// swing's; beside a creep whose changes come at every row it has not.
    #[test]
    fn a_slow_recording_has_the_sensor_of_the_others() {
        let held = |speed: f64| Recording {
            t: (0..4000).map(|k| k as f64 * 0.005).collect(),
            u: vec![0.0; 4000],
            x: (0..4000).map(|k| (speed * ((k / 4 * 4) as f64 * 0.01).sin() / 0.001).round() * 0.001).collect(),
            ..Recording::default()
        };
        let (swing, creep) = (held(0.3), held(0.02));
        assert_eq!(creep.held(), None);
        let together = Recording::refreshed_together(&[swing.clone(), creep]);
        assert!(together[1].read_every_s.is_some_and(|period_s| (period_s / 0.02 - 1.0).abs() < 0.02));
        // A delay of two rows may be that of the readings. By the rows it is one of the loop.
        assert!(together[1].unsure_s() > 0.01 && together[1].clone().seen_by_rows().unsure_s() < 0.01);
        let mut own = swing.clone();
        own.x = (0..4000).map(|k| 1e-6 * (k as f64).sin()).collect();
        assert_eq!(Recording::refreshed_together(&[swing, own.clone()])[1], own);
    }

    #[test]
    fn rows_of_their_own_are_left_as_they_are() {
        let recording = Recording {
            t: (0..4000).map(|k| k as f64 * 0.005).collect(),
            u: vec![0.0; 4000],
            x: (0..4000).map(|k| (k as f64 * 0.01).sin()).collect(),
            ..Recording::default()
        };
        assert_eq!(*recording.refreshed(), recording);
    }
}
