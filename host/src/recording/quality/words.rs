//! Warnings in words.

use std::fmt;

use super::Warning;

/// Share of repeated stamps from which the clock itself is too coarse; single double rows are far fewer.
const COARSE_CLOCK: f64 = 0.1;

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
