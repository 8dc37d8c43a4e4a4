//! From an experiment to the commands that start it.

use breakaway_core::excite::waveform::Shape;
use breakaway_core::link::{
    Bounds, Command, ControllerGains, ErrorRate, OpenLoop, Pid, Reference, Relay, Track, Trajectory,
};

use super::waveform;
use crate::device::scale::Scale;
use crate::device::{DeviceError, text};
use crate::simulate::experiment::{self, Excitation, Experiment};

/// The commands that start an experiment on the board.
///
/// # Errors
/// [`DeviceError::Range`] names the field that the board cannot do.
pub fn commands(experiment: &Experiment, scale: &Scale) -> Result<Vec<Command>, DeviceError> {
    let bounds = Bounds {
        max_ticks: scale.ticks("duration_s", experiment.duration_s)?,
        drive_max_code: match experiment.drive_limit {
            limit if limit >= scale.drive_max() => 0,
            limit => scale.code("drive_limit", limit)?,
        },
        travel_counts: match experiment.travel_limit {
            f64::INFINITY => 0,
            limit => scale.counts("travel_limit", limit)?.max(1),
        },
    };
    let centring = |centring: f64| {
        let q16 = (centring * scale.step / scale.drive(1) * 65_536.0).round();
        if q16 <= f64::from(i32::MAX) {
            Ok(q16 as i32)
        } else {
            Err(DeviceError::Range { what: "excitation.centring", value: centring, need: "less".to_owned() })
        }
    };
    let start = match experiment.excitation {
        Excitation::Relay { h1, h2, hysteresis, reference } => {
            let total = scale.drive_max();
            if h1 + h2 > total {
                let need = format!("h1 + h2 is at most {total} {}", scale.units.u);
                return Err(DeviceError::Range { what: "excitation.h1 + h2", value: h1 + h2, need });
            }
            let hysteresis =
                hysteresis.map(|band| scale.counts("excitation.hysteresis", (band / scale.step).ceil() * scale.step));
            let h1_code = scale.code("excitation.h1", h1)?;
            // Both rounded up can be one code more than there is.
            let h2_code = scale.code("excitation.h2", h2)?.min(i16::MAX - h1_code);
            Command::StartRelay(Relay {
                h1_code,
                h2_code,
                hysteresis_counts: hysteresis.transpose()?,
                reference: moving(reference, scale)?,
                until_settled: false,
                append: false,
                bounds,
            })
        }
        Excitation::Multisine { amplitude, from_hz, to_hz, centring: pull } => {
            let (parts, period_s) = waveform::multisine(from_hz, to_hz, experiment.seed)?;
            let start = Command::StartDrive(OpenLoop {
                shape: Shape::Table,
                amplitude_code: scale.code("excitation.amplitude", amplitude)?,
                phase_step: scale.phase_step("1/excitation.from_hz", period_s)?,
                centring_q16: centring(pull)?,
                bounds,
            });
            return Ok(parts.into_iter().map(Command::LoadWaveform).chain([start]).collect());
        }
        Excitation::Sine { amplitude, frequency_hz, centring: pull } => Command::StartDrive(OpenLoop {
            shape: Shape::Sine,
            amplitude_code: scale.code("excitation.amplitude", amplitude)?,
            phase_step: scale.phase_step("1/excitation.frequency_hz", 1.0 / frequency_hz)?,
            centring_q16: centring(pull)?,
            bounds,
        }),
        Excitation::Ramp { amplitude, period_s, centring: pull } => Command::StartDrive(OpenLoop {
            shape: Shape::Ramp,
            amplitude_code: scale.code("excitation.amplitude", amplitude)?,
            phase_step: scale.phase_step("excitation.period_s", 2.0 * period_s)?,
            centring_q16: centring(pull)?,
            bounds,
        }),
        Excitation::Track { kp, kd, reference } => Command::StartTrack(Track {
            trajectory: trajectory(reference),
            controller: ControllerGains::Pid(Pid {
                kp: kp as f32,
                ki: 0.0,
                kd: kd as f32,
                error_rate: ErrorRate { filter_s: filter_s(kp, kd, scale.tick_s()) as f32, observer_rad_s: 0.0 },
            }),
            feed_forward: false,
            compensation: false,
            bounds,
        }),
    };
    start.validate().map_err(|error| DeviceError::Refused { command: text::command_name(&start), error })?;
    Ok(vec![start])
}

fn moving(reference: experiment::Reference, scale: &Scale) -> Result<Reference, DeviceError> {
    let (shape, amplitude, period_s) = match reference {
        experiment::Reference::Start => return Ok(Reference::default()),
        experiment::Reference::Triangle { amplitude, period_s } => (Shape::Triangle, amplitude, period_s),
        experiment::Reference::Sine { amplitude, period_s } => (Shape::Sine, amplitude, period_s),
    };
    Ok(Reference {
        shape,
        amplitude_counts: scale.counts("reference.amplitude", amplitude)? as i32,
        phase_step: scale.phase_step("reference.period_s", period_s)?,
    })
}

fn trajectory(reference: experiment::Reference) -> Trajectory {
    match reference {
        experiment::Reference::Start => Trajectory::Hold,
        experiment::Reference::Triangle { amplitude, period_s } => {
            Trajectory::Triangle { amplitude: amplitude as f32, period_s: period_s as f32 }
        }
        experiment::Reference::Sine { amplitude, period_s } => {
            Trajectory::Sine { amplitude: amplitude as f32, period_s: period_s as f32 }
        }
    }
}

/// Filter of ė for a loop with these gains, s. It is an eighth of 1/ωc, as in `tune`, and the zero kp/kd is at ωc/2.
/// It is at least two ticks, because a count is coarse.
fn filter_s(kp: f64, kd: f64, tick_s: f64) -> f64 {
    let eighth = if kp > 0.0 { kd / (16.0 * kp) } else { 0.0 };
    eighth.max(2.0 * tick_s)
}
