//! What is doubtful about a recording, though it can be used.

use std::fmt;

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
/// Share of repeated stamps from which the clock itself is too coarse; single double rows are far fewer.
const COARSE_CLOCK: f64 = 0.1;
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

impl fmt::Display for Warning {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoMotion { range: (low, high), rows } if low == high => {
                write!(out, "the position does not move: it is {low} in all {rows} rows")
            }
            Self::NoMotion { range: (low, high), rows } => write!(
                out,
                "the position does not move: it stays within one encoder step ({low} to {high}) in all {rows} rows"
            ),
            Self::StampRepeated { lines, share } => {
                write!(out, "{lines}: the time stamp of the row before is repeated; these rows are left out")?;
                if *share > COARSE_CLOCK && lines.stretches() > 1 {
                    write!(
                        out,
                        " ({:.0} % of all). The clock is coarser than the rows are frequent: --fs HZ counts time from the rows",
                        100.0 * share
                    )?;
                }
                Ok(())
            }
            Self::StampStray { lines } => {
                write!(out, "{lines}: the time stamp is out of order with the rows around it; these rows are left out")
            }
            Self::ClockRestarts { lines, stamps_s: (before, after) } => write!(
                out,
                "{lines}: the clock starts anew (first from {before} s to {after} s); the recording is cut there"
            ),
            Self::Outliers { lines, value } => write!(
                out,
                "{lines}: the position leaps out and back (to {value} first); these rows are left out, and the recording is \
                 cut there"
            ),
            Self::DriveOutliers { lines, value, others } => write!(
                out,
                "{lines}: the drive ({value} first) is far larger than in all other rows (at most {others}); remove these \
                 rows if it was not applied"
            ),
            Self::Torn { line, text } => {
                write!(out, "line {line}: the last row (`{text}`) is cut off; it is left out")
            }
            Self::EndsInRecord { at_byte } => {
                write!(out, "the file ends inside the record at byte {at_byte}; what is before it is used")
            }
            Self::NoValue { rows, share } => write!(
                out,
                "{rows} row(s) ({:.1} % of all) have no value of a channel that is used; they are left out, and the \
                 recording is cut there",
                100.0 * share
            ),
            Self::Joined { drive, position } => write!(
                out,
                "`{drive}` and `{position}` have clocks of their own: the rows are those of `{position}`, which is not \
                 interpolated, and `{drive}` is held from value to value"
            ),
            Self::Held(held) => write!(
                out,
                "the position is refreshed every {:.3} ms and held in between: {:.0} % of the rows in motion repeat the row \
                 before",
                1e3 * held.period_s,
                100.0 * held.repeated
            ),
            Self::Saturated { fraction, extremes: (low, high) } => write!(
                out,
                "the drive is saturated in {:.1} % of the samples (limits {low} and {high}); column u must be the drive that was applied, not the one that was commanded",
                100.0 * fraction
            ),
            Self::ConstantDrive { value } => {
                write!(out, "the drive is constant ({value}), which does not separate inertia from friction")
            }
            Self::Large { value, t } => {
                write!(out, "{value:e} at t = {t} s is no drive and no position in any unit; repair or remove that row")
            }
            Self::Gaps { count, longest_s } => {
                let longest_s = (1e6 * longest_s).round() / 1e6;
                write!(out, "{count} gap(s), the longest {longest_s} s; the recording is used in pieces")
            }
            Self::Jitter { intervals_s: (min, median, max) } => write!(
                out,
                "the clock is irregular: {:.4} to {:.4} ms between samples, median {:.4} ms",
                1e3 * min,
                1e3 * max,
                1e3 * median
            ),
        }
    }
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
