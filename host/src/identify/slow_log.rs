//! Recordings with few rows per second: what the drive did between two rows is not recorded.
//!
//! The drive is taken as held from row to row, as a controller that writes one row per tick applies it. A slow log of a faster
//! controller holds samples of a drive that went on changing: on average that is half an interval late. The other extreme is a
//! drive that goes straight from row to row. Both are tried, and what they differ by is an error that no residual shows.

use super::determined::weakly_determined;
use super::estimate::{Identification, ModelEstimate, Remark, assuming_held};
use super::weak;
use crate::recording::Recording;

/// Ratio of the simulation errors from which the recording itself tells that the drive was held. A drive that changes by a
/// tenth at every row makes it larger; where it is smaller, both assumptions follow the motion.
const TELLS: f64 = 2.0;

/// Widths of a window, over the standard one, from which rows are far apart: below 133 rows per second. A controller that is
/// as slow as that is rare, and one that is logged so seldom is not.
const WIDENED: f64 = 3.0;

/// Whether rows are so far apart that the windows of equation error are several times as wide as their standard.
pub(super) fn is_slow(recordings: &[Recording]) -> bool {
    recordings.iter().any(|recording| recording.timing().median_s > WIDENED * weak::STANDARD_INTERVAL_S)
}

/// The result with the errors that the unknown drive between rows makes, unless the motion tells that it was held.
pub(super) fn with_unknown_drive(mut held: Identification, recordings: &[Recording]) -> Identification {
    let straight: Vec<Recording> = recordings.iter().map(straight).collect();
    let Ok((straight, _)) = assuming_held(&straight) else { return held };
    if straight.simulation_error > TELLS * held.simulation_error {
        return held;
    }
    let name = held.best.estimator;
    let same = straight.estimates.iter().find(|estimate| estimate.estimator == name);
    let largest = widen(&mut held.best, same.unwrap_or(&straight.best));
    if let Some(reported) = held.estimates.iter_mut().find(|estimate| estimate.estimator == name) {
        reported.clone_from(&held.best);
    }
    let named: Vec<&str> = held.undetermined.iter().map(|already| already.parameter).collect();
    let mut wide = Vec::new();
    weakly_determined(&held.best, &mut wide);
    wide.retain(|parameter| !named.contains(&parameter.parameter));
    held.undetermined.extend(wide);
    held.remarks.push(Remark::DriveBetweenRows { percent: 100.0 * largest });
    held
}

/// The recording with the mean of the drives at both ends of each interval: a straight line, as far as a slower axis feels it.
fn straight(recording: &Recording) -> Recording {
    let mut straight = recording.clone();
    for piece in recording.pieces() {
        for row in piece.start..piece.end.saturating_sub(1) {
            straight.u[row] = 0.5 * (recording.u[row] + recording.u[row + 1]);
        }
    }
    straight
}

/// Adds the difference of another estimate to the standard errors. Returns the largest of b, c and f1, as a share.
fn widen(best: &mut ModelEstimate, other: &ModelEstimate) -> f64 {
    let pairs = [(&mut best.b, other.b), (&mut best.c, other.c), (&mut best.f1, other.f1)];
    let mut largest = 0.0_f64;
    for (value, other) in pairs {
        let difference = (value.value - other.value).abs();
        value.se = value.se.hypot(difference);
        largest = largest.max(difference / value.value.abs().max(f64::MIN_POSITIVE));
    }
    if let (Some(load), Some(other)) = (&mut best.load, other.load) {
        load.se = load.se.hypot(load.value - other.value);
    }
    largest
}
