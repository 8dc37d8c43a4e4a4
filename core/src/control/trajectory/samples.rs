//! A reference from a table of positions.

use super::{Setpoint, TrajectoryError, check_tick};
use crate::control::fast::Fast;

/// Positions from a file, one per tick; velocity and acceleration by central differences. It rests at both ends.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a, R> {
    x: &'a [R],
    /// 1/(2·tick), 1/tick².
    per_two_ticks: R,
    per_tick_squared: R,
}

impl<'a, R: Fast> Samples<'a, R> {
    /// Positions (X) at ticks of `tick_s`.
    ///
    /// # Errors
    /// [`TrajectoryError::Tick`] or [`TrajectoryError::Empty`].
    pub fn new(x: &'a [R], tick_s: f64) -> Result<Self, TrajectoryError> {
        check_tick(tick_s)?;
        if x.is_empty() {
            return Err(TrajectoryError::Empty);
        }
        Ok(Self { x, per_two_ticks: R::from_f64(0.5 / tick_s), per_tick_squared: R::from_f64(1.0 / (tick_s * tick_s)) })
    }

    /// The reference at tick `k`; the last position after the end.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        let last = self.x.len().saturating_sub(1);
        let k = (k as usize).min(last);
        let sample = |i: usize| self.x.get(i.min(last)).copied().unwrap_or(R::ZERO);
        let (before, here, after) = (sample(k.saturating_sub(1)), sample(k), sample(k.saturating_add(1)));
        Setpoint {
            x: here,
            v: (after - before) * self.per_two_ticks,
            a: ((after - here) - (here - before)) * self.per_tick_squared,
        }
    }
}
