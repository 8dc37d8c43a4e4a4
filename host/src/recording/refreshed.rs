//! Held positions merged: one row for each reading of the sensor, with the mean drive until the next.

use std::borrow::Cow;

use super::Recording;

/// Intervals of the sensor after which a position that is still the same counts as read anew: the axis rests.
const AT_REST: f64 = 1.5;

/// Intervals of a sensor's clock within which a delay is that clock's: a reading is up to one interval old, and half a one is the
/// least error of its instant.
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
        let Some(held) = self.held().filter(|held| held.period_rows >= AT_REST) else { return Cow::Borrowed(self) };
        let mut own = Self { t: Vec::new(), u: Vec::new(), x: Vec::new(), gaps: Vec::new(), ..self.clone() };
        own.read_every_s = Some(held.period_s);
        for piece in self.pieces() {
            let mut fresh: Vec<usize> = Vec::new();
            for row in piece.clone() {
                let anew = fresh.last().is_none_or(|last| {
                    self.x[row] != self.x[*last] || self.t[row] - self.t[*last] > AT_REST * held.period_s
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
                let until = |k: usize| if k + 1 < piece.end { self.t[k + 1] - self.t[k] } else { held.period_s };
                let (charge, time) =
                    (row..next).fold((0.0, 0.0), |(charge, time), k| (charge + self.u[k] * until(k), time + until(k)));
                own.t.push(self.t[row]);
                own.x.push(self.x[row]);
                own.u.push(if time > 0.0 { charge / time } else { self.u[row] });
            }
        }
        Cow::Owned(own)
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
