//! What is doubtful about a recording, though it can be used.

use std::fmt;

use super::Recording;

/// Least fraction of samples stuck at an extreme of the drive that is worth a warning.
const SATURATED: f64 = 0.01;
/// A drive with at most this many values (a relay has two to five) sits at its extremes on purpose.
const LEVELS: usize = 16;
/// A number past this is no position and no drive in any unit, and its square may be past what a number can be.
const LARGE: f64 = 1e100;
/// Samples in a row at the extreme that count as stuck there; a peak touches it once or twice.
const STUCK: usize = 3;

/// Something a user should know about a recording that can still be used.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
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
            Self::Saturated { fraction, extremes: (low, high) } => write!(
                out,
                "the drive is saturated in {:.1} % of the samples (limits {low} and {high}); column u must be what was applied, not what was asked for",
                100.0 * fraction
            ),
            Self::ConstantDrive { value } => {
                write!(out, "the drive is constant ({value}); inertia and friction cannot be told apart by it")
            }
            Self::Large { value, t } => {
                write!(out, "{value:e} at t = {t} s is no drive and no position in any unit; repair or remove that row")
            }
            Self::Gaps { count, longest_s } => {
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
    /// What is doubtful about this recording. Saturation is looked for at both extremes of the drive, unless it has few levels like a relay's.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut found = Vec::new();
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
