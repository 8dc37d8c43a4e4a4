//! From a command to what the controller in the tick needs.

use breakaway_core::control::{
    Adaptation, Adaptive, AdaptiveError, Compensator, Controller, CurrentLoop, CurrentLoopError, Estimates, Fast,
    Gains, Phases, Pid, Profile, Sine, TuningError, Winding, lead_s, least_delta,
};
use breakaway_core::excite::waveform::phase_step;
use breakaway_core::link::{
    CommandError, ControllerGains, FULL_SCALE_CODE, Field, Model, SetPoint, Settings, Track, Trajectory,
};
use breakaway_core::plant::{Base, Effect, MAX_EFFECTS};

use crate::app::control::{ControlPlan, NoController, PositionController};
use crate::app::current::CurrentPlan;
use crate::app::follow::{FollowRules, Knot};
use crate::app::track::{Path, TrackController, TrackPlan};

/// Makes plans for a [`PositionController`].
pub trait Planner {
    /// As [`PositionController::Plan`].
    type Plan: ControlPlan;

    /// The plan for a checked command.
    ///
    /// # Errors
    /// What the host is told: a field out of range for this machine, a missing model, or that this build cannot do it.
    fn plan(
        &self,
        track: &Track,
        model: Option<&Model>,
        settings: &Settings,
        tick_hz: u32,
    ) -> Result<Self::Plan, CommandError>;

    /// The current loop of checked settings whose drive is a current.
    ///
    /// # Errors
    /// The setting that is out of range for it, or that this build cannot do it.
    fn current(&self, settings: &Settings, tick_hz: u32) -> Result<<Self::Plan as ControlPlan>::Current, CommandError>;

    /// A checked set-point in the controller's numbers; `None` where no plan can be made either.
    fn knot(&self, point: &SetPoint, tick_hz: u32) -> Option<<Self::Plan as ControlPlan>::Knot>;
}

impl Planner for NoController {
    type Plan = <NoController as PositionController>::Plan;

    fn plan(&self, _: &Track, _: Option<&Model>, _: &Settings, _: u32) -> Result<Self::Plan, CommandError> {
        Err(CommandError::Unsupported)
    }

    fn current(&self, _: &Settings, _: u32) -> Result<core::convert::Infallible, CommandError> {
        Err(CommandError::Unsupported)
    }

    fn knot(&self, _: &SetPoint, _: u32) -> Option<core::convert::Infallible> {
        None
    }
}

/// From a reading to its drive, whole ticks: it is applied in the same one.
const DELAY_TICKS: u32 = 0;
/// From the reading of the current to the middle of the voltage's hold, ticks. At most half of one passes until the
/// PWM takes it over; the rest is half of the hold.
const CURRENT_DELAY_TICKS: f32 = 1.0;
/// Inertia of a compensator that is to have none: its product with any acceleration is nothing.
const NO_INERTIA: f32 = 1e-30;

impl<R: Fast> Planner for TrackController<R> {
    type Plan = TrackPlan<R>;

    fn plan(
        &self,
        track: &Track,
        model: Option<&Model>,
        settings: &Settings,
        tick_hz: u32,
    ) -> Result<TrackPlan<R>, CommandError> {
        // The gains' limits follow from the inertia: without a model they cannot be checked.
        let model = model.ok_or(CommandError::Range(Field::B))?;
        let base: Base<f32> = model.base()?;
        let tick_s = 1.0 / tick_hz.max(1) as f32;
        // The limit in force, of the settings (none above the power stage's is taken) and of the run: what the drive saturates at.
        let limit_code = match track.bounds.drive_max_code {
            bound @ 1.. => bound.min(settings.drive_max_code),
            _ => settings.drive_max_code,
        };
        let limit = settings.drive_full_scale * f32::from(limit_code) / f32::from(FULL_SCALE_CODE);
        let (path, speed, acceleration) = path(&track.trajectory, tick_hz)?;
        // Each number is finite; their products need not be, and what they drive would be none.
        if !(speed.is_finite() && acceleration.is_finite()) {
            return Err(CommandError::Range(Field::TrajectorySize));
        }
        let law = match track.controller {
            ControllerGains::Pid(wire) => {
                let kd = wire.kd;
                if kd <= 0.0 {
                    return Err(CommandError::Range(Field::Kd));
                }
                let gains = Gains {
                    b: base.b,
                    kv: kd / base.b,
                    lambda1: wire.ki / kd,
                    lambda2: wire.kp / kd,
                    filter_s: wire.error_rate.filter_s,
                    observer_rad_s: wire.error_rate.observer_rad_s,
                };
                let pid = Pid::new(&gains, tick_s, limit).map_err(|error| CommandError::Range(tuning(error)))?;
                Controller::pid(pid.with_rest_band(f64::from(settings.position_per_count)))
            }
            // Its rates need the largest speed and acceleration beforehand.
            ControllerGains::Adaptive(_) if matches!(path, Path::Follow(_)) => return Err(CommandError::Unsupported),
            ControllerGains::Adaptive(wire) => {
                let gains = Gains {
                    b: base.b,
                    kv: wire.kv,
                    lambda1: wire.lambda1,
                    lambda2: wire.lambda2,
                    filter_s: wire.error_rate.filter_s,
                    observer_rad_s: wire.error_rate.observer_rad_s,
                };
                // Less a rounding: the host works it out in its own numbers.
                if wire.delta < 0.999 * least_delta(settings.position_per_count, &gains, tick_s) {
                    return Err(CommandError::Range(Field::Delta));
                }
                let start = Estimates { b: base.b, c: base.c, f1: base.f1, f: 0.0 };
                let unit = Adaptation::normalised(&start, 1.0, speed, acceleration, wire.delta);
                // Gains go with the square of the rate; a and f2 act on one and the same parameter.
                let [a, b, f1, f2, f] = wire.rates.map(|rate| rate * rate);
                let scaled = Estimates {
                    b: unit.gains.b * b,
                    c: unit.gains.c * (a + f2),
                    f1: unit.gains.f1 * f1,
                    f: unit.gains.f * f,
                };
                let adaptation = Adaptation { gains: scaled, ..unit };
                let law = Adaptive::new(&gains, &adaptation, &start, tick_s, 1, limit);
                Controller::adaptive(law.map_err(|error| CommandError::Range(adaptive(error)))?)
            }
        };
        let law = match compensator(track, model, &base, tick_s)? {
            Some(compensator) => law.with_compensator(compensator),
            None => law,
        };
        Ok(TrackPlan {
            law,
            path,
            position_per_count: real(settings.position_per_count),
            counts_per_position: real(1.0 / settings.position_per_count),
            codes_per_drive: real(f32::from(FULL_SCALE_CODE) / settings.drive_full_scale),
        })
    }

    #[inline(never)]
    fn current(&self, settings: &Settings, tick_hz: u32) -> Result<CurrentPlan<R>, CommandError> {
        let tick_s = 1.0 / tick_hz.max(1) as f32;
        let winding = Winding { resistance: settings.motor_resistance_ohm, inductance: settings.motor_inductance_h };
        let bandwidth = core::f32::consts::TAU * settings.current_bandwidth_hz;
        let full = f32::from(FULL_SCALE_CODE);
        let volt = full / settings.supply_v;
        let control = CurrentLoop::new(&winding, bandwidth, tick_s, CURRENT_DELAY_TICKS * tick_s, volt, 1000.0);
        let control = control.map_err(|error| {
            CommandError::Settings(match error {
                CurrentLoopError::Resistance => Field::Resistance,
                CurrentLoopError::Inductance => Field::Inductance,
                CurrentLoopError::Bandwidth => Field::CurrentBandwidth,
                CurrentLoopError::Tick => Field::Supply,
            })
        })?;
        let ma_per_code = 1000.0 * settings.drive_full_scale / full;
        Ok(CurrentPlan { control, ma_per_code: real(ma_per_code), codes_per_ma: real(1.0 / ma_per_code) })
    }

    fn knot(&self, point: &SetPoint, tick_hz: u32) -> Option<Knot<R>> {
        let (ticks, tick_hz) = (point.ticks as f32, tick_hz.max(1) as f32);
        let [per_ticks, duration_s, per_s] = [1.0 / ticks, ticks / tick_hz, tick_hz / ticks].map(real);
        Some(Knot { to: [point.position, point.velocity].map(real), ticks: point.ticks, per_ticks, duration_s, per_s })
    }
}

/// The path, its largest speed and acceleration.
pub(super) fn path<R: Fast>(trajectory: &Trajectory, tick_hz: u32) -> Result<(Path<R>, f32, f32), CommandError> {
    let tick_hz = tick_hz.max(1);
    let tick_s = 1.0 / tick_hz as f32;
    let wrong = CommandError::Range(Field::TrajectoryTime);
    Ok(match *trajectory {
        Trajectory::Hold => (Path::Hold, 0.0, 0.0),
        Trajectory::Follow { ahead, hold_ticks } => (Path::Follow(FollowRules { ahead, hold_ticks }), 0.0, 0.0),
        Trajectory::Step { distance } => (Path::Step(real(distance)), 0.0, 0.0),
        Trajectory::Sine { amplitude, period_s } => {
            let omega = core::f32::consts::TAU / period_s;
            let peak = amplitude.abs();
            let sine = Sine::of_period(amplitude, period_s * tick_hz as f32, tick_s).map_err(|_| wrong)?;
            (Path::Sine(sine), peak * omega, peak * omega * omega)
        }
        Trajectory::Triangle { amplitude, period_s } => {
            let phase_step = phase_step(period_s * tick_hz as f32).ok_or(wrong)?;
            let speed = 4.0 * amplitude / period_s;
            (Path::Triangle { amplitude: real(amplitude), phase_step, speed: real(speed) }, speed.abs(), 0.0)
        }
        Trajectory::MinimumJerk { distance, duration_s } => {
            let ticks = duration_s * tick_hz as f32;
            if !(1.0..2e9).contains(&ticks) {
                return Err(wrong);
            }
            let (size, per_s) = (distance.abs(), 1.0 / duration_s);
            let [whole, per_ticks, rate] = [distance, 1.0 / ticks, per_s].map(real);
            let path = Path::MinimumJerk { distance: whole, per_ticks, per_s: rate, ticks: ticks as u32 };
            // 15/8 and 10/√3: the peaks of the polynomial's derivatives.
            (path, 1.875 * size * per_s, 5.774 * size * per_s * per_s)
        }
        Trajectory::Profile { distance, jerk_ticks, acceleration_ticks, cruise_ticks, rest_ticks } => {
            let phases = Phases { jerk: jerk_ticks, acceleration: acceleration_ticks, cruise: cruise_ticks };
            let profile = Profile::in_ticks(distance, phases, tick_s).map_err(|_| wrong)?;
            let (speed, acceleration) = phases.peaks(distance, tick_hz as f32);
            (Path::Profile(profile.shuttle(rest_ticks)), speed, acceleration)
        }
    })
}

/// `None` where neither is asked for: off is absent.
fn compensator<R: Fast>(
    track: &Track,
    model: &Model,
    base: &Base<f32>,
    tick_s: f32,
) -> Result<Option<Compensator<R>>, CommandError> {
    if !track.feed_forward && !track.compensation {
        return Ok(None);
    }
    let (b, c) = if track.feed_forward { (base.b, base.c) } else { (NO_INERTIA, 0.0) };
    let f1 = if track.compensation { base.f1 } else { 0.0 };
    let mut effects: heapless::Vec<Effect<f32>, MAX_EFFECTS> = heapless::Vec::new();
    let wanted = if track.compensation { model.effects.len() } else { 0 };
    for effect in (0..wanted).filter_map(|index| model.effect(index)) {
        // As many as the model can hold.
        let _ = effects.push(effect?);
    }
    let ahead_s = lead_s(tick_s, DELAY_TICKS);
    let compensator = Compensator::new(&Base { b, c, f1 }, &effects).and_then(|one| one.with_lead(ahead_s));
    Ok(Some(compensator.map_err(|_| CommandError::Range(Field::EffectParameters))?.on()))
}

/// A number of the link as the tick has it.
fn real<R: Fast>(value: f32) -> R {
    R::from_f64(f64::from(value))
}

fn tuning(error: TuningError) -> Field {
    match error {
        TuningError::B => Field::B,
        TuningError::C => Field::C,
        TuningError::Limit => Field::DriveMax,
        TuningError::Tick | TuningError::Gain | TuningError::Bandwidth { .. } => Field::Kp,
        TuningError::Rate { .. } => Field::Kd,
    }
}

fn adaptive(error: AdaptiveError) -> Field {
    match error {
        AdaptiveError::Gains(TuningError::Rate { .. } | TuningError::Gain) => Field::Kv,
        AdaptiveError::Gains(error) => tuning(error),
        AdaptiveError::Delta => Field::Delta,
        AdaptiveError::Start | AdaptiveError::SmallestB => Field::B,
        AdaptiveError::Motion => Field::TrajectorySize,
        AdaptiveError::Sigma
        | AdaptiveError::B { .. }
        | AdaptiveError::C { .. }
        | AdaptiveError::F1 { .. }
        | AdaptiveError::F { .. } => Field::Rates,
    }
}
