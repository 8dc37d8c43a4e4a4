//! The current loop of a run: [`breakaway_core::control::CurrentLoop`] in mA and codes of the bridge.

use breakaway_core::control::{CurrentLoop, CurrentLoopState, Fast};

use crate::board::{Applied, FULL_SCALE};

/// What the thread has worked out of the settings.
#[derive(Clone, Copy, Debug)]
pub struct CurrentPlan<R = f32> {
    /// From mA to codes of the bridge.
    pub control: CurrentLoop<R>,
    /// mA per drive code, whose unit is the ampere.
    pub ma_per_code: R,
    /// Drive codes per mA.
    pub codes_per_ma: R,
}

/// The loop under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct CurrentRun<R> {
    plan: CurrentPlan<R>,
    state: CurrentLoopState<R>,
    /// Of this tick: the current that is asked for, drive codes, and the measured one.
    asked_code: i32,
    measured: R,
}

impl<R: Fast> CurrentRun<R> {
    pub(super) fn new(plan: CurrentPlan<R>) -> Self {
        Self { plan, state: CurrentLoopState::default(), asked_code: 0, measured: R::ZERO }
    }

    /// The voltage, codes of the bridge; `None` if it is no finite number.
    pub(super) fn voltage(&mut self, drive_code: i32, current_ma: i32) -> Option<i32> {
        let Self { plan, state, .. } = self;
        let measured = R::from_i32(current_ma);
        let volts = plan.control.drive(state, R::from_i32(drive_code) * plan.ma_per_code, measured);
        (self.asked_code, self.measured) = (drive_code, measured);
        volts.is_finite().then(|| volts.to_i32())
    }

    /// The drive code to be recorded.
    pub(super) fn applied(&mut self, asked: i32, applied: Applied) -> i16 {
        let Self { plan, state, .. } = self;
        let code = if applied.limited {
            plan.control.cut(state, R::from_i32(i32::from(applied.code)) - R::from_i32(asked));
            (self.measured * plan.codes_per_ma).to_i32()
        } else {
            plan.control.update(state);
            self.asked_code
        };
        // Not `clamp`, which could panic.
        code.min(i32::from(FULL_SCALE)).max(-i32::from(FULL_SCALE)) as i16
    }
}
