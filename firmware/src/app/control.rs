//! Closed-loop modes as the tick sees them: a controller that turns a count into a drive.
//!
//! The tick is generic over it, so that a core without an FPU can be built with [`NoController`] and hold no
//! floating-point code at all.

use breakaway_core::link::Ending;

use super::set_points::SetPointOutlet;
use crate::board::Applied;

/// What a run under control needs to know.
pub trait ControlPlan: Clone {
    /// A set-point of a reference that is sent piece by piece.
    type Knot: Copy;
    /// The current loop of a run whose drive is a current.
    type Current: Copy;
}

/// A controller with its trajectory.
pub trait PositionController {
    /// Checked by the thread before it is ordered.
    type Plan: ControlPlan;

    /// Starts a run at distance 0, which is at this `count`.
    fn start(&mut self, plan: &Self::Plan, count: i32);

    /// One tick, so many counts from the start. Gives the drive in drive codes, and the reference in counts from the
    /// start. `None` if the trajectory is over ([`Self::ending`]), or a number is no longer finite. What the drive may
    /// be is in the plan: it is applied as it is.
    fn tick(
        &mut self,
        distance: i32,
        points: &mut SetPointOutlet<'_, <Self::Plan as ControlPlan>::Knot>,
    ) -> Option<(i32, i32)>;

    /// Starts the current loop of a run.
    fn start_current(&mut self, plan: <Self::Plan as ControlPlan>::Current);

    /// The current loop's voltage in codes of the bridge, for a current as drive code and the measured one in mA. `None` if it is no
    /// finite number, or no loop was started. [`Self::applied`] must follow.
    fn voltage(&mut self, drive_code: i32, current_ma: i32) -> Option<i32>;

    /// What came of that voltage: the drive code that is recorded. It is the one that was asked for; where the voltage was cut, it is
    /// the measured current.
    fn applied(&mut self, asked: i32, applied: Applied) -> i16;

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
    type Current = Self;
}

impl PositionController for NoController {
    type Plan = core::convert::Infallible;

    fn start(&mut self, plan: &Self::Plan, _: i32) {
        match *plan {}
    }

    fn tick(&mut self, _: i32, _: &mut SetPointOutlet<'_, core::convert::Infallible>) -> Option<(i32, i32)> {
        None
    }

    fn start_current(&mut self, plan: core::convert::Infallible) {
        match plan {}
    }

    fn voltage(&mut self, _: i32, _: i32) -> Option<i32> {
        None
    }

    fn applied(&mut self, _: i32, applied: Applied) -> i16 {
        applied.code
    }

    fn saturated(&self) -> u32 {
        0
    }
}
