//! The ranges of a command's numbers.

use super::{
    Adaptive, Bounds, Command, CommandError, ControllerGains, ErrorRate, Field, MOST_AHEAD, OpenLoop, Pid, Push,
    Reference, Relay, Track, Trajectory,
};
use crate::control::Phases;
use crate::excite::waveform::TABLE_POINTS;

impl Command {
    /// Checks every number of the command against its range; the device's state and settings are not looked at.
    ///
    /// # Errors
    /// [`CommandError`] names the field.
    pub fn validate(&self) -> Result<(), CommandError> {
        match self {
            Self::SetSettings(settings) => settings.validate().map_err(CommandError::Settings),
            Self::LoadModel(model) => model.validate(),
            Self::StartRelay(relay) => relay.validate(),
            Self::StartDrive(drive) => drive.validate(),
            Self::StartTrack(track) => track.validate(),
            Self::LoadWaveform(part) => {
                let end = usize::from(part.offset) + part.points.len();
                range(end <= TABLE_POINTS, Field::WaveformOffset)
            }
            Self::StreamOn { decimation } => range(*decimation >= 1, Field::Decimation),
            Self::Jog(push) | Self::Home { push, .. } => push.validate(),
            Self::SetPoints(points) => points.validate(),
            _ => Ok(()),
        }
    }
}

impl Bounds {
    fn validate(self) -> Result<(), CommandError> {
        range(self.drive_max_code >= 0, Field::BoundDrive)?;
        range(i32::try_from(self.travel_counts).is_ok(), Field::BoundTravel)
    }
}

impl Relay {
    fn validate(&self) -> Result<(), CommandError> {
        range(self.h1_code > 0, Field::H1)?;
        range(self.h2_code > 0 && self.h1_code.checked_add(self.h2_code).is_some(), Field::H2)?;
        range(self.hysteresis_counts.unwrap_or(0) <= 1 << 30, Field::Hysteresis)?;
        self.reference.validate()?;
        self.bounds.validate()
    }
}

impl Reference {
    fn validate(self) -> Result<(), CommandError> {
        range(self.amplitude_counts >= 0, Field::ReferenceAmplitude)?;
        range(self.phase_step <= 1 << 31, Field::PhaseStep)
    }
}

impl OpenLoop {
    fn validate(&self) -> Result<(), CommandError> {
        range(self.amplitude_code > 0, Field::Amplitude)?;
        range(self.phase_step <= 1 << 31, Field::PhaseStep)?;
        range(self.centring_q16 >= 0, Field::Centring)?;
        self.bounds.validate()
    }
}

impl Push {
    fn validate(&self) -> Result<(), CommandError> {
        range(self.drive_code != 0 && self.drive_code != i16::MIN, Field::PushDrive)?;
        range(self.bounds.max_ticks >= 1, Field::PushTicks)?;
        self.bounds.validate()
    }
}

impl ErrorRate {
    fn validate(self) -> Result<(), CommandError> {
        range(self.filter_s.is_finite() && self.filter_s >= 0.0, Field::Filter)?;
        range(self.observer_rad_s.is_finite() && self.observer_rad_s >= 0.0, Field::Observer)
    }
}

impl Track {
    fn validate(&self) -> Result<(), CommandError> {
        let finite = |value: f32| range(value.is_finite(), Field::TrajectorySize);
        let positive = |value: f32| range(value.is_finite() && value > 0.0, Field::TrajectoryTime);
        match self.trajectory {
            Trajectory::Hold => {}
            Trajectory::Follow { ahead, hold_ticks } => {
                range((1..=MOST_AHEAD).contains(&usize::from(ahead)), Field::Ahead)?;
                range((1..=1 << 24).contains(&hold_ticks), Field::HoldTicks)?;
            }
            Trajectory::Step { distance } => finite(distance)?,
            Trajectory::Sine { amplitude: size, period_s: time }
            | Trajectory::Triangle { amplitude: size, period_s: time }
            | Trajectory::MinimumJerk { distance: size, duration_s: time } => {
                finite(size)?;
                positive(time)?;
            }
            Trajectory::Profile { distance, jerk_ticks, acceleration_ticks, cruise_ticks, rest_ticks } => {
                finite(distance)?;
                let phases = Phases { jerk: jerk_ticks, acceleration: acceleration_ticks, cruise: cruise_ticks };
                range(phases.ticks().is_some() && rest_ticks < 1 << 30, Field::TrajectoryTime)?;
            }
        }
        let gain = |value: f32, field| range(value.is_finite() && value >= 0.0, field);
        match self.controller {
            ControllerGains::Pid(Pid { kp, ki, kd, error_rate }) => {
                gain(kp, Field::Kp)?;
                gain(ki, Field::Ki)?;
                gain(kd, Field::Kd)?;
                error_rate.validate()?;
            }
            ControllerGains::Adaptive(Adaptive { kv, lambda1, lambda2, delta, error_rate, rates }) => {
                error_rate.validate()?;
                for (value, field) in
                    [(kv, Field::Kv), (lambda1, Field::Lambda1), (lambda2, Field::Lambda2), (delta, Field::Delta)]
                {
                    range(value.is_finite() && value > 0.0, field)?;
                }
                for rate in rates {
                    gain(rate, Field::Rates)?;
                }
            }
        }
        self.bounds.validate()
    }
}

pub(super) fn range(valid: bool, field: Field) -> Result<(), CommandError> {
    if valid { Ok(()) } else { Err(CommandError::Range(field)) }
}
