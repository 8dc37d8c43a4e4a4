//! A reference that the host sends piece by piece while the device follows it.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::validate::range;
use super::{CommandError, Field};

/// Most set-points in one command.
pub const SET_POINTS: usize = 16;
/// Set-points that a device can hold until they are due.
pub const MOST_AHEAD: usize = 31;

/// Where the axis is to be, and how fast, so many ticks after the set-point before. Between two of them the reference is
/// the cubic that has position and velocity of both ([`Cubic`](crate::control::Cubic)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SetPoint {
    /// Ticks after the one before, 1 ..= 2²⁴; the first counts from the start of the motion.
    pub ticks: u32,
    /// Position relative to the start of the run, position units, finite.
    pub position: f32,
    /// Velocity, position units per second, finite.
    pub velocity: f32,
}

/// The next set-points. A device takes as many as it has room for, and says which it wants next. What it has taken
/// before is left out, so a command whose answer was lost may be sent again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SetPoints {
    /// Number of the first in `points`; that of the run's first is 0. Not beyond the next one that is wanted.
    pub sequence: u32,
    /// None follow after these: the run ends at the last one.
    pub last: bool,
    /// The set-points; none asks for the state.
    pub points: Vec<SetPoint, SET_POINTS>,
}

/// The state of a run along set-points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Following {
    /// Number of the next set-point that is wanted; those before are taken.
    pub next: u32,
    /// So many of them find room now.
    pub room: u8,
    /// How often the set-points ran dry before the last one: the reference then stood still.
    pub dry: u32,
}

impl SetPoints {
    /// Checks what can be checked without the device's state.
    pub(super) fn validate(&self) -> Result<(), CommandError> {
        for SetPoint { ticks, position, velocity } in &self.points {
            range((1..=1 << 24).contains(ticks), Field::SetPointTicks)?;
            range(position.is_finite(), Field::SetPointPosition)?;
            range(velocity.is_finite(), Field::SetPointVelocity)?;
        }
        Ok(())
    }
}
