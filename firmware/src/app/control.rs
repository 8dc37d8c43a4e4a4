//! Closed-loop modes as the tick sees them: a controller that turns a count into a drive.
//!
//! The tick is generic over it, so that a core without an FPU can be built with [`NoController`] and hold no
//! floating-point code at all.

/// A controller with its trajectory.
pub trait PositionController {
    /// What a run under control needs to know: checked by the thread before it is ordered.
    type Plan: Clone;

    /// Starts a run at distance 0, which is at this `count`.
    fn start(&mut self, plan: &Self::Plan, count: i32);

    /// One tick, so many counts from the start: the drive in drive codes and the reference in counts from the start; `None` if a
    /// number is no longer finite. What the drive may be is in the plan: it is applied as it is.
    fn tick(&mut self, distance: i32) -> Option<(i32, i32)>;

    /// Ticks of this run in which it asked for more drive than its limit.
    fn saturated(&self) -> u32;

    /// The trajectory is at its end and the run with it.
    fn finished(&self) -> bool;
}

/// No controller: [`PositionController::Plan`] has no value, so no such run can be ordered.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoController;

impl PositionController for NoController {
    type Plan = core::convert::Infallible;

    fn start(&mut self, plan: &Self::Plan, _: i32) {
        match *plan {}
    }

    fn tick(&mut self, _: i32) -> Option<(i32, i32)> {
        None
    }

    fn saturated(&self) -> u32 {
        0
    }

    fn finished(&self) -> bool {
        true
    }
}
