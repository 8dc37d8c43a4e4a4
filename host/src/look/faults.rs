//! What is wrong with a recording, each with the share of the rows that have it.

use serde::Serialize;

use super::guess::{Guess, Guesses};
use super::motion::gain;
use crate::recording::{ReadOptions, Recording, Warning};

/// Standard errors from which the acceleration goes against the drive.
const AGAINST: f64 = 5.0;
/// Distance of an interval from the median, as a share of it, from which a row counts as late or early.
const LATE: f64 = 0.1;
/// Time for which an axis stays where it is at rest, s: longer than it takes to turn back.
const REST_S: f64 = 0.2;
/// Share of the travel within which it stays, where no encoder step is known.
const REST: f64 = 1e-3;
/// Share of rows at rest that is worth a word.
const MUCH_REST: f64 = 0.2;
/// Share of the motion one way from which it is one way only.
const ONE_WAY: f64 = 0.98;

/// Share of the motion one way up to which the axis moves both ways alike.
const BOTH_WAYS: f64 = 0.8;

/// What is wrong, the gravest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum FaultKind {
    /// No channel is like a time, a drive or a position.
    Missing,
    /// The commands would refuse it.
    Refused,
    /// The position does not move.
    NoMotion,
    /// The drive never changes, or the motion never turns.
    NoExcitation,
    /// The drive has no sign, and the axis moves both ways.
    UnsignedDrive,
    /// The axis accelerates against the drive.
    InvertedSign,
    /// The drive sits at its limits.
    ClippedDrive,
    /// The position is refreshed less often than rows are written.
    HeldPositions,
    /// The axis rests.
    Standstill,
    /// Samples are missing.
    Gaps,
    /// The intervals differ.
    Jitter,
    /// Stamps are repeated, stray, or begin anew.
    Stamps,
    /// Rows that cannot be measurements.
    Outliers,
    /// Rows without a value.
    NoValue,
    /// The file ends inside a row or a record.
    Torn,
    /// Something else.
    Other,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Fault {
    /// Which.
    pub kind: FaultKind,
    /// Share of the rows that have it, 0 to 1, where it is of rows.
    pub share: Option<f64>,
    /// In words.
    pub text: String,
}

/// What of time, drive and position was not found.
pub(super) fn missing(guesses: &Guesses, options: &ReadOptions) -> Vec<Fault> {
    let one = |guess: &Option<Guess>, named: &Option<String>, what: &str, flag: &str| {
        let text = named.as_ref().map_or_else(
            || format!("no channel is called like a {what}; name it with {flag}"),
            |name| format!("there is no channel `{name}` of numbers, which {flag} names"),
        );
        guess.is_none().then_some(Fault { kind: FaultKind::Missing, share: None, text })
    };
    let position = one(&guesses.position, &options.position, "position", "--position");
    position.into_iter().chain(one(&guesses.drive, &options.input, "drive", "--input")).collect()
}

/// What is wrong with a recording.
pub(super) fn of(recording: &Recording) -> Vec<Fault> {
    let rows = recording.t.len().max(1) as f64;
    let mut faults: Vec<Fault> = recording.warnings().iter().map(|warning| fault(recording, warning, rows)).collect();
    let (up, down) = ways(&recording.x);
    let one_way = up.max(down) / (up + down).max(f64::MIN_POSITIVE);
    let gain = gain(&recording.t, &recording.u, &recording.x, recording.radians_per_unit());
    if one_way < BOTH_WAYS && recording.u.iter().all(|u| *u >= 0.0) {
        let text = "the drive is never negative while the axis moves both ways: it seems to have lost its sign, unless a load is held"
            .to_owned();
        faults.push(Fault { kind: FaultKind::UnsignedDrive, share: None, text });
    } else if gain.t < -AGAINST {
        let text = format!(
            "the axis accelerates against the drive ({:.0} standard errors): one of the two has the wrong sign",
            -gain.t
        );
        faults.push(Fault { kind: FaultKind::InvertedSign, share: None, text });
    }
    let rest = at_rest(recording) as f64 / rows;
    if recording.moves() && rest >= MUCH_REST {
        let text = "the axis rests; these rows say nothing of inertia and viscous friction".to_owned();
        faults.push(Fault { kind: FaultKind::Standstill, share: Some(rest), text });
    }
    if recording.moves() && one_way >= ONE_WAY {
        let text = "the axis moves one way only: Coulomb friction and a constant load are then one number".to_owned();
        faults.push(Fault { kind: FaultKind::NoExcitation, share: Some(one_way), text });
    }
    faults.sort_by_key(|fault| fault.kind);
    faults
}

fn fault(recording: &Recording, warning: &Warning, rows: f64) -> Fault {
    let (kind, share) = match warning {
        Warning::NoMotion { .. } => (FaultKind::NoMotion, Some(1.0)),
        Warning::ConstantDrive { .. } => (FaultKind::NoExcitation, Some(1.0)),
        Warning::StampRepeated { share, .. } => (FaultKind::Stamps, Some(*share)),
        Warning::StampStray { lines } => (FaultKind::Stamps, Some(lines.count() as f64 / rows)),
        Warning::ClockRestarts { .. } => (FaultKind::Stamps, None),
        Warning::Outliers { lines, .. } | Warning::DriveOutliers { lines, .. } => {
            (FaultKind::Outliers, Some(lines.count() as f64 / rows))
        }
        Warning::Large { .. } => (FaultKind::Outliers, None),
        Warning::Torn { .. } | Warning::EndsInRecord { .. } => (FaultKind::Torn, None),
        Warning::NoValue { share, .. } => (FaultKind::NoValue, Some(*share)),
        Warning::Held(held) => (FaultKind::HeldPositions, Some(held.repeated)),
        Warning::Saturated { fraction, .. } => (FaultKind::ClippedDrive, Some(*fraction)),
        Warning::Gaps { count, .. } => (FaultKind::Gaps, Some(*count as f64 / rows)),
        Warning::Jitter { .. } => (FaultKind::Jitter, Some(late(&recording.t) / rows)),
        Warning::Joined { .. } => (FaultKind::Other, None),
    };
    Fault { kind, share, text: warning.to_string() }
}

/// Number of rows that come early or late.
fn late(t: &[f64]) -> f64 {
    let mut intervals: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
    if intervals.is_empty() {
        return 0.0;
    }
    let middle = intervals.len() / 2;
    let median = *intervals.select_nth_unstable_by(middle, f64::total_cmp).1;
    intervals.iter().filter(|interval| (**interval - median).abs() > LATE * median).count() as f64
}

/// Number of rows in stretches of [`REST_S`] or more in which the position stays where it is.
fn at_rest(recording: &Recording) -> usize {
    let Recording { t, x, .. } = recording;
    let (low, high) = x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let within = (1.5 * recording.encoder_step.unwrap_or(0.0)).max(REST * (high - low));
    let mut rows = 0;
    for piece in recording.pieces() {
        let mut start = piece.start;
        while start < piece.end {
            let (mut low, mut high, mut end) = (x[start], x[start], start);
            while end < piece.end && x[end].max(high) - x[end].min(low) <= within {
                (low, high) = (low.min(x[end]), high.max(x[end]));
                end += 1;
            }
            if t[end - 1] - t[start] >= REST_S {
                rows += end - start;
            }
            start = end.max(start + 1);
        }
    }
    rows
}

/// How far a position goes up, and down.
fn ways(x: &[f64]) -> (f64, f64) {
    x.windows(2).fold((0.0, 0.0), |(up, down), w| (up + (w[1] - w[0]).max(0.0), down + (w[0] - w[1]).max(0.0)))
}
