//! References: position, velocity and acceleration at a tick.
//!
//! All are functions of the tick number alone, so they need no state and do not drift; the caller counts.

mod cubic;
mod profile;
mod samples;
mod sine;

pub use cubic::{Cubic, CubicRange};
pub use profile::{Phases, Profile};
pub use samples::Samples;
pub use sine::Sine;

use super::fast::Fast;
use crate::says::says;
use crate::scalar::Real;

/// What the axis should do at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint<R> {
    /// Position, X.
    pub x: R,
    /// Velocity, X/s.
    pub v: R,
    /// Acceleration, X/s².
    pub a: R,
}

/// What is wrong with a trajectory; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrajectoryError {
    /// The tick is not finite and positive.
    Tick,
    /// The amplitude or distance is not finite.
    Distance,
    /// The frequency is not within (0, half the tick rate).
    Frequency,
    /// The largest speed is not finite and positive.
    Speed,
    /// The largest acceleration is not finite and positive.
    Acceleration,
    /// The largest jerk is not finite and positive.
    Jerk,
    /// The profile would take more than 2³⁰ ticks.
    Duration,
    /// No samples.
    Empty,
}

says! { TrajectoryError:
    Self::Tick => "the tick must be above 0",
    Self::Distance => "the amplitude or distance must be a finite number",
    Self::Frequency => "the frequency must be above 0 and below half the tick rate",
    Self::Speed => "the speed must be above 0",
    Self::Acceleration => "the acceleration must be above 0",
    Self::Jerk => "the jerk must be above 0",
    Self::Duration => "the move or the rest takes too long",
    Self::Empty => "there are no samples",
}

fn check_tick<F: Real>(tick_s: F) -> Result<(), TrajectoryError> {
    if tick_s.is_finite() && tick_s > F::ZERO { Ok(()) } else { Err(TrajectoryError::Tick) }
}

/// A reference of any kind, around the position at which it was started.
#[derive(Clone, Copy, Debug)]
pub enum Trajectory<'a, R> {
    /// Rest at the start.
    Hold,
    /// See [`Sine`].
    Sine(Sine<R>),
    /// See [`Profile`].
    Profile(Profile<R>),
    /// See [`Samples`].
    Samples(Samples<'a, R>),
}

impl<R: Fast> Trajectory<'_, R> {
    /// The reference at tick `k`.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        match self {
            Self::Hold => Setpoint::default(),
            Self::Sine(sine) => sine.at(k),
            Self::Profile(profile) => profile.at(k),
            Self::Samples(samples) => samples.at(k),
        }
    }
}

#[cfg(test)]
mod tests;
