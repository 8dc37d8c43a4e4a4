//! Track and Hold: the controllers of [`breakaway_core::control`] along a trajectory, in f32 or, on a core without an FPU, in Q32.

use breakaway_core::control::{Controller, ControllerState, Fast, Profile, Setpoint, Sine};
use breakaway_core::link::Ending;

use super::control::{ControlPlan, PositionController};
use super::current::{CurrentPlan, CurrentRun};
use super::follow::{FollowRules, Follower, Knot};
use super::set_points::SetPointOutlet;
use crate::board::Applied;

/// A reference relative to the start, position units.
#[derive(Clone, Copy, Debug)]
pub enum Path<R> {
    /// The start.
    Hold,
    /// A sine, without end.
    Sine(Sine<R>),
    /// A triangle from the start upwards, without end.
    Triangle {
        /// Peak.
        amplitude: R,
        /// Advance per tick, units of 2⁻³² turn.
        phase_step: u32,
        /// Speed on its sides, position units per second.
        speed: R,
    },
    /// A step at the start.
    Step(R),
    /// Rest to rest, `10τ³ − 15τ⁴ + 6τ⁵`.
    MinimumJerk {
        /// Size.
        distance: R,
        /// Ticks, as a number to multiply with.
        per_ticks: R,
        /// Seconds, as a number to multiply with.
        per_s: R,
        /// Ticks.
        ticks: u32,
    },
    /// There and back within limits of speed, acceleration and jerk, without end.
    Profile(Profile<R>),
    /// Set-points as they come.
    Follow(FollowRules),
}

impl<R: Fast> Path<R> {
    /// The reference at tick `k`.
    fn at(&self, k: u32) -> Setpoint<R> {
        match *self {
            // What is sent is not a function of the tick.
            Self::Hold | Self::Follow(_) => Setpoint::default(),
            Self::Sine(ref sine) => sine.at(k),
            Self::Profile(ref profile) => profile.at(k),
            Self::Step(x) => Setpoint { x, v: R::ZERO, a: R::ZERO },
            Self::Triangle { amplitude, phase_step, speed } => {
                // A quarter turn on, the fold is at the half turn: −1 … 1 in Q30.
                let phase = phase_step.wrapping_mul(k).wrapping_add(1 << 30).cast_signed();
                let height = (1_i64 << 30) - i64::from(phase.unsigned_abs());
                // From −2³⁰ to 2³⁰.
                let x = -amplitude * R::from_i32(height as i32) * R::from_f64(1.0 / 1_073_741_824.0);
                Setpoint { x, v: if phase >= 0 { speed } else { -speed }, a: R::ZERO }
            }
            Self::MinimumJerk { distance, per_ticks, per_s, ticks } => {
                // Fewer than 2³¹ ticks.
                let t = if k >= ticks { R::ONE } else { R::from_i32(k as i32) * per_ticks };
                let [six, ten, fifteen, thirty, sixty] = [6, 10, 15, 30, 60].map(R::from_i32);
                let rest = t * (R::ONE - t);
                Setpoint {
                    x: distance * t * t * t * (ten + t * (six * t - fifteen)),
                    v: distance * per_s * thirty * rest * rest,
                    a: distance * per_s * per_s * sixty * rest * (R::ONE - t - t),
                }
            }
        }
    }
}

/// What the thread has worked out of a command: everything in the tick's units.
#[derive(Clone, Copy, Debug)]
pub struct TrackPlan<R = f32> {
    /// Who follows.
    pub law: Controller<R>,
    /// What.
    pub path: Path<R>,
    /// Position units per count.
    pub position_per_count: R,
    /// Counts per position unit.
    pub counts_per_position: R,
    /// Drive codes per drive unit.
    pub codes_per_drive: R,
}

#[derive(Clone, Copy, Debug)]
struct Running<R> {
    plan: TrackPlan<R>,
    state: ControllerState<R>,
    /// Where it started, position units: what of the model depends on the position is evaluated there.
    origin: R,
    follower: Follower<R>,
    k: u32,
    saturated: u32,
}

/// The controller in the tick.
#[derive(Clone, Copy, Debug)]
pub struct TrackController<R = f32> {
    running: Option<Running<R>>,
    current: Option<CurrentRun<R>>,
}

impl<R> Default for TrackController<R> {
    fn default() -> Self {
        Self { running: None, current: None }
    }
}

impl<R: Fast> ControlPlan for TrackPlan<R> {
    type Knot = Knot<R>;
    type Current = CurrentPlan<R>;
}

impl<R: Fast> PositionController for TrackController<R> {
    type Plan = TrackPlan<R>;

    fn start(&mut self, plan: &TrackPlan<R>, count: i32) {
        let origin = R::from_i32(count) * plan.position_per_count;
        let (state, follower) = (ControllerState::start(&plan.law), Follower::new());
        self.running = Some(Running { plan: *plan, state, origin, follower, k: 0, saturated: 0 });
    }

    fn tick(&mut self, distance: i32, points: &mut SetPointOutlet<'_, Knot<R>>) -> Option<(i32, i32)> {
        let Running { plan, state, origin, follower, k, saturated } = self.running.as_mut()?;
        let reference = match plan.path {
            Path::Follow(rules) => follower.tick(rules, points)?,
            ref path => path.at(*k),
        };
        *k = k.saturating_add(1);
        let command = plan.law.tick_from(state, reference, R::from_i32(distance) * plan.position_per_count, *origin)?;
        *saturated = saturated.saturating_add(u32::from(command.saturated));
        Some(((command.u * plan.codes_per_drive).to_i32(), (reference.x * plan.counts_per_position).to_i32()))
    }

    fn start_current(&mut self, plan: CurrentPlan<R>) {
        self.current = Some(CurrentRun::new(plan));
    }

    fn voltage(&mut self, drive_code: i32, current_ma: i32) -> Option<i32> {
        self.current.as_mut()?.voltage(drive_code, current_ma)
    }

    fn applied(&mut self, asked: i32, applied: Applied) -> i16 {
        self.current.as_mut().map_or(0, |current| current.applied(asked, applied))
    }

    fn saturated(&self) -> u32 {
        self.running.as_ref().map_or(0, |running| running.saturated)
    }

    fn ending(&self) -> Option<Ending> {
        // A move ends where the next begins: it is held until it is stopped. Set-points have an end.
        self.running.as_ref()?.follower.ending
    }
}
