//! One example of every message, with no number that is 0 by accident and extremes where they are longest.

use breakaway_core::excite::waveform::Shape;
use breakaway_core::link::*;
use breakaway_core::plant::{Effect, Kind};

pub fn text(text: &str) -> Text {
    Text::try_from(text).unwrap()
}

pub fn info() -> Info {
    Info {
        // Not the present ones: these bytes must not change with the version.
        protocol_version: 0x1234,
        schema: 0x8765_4321,
        firmware: text("0.1.0"),
        build: text("0123456789ab"),
        board: text("nucleo-g474re"),
        tick_hz: 10_000,
        counts_per_revolution: 4096,
        position_per_count: 0.001,
        position_unit: PositionUnit::Millimetre,
        drive_full_scale: 24.0,
        drive_unit: DriveUnit::NewtonMetre,
        current_range_ma: 3_300,
    }
}

pub fn settings() -> Settings {
    Settings { drive_max_code: 32_767, travel_min_counts: i32::MIN, travel_max_counts: i32::MAX, ..Settings::default() }
}

pub fn model() -> Model {
    let effects = [
        Effect::<f64>::new(Kind::Stribeck, &[0.3, 0.5]),
        Effect::new(Kind::ConstantLoad, &[-0.25]),
        Effect::new(Kind::Cogging, &[0.1, 7.0, 0.5]),
    ];
    Model { b: 0.026_85, c: 0.11, f1: 0.5, effects: effects.iter().map(WireEffect::new).collect() }
}

/// A model as long as a model can be: six effects of five parameters.
pub fn longest_model() -> Model {
    let effect = WireEffect { id: EffectId(u32::MAX), parameters: [f32::MAX; 5].into_iter().collect() };
    Model { b: 1.0, c: 1.0, f1: 1.0, effects: std::iter::repeat_n(effect, 6).collect() }
}

pub fn fault() -> FaultRecord {
    FaultRecord {
        cause: FaultCause::EncoderJump,
        mode: Mode::Track,
        tick: u32::MAX,
        count: i32::MIN,
        drive_code: -32_768,
        value: 1234,
        limit: 1000,
    }
}

const BOUNDS: Bounds = Bounds { max_ticks: 60_000, drive_max_code: 20_000, travel_counts: 5_000 };

pub fn relay() -> Relay {
    let reference = Reference { shape: Shape::Triangle, amplitude_counts: 2_000, phase_step: 42_950 };
    Relay {
        h1_code: 2_731,
        h2_code: 2_048,
        hysteresis_counts: Some(3),
        reference,
        until_settled: true,
        append: true,
        bounds: BOUNDS,
    }
}

pub fn drive() -> OpenLoop {
    OpenLoop { shape: Shape::Table, amplitude_code: 3_000, phase_step: 107_374, centring_q16: 65_536, bounds: BOUNDS }
}

pub fn push() -> Push {
    Push { drive_code: -1_638, bounds: BOUNDS }
}

pub fn adaptive() -> Adaptive {
    let error_rate = ErrorRate { filter_s: 0.0, observer_rad_s: 500.0 };
    Adaptive { kv: 30.0, lambda1: 400.0, lambda2: 40.0, delta: 0.1, error_rate, rates: [0.1, 0.2, 0.3, 0.4, 0.5] }
}

/// An S-curve.
pub const PROFILE: Trajectory =
    Trajectory::Profile { distance: 2.0, jerk_ticks: 27, acceleration_ticks: 161, cruise_ticks: 1146, rest_ticks: 500 };

pub fn tracks() -> [Track; 7] {
    let error_rate = ErrorRate { filter_s: 0.002, observer_rad_s: 0.0 };
    let pid = ControllerGains::Pid(Pid { kp: 20.0, ki: 100.0, kd: 0.5, error_rate });
    let track = |trajectory, controller| Track {
        trajectory,
        controller,
        feed_forward: true,
        compensation: false,
        bounds: BOUNDS,
    };
    [
        track(Trajectory::Hold, pid),
        track(Trajectory::Sine { amplitude: 0.5, period_s: 2.0 }, ControllerGains::Adaptive(adaptive())),
        track(Trajectory::Triangle { amplitude: 0.25, period_s: 4.0 }, pid),
        track(Trajectory::Step { distance: -1.0 }, pid),
        track(Trajectory::MinimumJerk { distance: 1.5, duration_s: 0.75 }, pid),
        track(PROFILE, pid),
        track(Trajectory::Follow { ahead: 4, hold_ticks: 5_000 }, pid),
    ]
}

/// Set-points as many as a command holds, as long as they can be.
pub fn longest_set_points() -> SetPoints {
    let point = SetPoint { ticks: 1 << 24, position: f32::MIN, velocity: f32::MAX };
    SetPoints { sequence: u32::MAX, last: true, points: std::iter::repeat_n(point, SET_POINTS).collect() }
}

pub fn set_points() -> SetPoints {
    let point = |ticks, position, velocity| SetPoint { ticks, position, velocity };
    let points = [point(100, 0.5, 2.0), point(300, -1.0, 0.0)].into_iter().collect();
    SetPoints { sequence: 1_000, last: true, points }
}

pub fn commands() -> Vec<(String, Command)> {
    let part = WaveformPart { offset: 448, points: (0..64).map(|i| if i % 2 == 0 { i16::MIN } else { i }).collect() };
    let mut list: Vec<(String, Command)> = [
        ("hello", Command::Hello),
        ("status", Command::Status),
        ("get_settings", Command::GetSettings),
        ("set_settings", Command::SetSettings(settings())),
        ("get_model", Command::GetModel),
        ("load_model", Command::LoadModel(model())),
        ("save", Command::Save),
        ("start_relay", Command::StartRelay(relay())),
        ("start_drive", Command::StartDrive(drive())),
        ("load_waveform", Command::LoadWaveform(part)),
        ("identify", Command::Identify),
        ("stop", Command::Stop),
        ("stream_on", Command::StreamOn { decimation: 300 }),
        ("stream_off", Command::StreamOff),
        ("get_fault", Command::GetFault),
        ("clear_fault", Command::ClearFault),
        ("reboot", Command::Reboot),
        ("zero", Command::Zero { count: -1_234 }),
        ("jog", Command::Jog(push())),
        ("home", Command::Home { push: push(), at: 40_960 }),
        ("set_points", Command::SetPoints(set_points())),
    ]
    .map(|(name, command)| (name.to_owned(), command))
    .into();
    list.extend(tracks().into_iter().enumerate().map(|(i, t)| (format!("start_track {i}"), Command::StartTrack(t))));
    list
}

pub fn samples() -> [Sample; 4] {
    let sample = |tick, count, drive_code, reference, mode| Sample {
        tick,
        count,
        drive_code,
        reference,
        mode,
        current_ma: None,
    };
    [
        sample(1_000, -70_000, 4_779, 12, Mode::Relay),
        sample(1_010, -69_998, 4_779, 12, Mode::Relay),
        sample(1_020, i32::MAX, -32_767, i32::MIN, Mode::Relay),
        sample(1_030, i32::MIN, 32_767, i32::MAX, Mode::Idle),
    ]
}

/// The same, with the motor's current.
pub fn samples_with_current() -> [Sample; 4] {
    let mut samples = samples();
    for (sample, current) in samples.iter_mut().zip([-1_200, -1_195, i32::MAX, i32::MIN]) {
        sample.current_ma = Some(current);
    }
    samples
}

pub fn batch() -> Batch {
    batch_of(samples())
}

pub fn batch_of(samples: [Sample; 4]) -> Batch {
    let mut writer = BatchWriter::new(10);
    for sample in samples {
        assert_eq!(writer.push(sample, 7), None);
    }
    Batch { sequence: 4_000_000_000, ..writer.flush(7).unwrap() }
}

pub fn identified() -> Identified {
    let estimate = |value, se| Estimate { value, se };
    Identified {
        verdict: IdentificationVerdict::SingleSpeed,
        b: estimate(0.026_85, 1e-5),
        c: estimate(0.11, 2e-4),
        f1: estimate(0.5, 3e-3),
        load: Some(estimate(-0.01, 0.02)),
        residual: 0.004,
        condition: 123.0,
        windows: 57,
        sine: Some(Sine {
            amplitude: estimate(1.277, 1e-4),
            omega: estimate(8.688, 2e-4),
            phase_centre: estimate(-1.5, 1e-3),
            offset: estimate(0.01, 5e-5),
            rms: 0.03,
            cycles: 12.5,
        }),
    }
}

pub fn replies() -> Vec<(String, Reply)> {
    let status = Status {
        mode: Mode::Hold,
        tick: 123_456,
        count: -4_096,
        drive_code: -200,
        decimation: 10,
        dropped: 3,
        bad_frames: 2,
        overruns: 1,
        unsaved: true,
        zero_needed: true,
    };
    let mut list: Vec<(String, Reply)> = [
        ("info", Reply::Info(info())),
        ("done", Reply::Done),
        ("status", Reply::Status(status)),
        ("settings", Reply::Settings(settings())),
        ("model", Reply::Model(Some(model()))),
        ("no model", Reply::Model(None)),
        ("fault", Reply::Fault(Some(fault()))),
        ("no fault", Reply::Fault(None)),
        ("identified", Reply::Identified(identified())),
        ("following", Reply::Following(Following { next: 1_002, room: 29, dry: 3 })),
    ]
    .map(|(name, reply)| (name.to_owned(), reply))
    .into();
    let errors = [
        CommandError::Malformed,
        CommandError::Range(Field::H2),
        CommandError::Settings(Field::DriveFullScale),
        CommandError::Busy(Mode::Relay),
        CommandError::Faulted,
        CommandError::NothingRecorded,
        CommandError::Storage,
        CommandError::Unsupported,
        CommandError::FaultPersists,
        CommandError::OutsideTravel,
        CommandError::NotZeroed,
        CommandError::NotFollowing,
    ];
    list.extend(errors.into_iter().map(|error| (format!("error {error:?}"), Reply::Error(error))));
    list
}

pub fn events() -> Vec<(String, Event)> {
    let ended = |ending| {
        Event::ExperimentEnded(Ended { mode: Mode::Relay, ending, tick: 70_000, ticks: 60_000, saturated: 300 })
    };
    let mismatch = Mismatch { direction: -1, speed_bin: 2, position_bin: 5, score: 6.5 };
    let mut list = vec![
        ("started".to_owned(), Event::Started),
        ("fault_raised".to_owned(), Event::FaultRaised(fault())),
        ("model_mismatch".to_owned(), Event::ModelMismatch(mismatch)),
    ];
    let endings = [
        Ending::TimeUp,
        Ending::Settled { cycles: 9 },
        Ending::Asymmetric { cycles: 12 },
        Ending::NoLimitCycle,
        Ending::Limit { limit: Limit::Bound, value: -5_001 },
        Ending::Stopped,
        Ending::Fault(FaultCause::ModelLost),
        Ending::Homed,
    ];
    list.extend(endings.map(|ending| (format!("ended {ending:?}"), ended(ending))));
    list
}

/// Every message of the device.
pub fn messages() -> Vec<(String, Message)> {
    let mut list = Vec::new();
    list.extend(
        replies().into_iter().map(|(name, reply)| (format!("reply {name}"), Message::Reply { id: 0x0203, reply })),
    );
    list.extend(events().into_iter().map(|(name, event)| (format!("event {name}"), Message::Event(event))));
    list.push(("samples".to_owned(), Message::Samples(batch())));
    let measured = Batch { sequence: 4_000_000_000, ..batch_of(samples_with_current()) };
    list.push(("samples with current".to_owned(), Message::Samples(measured)));
    list
}
