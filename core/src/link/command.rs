//! What the host asks of the device.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::{CommandError, Model, Rejected, SetPoints, Settings};
use crate::excite::waveform::Shape;

/// A command and the id under which it is answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Chosen by the host; the reply carries it back.
    pub id: u16,
    /// The command.
    pub command: Command,
}

/// A command. Each is answered, by [`Reply::Done`](super::Reply::Done) where nothing else is said, or by
/// [`Reply::Error`](super::Reply::Error).
///
/// New commands are added at the end: the position is the number on the wire.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Who are you? Answered by [`Reply::Info`](super::Reply::Info). Never changes (number 0, no content).
    Hello,
    /// What are you doing? Answered by [`Reply::Status`](super::Reply::Status); keeps the command time-out off.
    Status,
    /// Answered by [`Reply::Settings`](super::Reply::Settings).
    GetSettings,
    /// Uses these settings from now on (not across a reset: [`Command::Save`]). Only while idle.
    SetSettings(Settings),
    /// Answered by [`Reply::Model`](super::Reply::Model).
    GetModel,
    /// Uses this model from now on (not across a reset: [`Command::Save`]). Only while idle.
    LoadModel(Model),
    /// Keeps settings and model across resets. Only while idle.
    Save,
    /// Starts a dual-relay experiment.
    StartRelay(Relay),
    /// Starts an open-loop drive.
    StartDrive(OpenLoop),
    /// Starts position control.
    StartTrack(Track),
    /// Loads a part of the waveform table ([`Shape::Table`]). Only while idle.
    LoadWaveform(WaveformPart),
    /// Solves the sums of the last relay experiments. Answered by [`Reply::Identified`](super::Reply::Identified).
    Identify,
    /// Ends what is running; the drive goes to 0. Done also when nothing runs.
    Stop,
    /// Sends every n-th sample from now on.
    StreamOn {
        /// n, ≥ 1.
        decimation: u16,
    },
    /// Sends no more samples.
    StreamOff,
    /// Answered by [`Reply::Fault`](super::Reply::Fault).
    GetFault,
    /// Forgets the latched fault; the device is idle again.
    ClearFault,
    /// Resets the device, after the reply has gone out.
    Reboot,
    /// Calls the present position this count; the travel limits hold from there on. Only while idle.
    Zero {
        /// The count from now on.
        count: i32,
    },
    /// Pushes the axis without looking at the travel limits: [`Push`].
    Jog(Push),
    /// Pushes the axis against a stop, where it stands for `frozen_ticks`; the count there is then `at`.
    Home {
        /// How. Its bounds end it where no stop is found.
        push: Push,
        /// The count at the stop.
        at: i32,
    },
    /// The next set-points of a run along [`Trajectory::Follow`]. Answered by [`Reply::Following`](super::Reply::Following).
    SetPoints(SetPoints),
}

/// When an experiment ends by itself, in addition to the limits of the settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bounds {
    /// After this many ticks; 0: only when stopped.
    pub max_ticks: u32,
    /// Largest drive either way, drive codes; 0: that of the settings, which is never exceeded.
    pub drive_max_code: i16,
    /// Ends further than this from where it started, counts; 0: only the settings' travel limits hold.
    pub travel_counts: u32,
}

/// A position around the start: `amplitude · shape(phase)`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reference {
    /// Its period.
    pub shape: Shape,
    /// Peak, counts, ≥ 0.
    pub amplitude_counts: i32,
    /// Advance per tick, units of 2⁻³² turn, ≤ 2³¹.
    pub phase_step: u32,
}

/// A dual-relay experiment, `u = h1·sgn(e) + h2·sgn(Σe)` ([`crate::excite::relay`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Relay {
    /// Amplitude on the error, drive codes, > 0.
    pub h1_code: i16,
    /// Amplitude on the error's sum, drive codes, > 0; h1 + h2 ≤ [`FULL_SCALE_CODE`](super::FULL_SCALE_CODE).
    pub h2_code: i16,
    /// Hysteresis on the error, counts ≤ 2³⁰; `None`: that of the settings.
    pub hysteresis_counts: Option<u32>,
    /// What the error is taken against.
    pub reference: Reference,
    /// Ends as soon as the limit cycle has settled, or cannot.
    pub until_settled: bool,
    /// Adds to the sums of the relay experiments before, instead of starting anew.
    pub append: bool,
    /// Further ends.
    pub bounds: Bounds,
}

/// An open-loop drive `amplitude · shape(phase) + centring · (start − count)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OpenLoop {
    /// Its period.
    pub shape: Shape,
    /// Peak, drive codes, > 0.
    pub amplitude_code: i16,
    /// Advance per tick, units of 2⁻³² turn, ≤ 2³¹.
    pub phase_step: u32,
    /// Pull towards the start, drive codes per count in Q16, ≥ 0.
    pub centring_q16: i32,
    /// Further ends.
    pub bounds: Bounds,
}

/// A constant drive that the motor can stand for ever: at most `mean_drive_max_code`. It may leave the travel limits, where these
/// are not referred to a zero yet, and may lead back between them from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Push {
    /// Drive codes, signed, not 0.
    pub drive_code: i16,
    /// Its ends; `max_ticks` ≥ 1.
    pub bounds: Bounds,
}

/// Position control along a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// What is followed.
    pub trajectory: Trajectory,
    /// Who follows.
    pub controller: ControllerGains,
    /// Adds `b·ẍ + c·ẋ` of the reference, from the loaded model.
    pub feed_forward: bool,
    /// Adds the loaded model's friction and effects at the reference. Off is bit-identical to absent.
    pub compensation: bool,
    /// Further ends.
    pub bounds: Bounds,
}

/// A reference relative to the position at the start; position units and seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Trajectory {
    /// Where it is.
    Hold,
    /// Sine, from the start upwards.
    Sine {
        /// Peak, finite.
        amplitude: f32,
        /// > 0.
        period_s: f32,
    },
    /// Triangle, from the start upwards.
    Triangle {
        /// Peak, finite.
        amplitude: f32,
        /// > 0.
        period_s: f32,
    },
    /// A step.
    Step {
        /// Size, finite.
        distance: f32,
    },
    /// Rest to rest with the least jerk: `10τ³ − 15τ⁴ + 6τ⁵`.
    MinimumJerk {
        /// Size, finite.
        distance: f32,
        /// > 0.
        duration_s: f32,
    },
    /// Trapezoid of velocity, or with jerk phases an S-curve. It goes there and back with a rest at both ends
    /// ([`Profile`](crate::control::Profile)): 4·jerk + 2·acceleration + cruise below 2³⁰, and jerk or acceleration
    /// above 0.
    Profile {
        /// Size, finite.
        distance: f32,
        /// Ticks of each phase of changing acceleration; 0 for a trapezoid.
        jerk_ticks: u32,
        /// Ticks of constant acceleration.
        acceleration_ticks: u32,
        /// Ticks of constant speed.
        cruise_ticks: u32,
        /// Ticks of rest, below 2³⁰.
        rest_ticks: u32,
    },
    /// The set-points that the host sends meanwhile ([`Command::SetPoints`]).
    Follow {
        /// So many wait on the device before it moves, at the start and after it had none: 1 ..= [`MOST_AHEAD`](super::MOST_AHEAD).
        ahead: u8,
        /// Without set-points it holds the last one for so many ticks, then the run ends: 1 ..= 2²⁴.
        hold_ticks: u32,
    },
}

/// A position controller with its gains, in drive and position units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControllerGains {
    /// `kp·e + ki·∫e + kd·ė`.
    Pid(Pid),
    /// The adaptive law (docs/theory.md, section 6), started from the loaded model.
    Adaptive(Adaptive),
}

/// PID gains, each finite and ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pid {
    /// Drive per position.
    pub kp: f32,
    /// Drive per position and second.
    pub ki: f32,
    /// Drive per velocity.
    pub kd: f32,
    /// How ė is made.
    pub error_rate: ErrorRate,
}

/// How ė is made of the error behind an encoder (docs/control.md, section "The encoder"); each finite and ≥ 0. Both 0 is the plain
/// difference of two readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorRate {
    /// Time constant of the filter, s; 0 for none.
    pub filter_s: f32,
    /// Bandwidth of the tracking observer, rad/s; 0 for none.
    pub observer_rad_s: f32,
}

/// Gains of the adaptive law, each finite and ≥ 0; `kv`, `lambda1`, `lambda2`, `delta` > 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adaptive {
    /// Kv, 1/s.
    pub kv: f32,
    /// Λ1, 1/s².
    pub lambda1: f32,
    /// Λ2, 1/s.
    pub lambda2: f32,
    /// δ, position per second: half-width of the boundary layer.
    pub delta: f32,
    /// How ė is made.
    pub error_rate: ErrorRate,
    /// Adaptation rates of a, b, f1, f2 and f, relative to the parameters' scale.
    pub rates: [f32; 5],
}

/// Points of the waveform table from `offset` on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WaveformPart {
    /// Index of the first point.
    pub offset: u16,
    /// Q15; offset + length ≤ [`TABLE_POINTS`](crate::excite::waveform::TABLE_POINTS).
    pub points: Vec<i16, 64>,
}

impl Request {
    /// Reads a request from a frame's message.
    ///
    /// # Errors
    /// [`Rejected`] with the id to answer under, where that much could be read.
    pub fn decode(message: &[u8]) -> Result<Self, Rejected> {
        match postcard::take_from_bytes(message) {
            Ok((request, [])) => Ok(request),
            Ok(_) | Err(_) => Err(Rejected {
                id: postcard::take_from_bytes::<u16>(message).ok().map(|(id, _)| id),
                error: CommandError::Malformed,
            }),
        }
    }
}
