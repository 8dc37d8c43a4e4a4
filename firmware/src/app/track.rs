//! Track and Hold: the controllers of [`breakaway_core::control`] along a trajectory, in f32.

use breakaway_core::control::{Controller as Law, ControllerState, Profile, Setpoint, Sine};

use super::control::Controller;

/// A reference relative to the start, position units.
#[derive(Clone, Copy, Debug)]
pub enum Path {
    /// The start.
    Hold,
    /// A sine, without end.
    Sine(Sine<f32>),
    /// A triangle from the start upwards, without end.
    Triangle {
        /// Peak.
        amplitude: f32,
        /// Advance per tick, units of 2⁻³² turn.
        phase_step: u32,
        /// Speed on its sides, position units per second.
        speed: f32,
    },
    /// A step at the start.
    Step(f32),
    /// Rest to rest, `10τ³ − 15τ⁴ + 6τ⁵`.
    MinimumJerk {
        /// Size.
        distance: f32,
        /// Ticks, as a number to multiply with.
        per_ticks: f32,
        /// Seconds, as a number to multiply with.
        per_s: f32,
        /// Ticks.
        ticks: u32,
    },
    /// There and back within limits of speed, acceleration and jerk, without end.
    Profile(Profile<f32>),
}

impl Path {
    /// The reference at tick `k`.
    fn at(&self, k: u32) -> Setpoint<f32> {
        match *self {
            Self::Hold => Setpoint::default(),
            Self::Sine(ref sine) => sine.at(k),
            Self::Profile(ref profile) => profile.at(k),
            Self::Step(x) => Setpoint { x, v: 0.0, a: 0.0 },
            Self::Triangle { amplitude, phase_step, speed } => {
                // A quarter turn on, the fold is at the half turn: −1 … 1 in Q30.
                let phase = phase_step.wrapping_mul(k).wrapping_add(1 << 30).cast_signed();
                let height = (1_i64 << 30) - i64::from(phase.unsigned_abs());
                let x = amplitude * (-(height as f32) * (1.0 / 1_073_741_824.0));
                Setpoint { x, v: if phase >= 0 { speed } else { -speed }, a: 0.0 }
            }
            Self::MinimumJerk { distance, per_ticks, per_s, ticks } => {
                let t = if k >= ticks { 1.0 } else { k as f32 * per_ticks };
                let rest = t * (1.0 - t);
                Setpoint {
                    x: distance * t * t * t * (10.0 + t * (6.0 * t - 15.0)),
                    v: distance * per_s * 30.0 * rest * rest,
                    a: distance * per_s * per_s * 60.0 * rest * (1.0 - 2.0 * t),
                }
            }
        }
    }
}

/// What the thread has worked out of a command: everything in the tick's units.
#[derive(Clone, Copy, Debug)]
pub struct TrackPlan {
    /// Who follows.
    pub law: Law<f32>,
    /// What.
    pub path: Path,
    /// Position units per count.
    pub position_per_count: f32,
    /// Counts per position unit.
    pub counts_per_position: f32,
    /// Drive codes per drive unit.
    pub codes_per_drive: f32,
}

#[derive(Clone, Copy, Debug)]
struct Running {
    plan: TrackPlan,
    state: ControllerState<f32>,
    /// Where it started, position units: what of the model depends on the position is evaluated there.
    origin: f32,
    k: u32,
}

/// The controller in the tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrackController {
    running: Option<Running>,
}

impl Controller for TrackController {
    type Plan = TrackPlan;

    fn start(&mut self, plan: &TrackPlan, count: i32) {
        let origin = count as f32 * plan.position_per_count;
        self.running = Some(Running { plan: *plan, state: ControllerState::start(&plan.law), origin, k: 0 });
    }

    fn tick(&mut self, distance: i32) -> Option<(i32, i32)> {
        let Running { plan, state, origin, k } = self.running.as_mut()?;
        let reference = plan.path.at(*k);
        *k = k.saturating_add(1);
        let command = plan.law.tick_from(state, reference, distance as f32 * plan.position_per_count, *origin);
        if !command.u.is_finite() {
            return None;
        }
        Some((round(command.u * plan.codes_per_drive), round(reference.x * plan.counts_per_position)))
    }

    fn finished(&self) -> bool {
        // A move ends where the next begins: it is held until it is stopped.
        false
    }
}

/// To the nearest integer; saturates.
fn round(value: f32) -> i32 {
    (value + if value < 0.0 { -0.5 } else { 0.5 }) as i32
}
