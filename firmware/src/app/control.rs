//! Closed-loop modes as the tick sees them: a controller that turns a count into a drive.
//!
//! The tick is generic over it, so that a core without an FPU can be built with [`NoController`] and hold no
//! floating-point code at all.

use breakaway_core::link::Ending;

use super::set_points::SetPointOutlet;

/// What a run under control needs to know.
pub trait ControlPlan: Clone {
    /// A set-point of a reference that is sent piece by piece.
    type Knot: Copy;
}

/// A controller with its trajectory.
pub trait PositionController {
    /// Checked by the thread before it is ordered.
    type Plan: ControlPlan;

    /// Starts a run at distance 0, which is at this `count`.
    fn start(&mut self, plan: &Self::Plan, count: i32);

    /// One tick, so many counts from the start: the drive in drive codes and the reference in counts from the start; `None` if the
    /// trajectory is over ([`Self::ending`]), or a number is no longer finite. What the drive may be is in the plan: it is applied as it is.
    fn tick(
        &mut self,
        distance: i32,
        points: &mut SetPointOutlet<'_, <Self::Plan as ControlPlan>::Knot>,
    ) -> Option<(i32, i32)>;

    /// Ticks of this run in which it asked for more drive than its limit.
    fn saturated(&self) -> u32;

    /// How the run ends, after a tick without a drive; `None` where a number was not finite.
    fn ending(&self) -> Option<Ending> {
        None
    }
}

/// No controller: [`PositionController::Plan`] has no value, so no such run can be ordered.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoController;

impl ControlPlan for core::convert::Infallible {
    type Knot = Self;
}

impl PositionController for NoController {
    type Plan = core::convert::Infallible;

    fn start(&mut self, plan: &Self::Plan, _: i32) {
        match *plan {}
    }

    fn tick(&mut self, _: i32, _: &mut SetPointOutlet<'_, core::convert::Infallible>) -> Option<(i32, i32)> {
        None
    }

    fn saturated(&self) -> u32 {
        0
    }
}
