//! The largest base of a fit: one that the drive of the recordings still moves.

use breakaway_core::plant::Base;

use super::Problem;
use super::prepare::MeasuredMotion;
use super::settings::MOST_FORCE;

impl Problem<'_> {
    /// The largest base that a fit can reach.
    pub fn largest_base(&self) -> Base<f64> {
        let most = |of: fn(&MeasuredMotion) -> f64| self.tracks.iter().map(of).fold(0.0, f64::max);
        let force = MOST_FORCE * most(|track| track.largest_drive);
        Base {
            b: force / most(|track| track.typical_acceleration),
            c: force / most(|track| track.typical_speed),
            f1: force,
        }
    }
}
