//! Messages: round trips, sizes, ranges.

use breakaway_core::link::*;
use breakaway_core::plant::effect::Parameter;
use breakaway_core::plant::{Effect, Kind};

use crate::examples;

#[test]
fn every_message_comes_back_and_fits_a_frame() {
    let mut frame = [0; MAX_FRAME];
    for (name, command) in examples::commands() {
        let request = Request { id: u16::MAX, command };
        let used = encode(&request, &mut frame).unwrap_or_else(|_| panic!("{name} does not fit"));
        let mut decoder = Decoder::new();
        let message = frame[..used].iter().find_map(|b| decoder.push(*b).map(|m| m.unwrap().to_vec())).unwrap();
        assert_eq!(Request::decode(&message), Ok(request), "{name}");
    }
    for (name, message) in examples::messages() {
        let used = encode(&message, &mut frame).unwrap_or_else(|_| panic!("{name} does not fit"));
        let mut decoder = Decoder::new();
        let bytes = frame[..used].iter().find_map(|b| decoder.push(*b).map(|m| m.unwrap().to_vec())).unwrap();
        assert_eq!(Message::decode(&bytes), Some(message), "{name}");
    }
}

#[test]
fn the_longest_messages_fit() {
    let mut frame = [0; MAX_FRAME];
    let id = u16::MAX;
    let model = examples::longest_model();
    let full = Batch {
        sequence: u32::MAX,
        first_tick: u32::MAX,
        decimation: u16::MAX,
        dropped: u32::MAX,
        currents: true,
        steps: [0xff; BATCH_BYTES].into_iter().collect(),
    };
    encode(&Request { id, command: Command::LoadModel(model.clone()) }, &mut frame).unwrap();
    encode(&Message::Reply { id, reply: Reply::Model(Some(model)) }, &mut frame).unwrap();
    encode(&Message::Samples(full), &mut frame).unwrap();
    encode(&Request { id, command: Command::SetPoints(examples::longest_set_points()) }, &mut frame).unwrap();
    let long = examples::text("123456789012345678901234");
    let info = Info { firmware: long.clone(), build: long.clone(), board: long, tick_hz: u32::MAX, ..examples::info() };
    encode(&Message::Reply { id, reply: Reply::Info(info) }, &mut frame).unwrap();
    // And what is too long is refused, not cut.
    assert_eq!(encode(&[1u8; MAX_MESSAGE].as_slice(), &mut frame), Err(EncodeError));
}

#[test]
fn a_request_that_cannot_be_read_is_answered_under_its_id() {
    // Id 5, command number 99; trailing bytes; a cut id; nothing.
    assert_eq!(Request::decode(&[5, 99]), Err(Rejected { id: Some(5), error: CommandError::Malformed }));
    assert_eq!(Request::decode(&[5, 0, 1]), Err(Rejected { id: Some(5), error: CommandError::Malformed }));
    assert_eq!(Request::decode(&[0x85]), Err(Rejected { id: None, error: CommandError::Malformed }));
    assert_eq!(Request::decode(&[]), Err(Rejected { id: None, error: CommandError::Malformed }));
}

#[test]
fn settings_errors_name_the_field() {
    let good = Settings::default();
    assert_eq!(good.validate(), Ok(()));
    assert_eq!(examples::settings().validate(), Ok(()));
    let wrong = [
        (Settings { drive_max_code: 0, ..good }, Field::DriveMax),
        (Settings { drive_max_code: i16::MIN, ..good }, Field::DriveMax),
        (Settings { travel_max_counts: good.travel_min_counts, ..good }, Field::TravelMax),
        (Settings { speed_max_counts_per_s: 0, ..good }, Field::SpeedMax),
        (Settings { speed_max_counts_per_s: u32::MAX, ..good }, Field::SpeedMax),
        (Settings { mean_drive_max_code: 0, ..good }, Field::MeanDriveMax),
        (Settings { frozen_ticks: 0, ..good }, Field::FrozenTicks),
        (Settings { frozen_drive_code: -1, ..good }, Field::FrozenDrive),
        (Settings { jump_counts: 0, ..good }, Field::JumpCounts),
        (Settings { overrun_limit: 0, ..good }, Field::OverrunLimit),
        (Settings { command_timeout_ms: 9, ..good }, Field::CommandTimeout),
        (Settings { hysteresis_counts: u32::MAX, ..good }, Field::Hysteresis),
        (Settings { counts_per_revolution: u32::MAX, ..good }, Field::CountsPerRevolution),
        (Settings { position_per_count: f32::NAN, ..good }, Field::PositionPerCount),
        (Settings { drive_full_scale: 0.0, ..good }, Field::DriveFullScale),
        (Settings { supply_v: 0.0, ..good }, Field::Supply),
        (Settings { motor_resistance_ohm: -1.0, ..good }, Field::Resistance),
        (Settings { motor_inductance_h: f32::NAN, ..good }, Field::Inductance),
        (Settings { current_bandwidth_hz: f32::INFINITY, ..good }, Field::CurrentBandwidth),
    ];
    for (settings, field) in wrong {
        assert_eq!(settings.validate(), Err(field));
        assert_eq!(Command::SetSettings(settings).validate(), Err(CommandError::Settings(field)));
    }
}

#[test]
fn command_errors_name_the_field() {
    for (name, command) in examples::commands() {
        assert_eq!(command.validate(), Ok(()), "{name}");
    }
    let relay = examples::relay();
    let reference = Reference { phase_step: u32::MAX, ..relay.reference };
    let drive = examples::drive();
    let [_, adaptive, _, step, _, _, _] = examples::tracks();
    let error_rate = ErrorRate::default();
    let pid = |kp, ki, kd| Track { controller: ControllerGains::Pid(Pid { kp, ki, kd, error_rate }), ..adaptive };
    let sine = |amplitude, period_s| Track { trajectory: Trajectory::Sine { amplitude, period_s }, ..step };
    let profile = |jerk_ticks, acceleration_ticks, rest_ticks| {
        let trajectory =
            Trajectory::Profile { distance: 1.0, jerk_ticks, acceleration_ticks, cruise_ticks: 9, rest_ticks };
        Command::StartTrack(Track { trajectory, ..step })
    };
    let follow = |ahead, hold_ticks| {
        let trajectory = Trajectory::Follow { ahead, hold_ticks };
        Command::StartTrack(Track { trajectory, ..step })
    };
    let point = |ticks, position, velocity| {
        let points = [SetPoint { ticks, position, velocity }].into_iter().collect();
        Command::SetPoints(SetPoints { points, ..SetPoints::default() })
    };
    let law = |change: fn(&mut Adaptive)| {
        let mut gains = examples::adaptive();
        change(&mut gains);
        Command::StartTrack(Track { controller: ControllerGains::Adaptive(gains), ..adaptive })
    };
    let part = WaveformPart { offset: 511, points: [0, 0].into_iter().collect() };
    let wrong = [
        (Command::StartRelay(Relay { h1_code: 0, ..relay }), Field::H1),
        (Command::StartRelay(Relay { h2_code: -5, ..relay }), Field::H2),
        (Command::StartRelay(Relay { h2_code: i16::MAX, ..relay }), Field::H2),
        (Command::StartRelay(Relay { hysteresis_counts: Some(u32::MAX), ..relay }), Field::Hysteresis),
        (Command::StartRelay(Relay { reference, ..relay }), Field::PhaseStep),
        (Command::StartDrive(OpenLoop { amplitude_code: 0, ..drive }), Field::Amplitude),
        (Command::StartDrive(OpenLoop { centring_q16: -1, ..drive }), Field::Centring),
        (
            Command::StartDrive(OpenLoop { bounds: Bounds { drive_max_code: -1, ..drive.bounds }, ..drive }),
            Field::BoundDrive,
        ),
        (
            Command::StartDrive(OpenLoop { bounds: Bounds { travel_counts: u32::MAX, ..drive.bounds }, ..drive }),
            Field::BoundTravel,
        ),
        (Command::StartTrack(pid(f32::NAN, 0.0, 0.0)), Field::Kp),
        (Command::StartTrack(pid(1.0, -1.0, 0.0)), Field::Ki),
        (Command::StartTrack(pid(1.0, 1.0, f32::INFINITY)), Field::Kd),
        (Command::StartTrack(sine(f32::NAN, 1.0)), Field::TrajectorySize),
        (Command::StartTrack(sine(1.0, 0.0)), Field::TrajectoryTime),
        (profile(0, 0, 0), Field::TrajectoryTime),
        (profile(1 << 28, 0, 0), Field::TrajectoryTime),
        (profile(u32::MAX, u32::MAX, 0), Field::TrajectoryTime),
        (profile(1, 0, 1 << 30), Field::TrajectoryTime),
        (follow(0, 1), Field::Ahead),
        (follow(32, 1), Field::Ahead),
        (follow(31, 0), Field::HoldTicks),
        (follow(1, (1 << 24) + 1), Field::HoldTicks),
        (point(0, 0.0, 0.0), Field::SetPointTicks),
        (point((1 << 24) + 1, 0.0, 0.0), Field::SetPointTicks),
        (point(1, f32::NAN, 0.0), Field::SetPointPosition),
        (point(1, 0.0, f32::INFINITY), Field::SetPointVelocity),
        (law(|g| g.kv = 0.0), Field::Kv),
        (law(|g| g.lambda1 = f32::NAN), Field::Lambda1),
        (law(|g| g.lambda2 = -1.0), Field::Lambda2),
        (law(|g| g.delta = 0.0), Field::Delta),
        (law(|g| g.error_rate.filter_s = -1.0), Field::Filter),
        (law(|g| g.error_rate.observer_rad_s = f32::INFINITY), Field::Observer),
        (law(|g| g.rates[4] = -1.0), Field::Rates),
        (Command::LoadWaveform(part), Field::WaveformOffset),
        (Command::StreamOn { decimation: 0 }, Field::Decimation),
        (Command::Jog(Push { drive_code: 0, ..examples::push() }), Field::PushDrive),
        (Command::Home { push: Push { drive_code: i16::MIN, ..examples::push() }, at: 0 }, Field::PushDrive),
        (Command::Jog(Push { bounds: Bounds::default(), ..examples::push() }), Field::PushTicks),
        (Command::LoadModel(Model { b: 0.0, ..examples::model() }), Field::B),
        (Command::LoadModel(Model { c: -1.0, ..examples::model() }), Field::C),
        (Command::LoadModel(Model { f1: f32::NAN, ..examples::model() }), Field::F1),
        (Command::LoadModel(examples::longest_model()), Field::EffectKind),
    ];
    for (command, field) in wrong {
        assert_eq!(command.validate(), Err(CommandError::Range(field)), "{command:?}");
    }
}

#[test]
fn models_carry_effects_and_refuse_what_is_out_of_range() {
    let model = examples::model();
    let stribeck: Effect<f32> = model.effect(0).unwrap().unwrap();
    // The exponent was not given: its default of 2 is sent.
    assert_eq!((stribeck.kind, stribeck.p), (Kind::Stribeck, [0.3, 0.5, 2.0, 0.0, 0.0]));
    assert!(model.effect::<f32>(3).is_none());
    for p in [0.0, f32::NAN, -1.0] {
        // The Stribeck velocity must be at least 1e-12.
        let mut wrong = model.clone();
        wrong.effects[0].parameters[1] = p;
        assert_eq!(wrong.validate(), Err(CommandError::Range(Field::EffectParameters)));
    }
    let mut short = model;
    short.effects[0].parameters.pop();
    assert_eq!(short.validate(), Err(CommandError::Range(Field::EffectParameters)));
}

/// As many effects of one kind as a model holds travel as they are, each with its own parameters.
#[test]
fn an_effect_may_stand_several_times_in_a_model() {
    let lines = [7.0_f32, 28.0, 14.0, 12.0, 72.0, 1.5].map(|n| Effect::new(Kind::Cogging, &[0.1, n, 0.3]));
    let sent = Model { effects: lines.iter().map(WireEffect::new).collect(), ..examples::model() };
    let mut bytes = [0; MAX_MESSAGE];
    let bytes = postcard::to_slice(&Command::LoadModel(sent), &mut bytes).unwrap();
    let Command::LoadModel(model) = postcard::from_bytes(bytes).unwrap() else { panic!("another command") };
    assert_eq!(Command::LoadModel(model.clone()).validate(), Ok(()));
    for (index, line) in lines.iter().enumerate() {
        assert_eq!(model.effect::<f32>(index), Some(Ok(*line)));
    }
}

#[test]
fn the_limits_of_the_catalogue_survive_single_precision() {
    for kind in Kind::ALL {
        for limit in [|p: &Parameter| p.min, |p: &Parameter| p.max] {
            let values: Vec<f64> = kind.definition().parameters.iter().map(limit).collect();
            let effects = [WireEffect::new(&Effect::new(*kind, &values))].into_iter().collect();
            assert_eq!(Model { b: 1.0, c: 1.0, f1: 1.0, effects }.validate(), Ok(()), "{}", kind.name());
        }
    }
}
