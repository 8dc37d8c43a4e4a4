//! The whole controller of a tick: a law (PID or adaptive), the compensator beside it, the drive's limit behind them.

use super::adaptive::{Adaptive, AdaptiveState};
use super::compensator::Compensator;
use super::fast::Fast;
use super::pid::{Pid, PidState};
use super::trajectory::Setpoint;

/// The feedback law.
#[derive(Clone, Copy, Debug)]
pub enum ControlLaw<R> {
    /// The PID of remark 1.
    Pid(Pid<R>),
    /// The adaptive law.
    Adaptive(Adaptive<R>),
}

/// A controller: configuration.
#[derive(Clone, Copy, Debug)]
pub struct Controller<R> {
    /// The feedback law.
    pub law: ControlLaw<R>,
    /// The feed-forward compensator; absent and switched off are the same, bit by bit.
    pub compensator: Option<Compensator<R>>,
}

/// What a controller remembers, whichever its law.
#[derive(Clone, Copy, Debug)]
pub struct ControllerState<R> {
    /// Of the PID.
    pub pid: PidState<R>,
    /// Of the adaptive law.
    pub adaptive: AdaptiveState<R>,
}

/// The drive of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitedDrive<R> {
    /// The drive, within the limit.
    pub u: R,
    /// Whether the limit cut it: nothing adapted, and the integral went back by what was cut off.
    pub saturated: bool,
}

impl<R: Fast> ControllerState<R> {
    /// The state at the start.
    pub fn start(controller: &Controller<R>) -> Self {
        let adaptive = match &controller.law {
            ControlLaw::Pid(_) => AdaptiveState::default(),
            ControlLaw::Adaptive(law) => law.start(),
        };
        Self { pid: PidState::default(), adaptive }
    }
}

impl<R: Fast> Controller<R> {
    /// A PID alone.
    pub const fn pid(pid: Pid<R>) -> Self {
        Self { law: ControlLaw::Pid(pid), compensator: None }
    }

    /// An adaptive law alone.
    pub const fn adaptive(law: Adaptive<R>) -> Self {
        Self { law: ControlLaw::Adaptive(law), compensator: None }
    }

    /// With a compensator beside the law.
    #[must_use]
    pub const fn with_compensator(self, compensator: Compensator<R>) -> Self {
        Self { compensator: Some(compensator), ..self }
    }

    /// One tick: the drive for a reference and the measured position `x`. `None` where the drive is not a finite number.
    #[inline]
    pub fn tick(&self, state: &mut ControllerState<R>, reference: Setpoint<R>, x: R) -> Option<LimitedDrive<R>> {
        self.tick_from(state, reference, x, R::ZERO)
    }

    /// The same where `reference` and `x` are counted from `origin`, the place (X) at which the model has its zero
    /// being 0. So an error keeps its digits far from there, and effects of the position stay where they are.
    ///
    /// A reference or a reading that is not finite, or a state that has overflowed, makes a drive that is none. The
    /// result is then `None`. Nothing may be driven, and the state is of no use any more: the run is over.
    #[inline]
    pub fn tick_from(
        &self,
        state: &mut ControllerState<R>,
        reference: Setpoint<R>,
        x: R,
        origin: R,
    ) -> Option<LimitedDrive<R>> {
        let placed = Setpoint { x: reference.x + origin, ..reference };
        let compensator = self.compensator.as_ref().filter(|compensator| compensator.is_on());
        let (mut u, limit) = match &self.law {
            ControlLaw::Pid(pid) => {
                let u = pid.drive(&mut state.pid, reference, x);
                (compensator.map_or(u, |feed| u + feed.drive(placed)), pid.limit())
            }
            ControlLaw::Adaptive(law) => {
                let direction = compensator.map_or_else(|| reference.v.sgn(), |feed| feed.direction(reference.v));
                let u = law.drive(&mut state.adaptive, reference, x, direction);
                (compensator.map_or(u, |feed| u + feed.effects_drive(placed)), law.limit())
            }
        };
        if let Some(feed) = compensator {
            u = feed.inverse(u, reference.v);
        }
        // A comparison that is false for NaN.
        if u.abs() <= limit {
            match &self.law {
                ControlLaw::Pid(pid) => pid.update(&mut state.pid),
                ControlLaw::Adaptive(law) => law.update(&mut state.adaptive),
            }
            return Some(LimitedDrive { u, saturated: false });
        }
        // An infinite drive too: its excess would make the integral infinite, and the next drive NaN.
        if !u.is_finite() {
            return None;
        }
        let cut = if u > limit { limit } else { -limit };
        match &self.law {
            ControlLaw::Pid(pid) => pid.cut(&mut state.pid, cut - u),
            ControlLaw::Adaptive(law) => law.cut(&mut state.adaptive, cut - u),
        }
        Some(LimitedDrive { u: cut, saturated: true })
    }
}

#[cfg(test)]
mod tests;
