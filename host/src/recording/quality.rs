//! What is doubtful about a recording, though it can be used.

mod words;

use super::Recording;
use super::held::Held;
use super::lines::Lines;
use super::table::Table;

/// Least fraction of samples stuck at an extreme of the drive that is worth a warning.
const SATURATED: f64 = 0.01;
/// A drive with at most this many values (a relay has two to five) sits at its extremes on purpose.
const LEVELS: usize = 16;
/// A number past this is no position and no drive in any unit, and its square may be past what a number can be.
const LARGE: f64 = 1e100;
/// Size of a drive, in the largest of all other rows, from which it is worth a warning.
const DRIVE_LEAP: f64 = 10.0;
/// Most rows of such a drive that are single ones.
const SINGLE: usize = 3;
/// Samples in a row at the extreme that count as stuck there; a peak touches it once or twice.
const STUCK: usize = 3;

/// Something a user should know about a recording that can still be used.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The position stays within one encoder step: there is nothing to learn from this recording.
    NoMotion {
        /// Lowest and highest position, position units.
        range: (f64, f64),
        /// Number of samples.
        rows: usize,
    },
    /// Rows carry the time stamp of the row before; they are left out.
    StampRepeated {
        /// Their lines in the file.
        lines: Lines,
        /// Share of the rows, 0 to 1.
        share: f64,
    },
    /// Rows whose time stamp alone is out of order; they are left out.
    StampStray {
        /// Their lines in the file.
        lines: Lines,
    },
    /// The clock starts anew inside the file; the recording is cut there.
    ClockRestarts {
        /// The lines in the file at which it does.
        lines: Lines,
        /// Time stamps before and at the first of them, s.
        stamps_s: (f64, f64),
    },
    /// The position leaps out and back within a few rows; these rows are left out, and the recording is cut there.
    Outliers {
        /// Their lines in the file.
        lines: Lines,
        /// The first of them, position units.
        value: f64,
    },
    /// Single rows of the drive are far larger than all others; they are used as they are.
    DriveOutliers {
        /// Their lines in the file.
        lines: Lines,
        /// The first of them, drive units.
        value: f64,
        /// The largest size of the others, drive units.
        others: f64,
    },
    /// The last row is cut off; it is left out.
    Torn {
        /// Its line.
        line: u64,
        /// What is there of it.
        text: String,
    },
    /// The file ends inside a record; what is before it is used.
    EndsInRecord {
        /// Byte at which the record begins.
        at_byte: u64,
    },
    /// Rows in which a channel has no value; they are left out, and the recording is cut there.
    NoValue {
        /// Number of these rows.
        rows: usize,
        /// Their share of all rows, 0 to 1.
        share: f64,
    },
    /// Drive and position have clocks of their own.
    Joined {
        /// The drive's channel.
        drive: String,
        /// The position's channel.
        position: String,
    },
    /// The sensor refreshes the position less often than rows are written; in between it is held.
    Held(Held),
    /// The drive is stuck at its extremes for `fraction` of the samples: the true demand is not what was applied.
    Saturated {
        /// Fraction of the samples, 0 to 1.
        fraction: f64,
        /// Lowest and highest drive, drive units.
        extremes: (f64, f64),
    },
    /// The drive never changes: only what a free or steady motion shows can be learnt.
    ConstantDrive {
        /// The drive, drive units.
        value: f64,
    },
    /// A number that cannot be meant: nothing that is computed from it is.
    Large {
        /// The number.
        value: f64,
        /// Its time, s.
        t: f64,
    },
    /// Samples are missing; the recording is used in pieces.
    Gaps {
        /// Number of gaps.
        count: usize,
        /// Longest interval, s.
        longest_s: f64,
    },
    /// The intervals between samples differ.
    Jitter {
        /// Shortest, median and longest interval, s.
        intervals_s: (f64, f64, f64),
    },
}

impl Recording {
    /// Lowest and highest position.
    fn range(&self) -> (f64, f64) {
        self.x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
    }

    /// Whether the position moves by more than one encoder step: one step is what a resting sensor flickers by.
    pub fn moves(&self) -> bool {
        let (low, high) = self.range();
        high - low > 1.5 * self.encoder_step.unwrap_or(0.0)
    }

    /// What is doubtful about this recording, what its reader mended included. Saturation is looked for at both extremes of
    /// the drive, unless it has few levels like a relay's.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut found = self.found.clone();
        if !self.moves() {
            found.push(Warning::NoMotion { range: self.range(), rows: self.x.len() });
        }
        found.extend(self.held().map(Warning::Held));
        match levels(&self.u) {
            1 => found.extend(self.u.first().map(|&value| Warning::ConstantDrive { value })),
            count if count > LEVELS => found.extend(saturation(&self.u)),
            _ => {}
        }
        let mut large = self.t.iter().zip(self.u.iter().zip(&self.x));
        if let Some((&t, (&u, &x))) = large.find(|(_, (u, x))| u.abs().max(x.abs()) > LARGE) {
            found.push(Warning::Large { value: if u.abs() > LARGE { u } else { x }, t });
        }
        let timing = self.timing();
        if !self.gaps.is_empty() {
            let jump = |&k: &usize| Some(self.t.get(k)? - self.t.get(k.checked_sub(1)?)?);
            found.push(Warning::Gaps {
                count: self.gaps.len(),
                longest_s: self.gaps.iter().filter_map(jump).fold(0.0, f64::max),
            });
        }
        let within = super::timing::EVEN_WITHIN * timing.median_s;
        if timing.max_s - timing.median_s > within || timing.median_s - timing.min_s > within {
            found.push(Warning::Jitter { intervals_s: (timing.min_s, timing.median_s, timing.max_s) });
        }
        found
    }
}

impl Table {
    /// Warns of single rows in which the drive, in column `column`, is far larger than in all others.
    pub(super) fn warn_of_drive(&mut self, column: usize) {
        let Some(u) = self.columns.get(column) else { return };
        let largest = u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let far = |u: &f64| u.abs() > largest / DRIVE_LEAP;
        let others = u.iter().filter(|u| !far(u)).fold(0.0, |most: f64, u| most.max(u.abs()));
        let rows: Vec<usize> = u.iter().enumerate().filter(|(_, u)| far(u)).map(|(row, _)| row).collect();
        if let Some(&first) = rows.first()
            && others > 0.0
            && rows.len() <= SINGLE
            && u[first].abs() > DRIVE_LEAP * others
        {
            let lines = rows.iter().map(|&row| self.lines.of(row)).collect();
            self.found.push(Warning::DriveOutliers { lines, value: u[first], others });
        }
    }
}

/// Number of different values, counted up to one more than [`LEVELS`].
fn levels(u: &[f64]) -> usize {
    let mut seen: Vec<f64> = Vec::with_capacity(LEVELS + 1);
    for &value in u {
        if !seen.contains(&value) {
            seen.push(value);
            if seen.len() > LEVELS {
                break;
            }
        }
    }
    seen.len()
}

fn saturation(u: &[f64]) -> Option<Warning> {
    let low = u.iter().copied().fold(f64::INFINITY, f64::min);
    let high = u.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let stuck: usize = u
        .chunk_by(|a, b| a == b)
        .filter(|run| run.len() >= STUCK && (run[0] == low || run[0] == high))
        .map(<[f64]>::len)
        .sum();
    let fraction = stuck as f64 / u.len() as f64;
    (fraction >= SATURATED).then_some(Warning::Saturated { fraction, extremes: (low, high) })
}
