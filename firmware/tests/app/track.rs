//! Track and Hold.

use breakaway_core::control::{Compensator, Fast, Profile, Sine, lead_s, tune};
use breakaway_core::link::{
    Adaptive, Bounds, Command, CommandError, ControllerGains, Ending, ErrorRate, FULL_SCALE_CODE, FaultCause, Field,
    Mode, Model, Pid, Reply, Sample, Settings, Track, Trajectory, WireEffect,
};
use breakaway_core::plant::{Effect, Kind, Plant};
use breakaway_core::scalar::Q32;
use breakaway_firmware::storage::Loaded;
use breakaway_rig::{FULL_SCALE, STEP};

use crate::bench::{Bench, PLANT, World, settings};

pub fn model() -> Model {
    let (b, c, f1) = (PLANT.b as f32, PLANT.c as f32, PLANT.f1 as f32);
    Model { b, c, f1, effects: heapless::Vec::new() }
}

/// A filter of two ticks.
const TWO_TICKS: ErrorRate = ErrorRate { filter_s: 2e-3, observer_rad_s: 0.0 };

/// A PID for 8 Hz of bandwidth.
pub fn pid() -> ControllerGains {
    let gains = tune(PLANT.b, PLANT.c, 8.0, 1e-3, 1).unwrap();
    let kd = gains.b * gains.kv;
    let (kp, ki, kd) = ((kd * gains.lambda2) as f32, (kd * gains.lambda1) as f32, kd as f32);
    ControllerGains::Pid(Pid { kp, ki, kd, error_rate: TWO_TICKS })
}

pub fn adaptive() -> ControllerGains {
    let gains = tune(PLANT.b, PLANT.c, 8.0, 1e-3, 1).unwrap();
    ControllerGains::Adaptive(Adaptive {
        kv: gains.kv as f32,
        lambda1: gains.lambda1 as f32,
        lambda2: gains.lambda2 as f32,
        delta: 0.5,
        error_rate: TWO_TICKS,
        rates: [0.0, 1.0, 3.0, 1.0, 0.0],
    })
}

pub fn track(trajectory: Trajectory, controller: ControllerGains, compensation: bool) -> Command {
    let bounds = Bounds { max_ticks: 4000, ..Bounds::default() };
    Command::StartTrack(Track { trajectory, controller, feed_forward: compensation, compensation, bounds })
}

/// The samples of a run of 4 s, computed in `R`.
pub fn run<R: Fast>(command: Command, mode: Mode) -> Vec<Sample> {
    let mut bench = Bench::<R>::computing(World::default(), Loaded::defaults(settings()));
    assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    assert_eq!(bench.command(command), Reply::Done);
    let ended = bench.until_ended(4100);
    let samples: Vec<Sample> = bench.samples.into_iter().filter(|sample| sample.mode == mode).collect();
    // So the host finds where a run began whose first samples were lost.
    assert_eq!((ended.ending, samples[0].tick), (Ending::TimeUp, ended.tick - ended.ticks));
    samples
}

/// Rms error in position units over the last two seconds.
pub fn rms(samples: &[Sample]) -> f64 {
    let late = &samples[samples.len() - 2000..];
    let square = |sample: &Sample| (f64::from(sample.reference - sample.count) * STEP).powi(2);
    (late.iter().map(square).sum::<f64>() / late.len() as f64).sqrt()
}

pub const SINE: Trajectory = Trajectory::Sine { amplitude: 1.0, period_s: 2.0 };

/// With the exact model and an ideal axis what is left is the encoder's step of 1 mrad and the reversals.
#[test]
fn compensation_takes_most_of_the_error_of_a_pid() {
    compensates::<f32>();
    compensates::<Q32>();
}

fn compensates<R: Fast>() {
    let without = rms(&run::<R>(track(SINE, pid(), false), Mode::Track));
    let with = rms(&run::<R>(track(SINE, pid(), true), Mode::Track));
    assert!(without < 0.1, "rms error {without} rad of 1 rad");
    assert!(with < 0.3 * without, "with compensation {with}, without {without}");
}

/// Cogging stays where it is when a run begins elsewhere. 1.3 rad on, compensation counted from the start would be
/// off by 1.3·7 rad = 1.45 turns, and almost double it.
#[test]
fn cogging_is_compensated_where_the_axis_is() {
    let effect = Effect::new(Kind::Cogging, &[0.2, 7.0, 0.5]);
    let mut errors = Vec::new();
    for (start, known) in [(0.0, true), (1.3, true), (1.3, false)] {
        let mut bench = Bench::new();
        {
            let axis = &mut bench.world.0.borrow_mut().plant;
            axis.effects = vec![effect];
            axis.state = Plant { base: PLANT, effects: &axis.effects }.at_rest(start);
        }
        let effects = known.then(|| WireEffect::new(&effect)).into_iter().collect();
        assert_eq!(bench.command(Command::LoadModel(Model { effects, ..model() })), Reply::Done);
        assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
        assert_eq!(bench.command(track(SINE, pid(), true)), Reply::Done);
        assert_eq!(bench.until_ended(4100).ending, Ending::TimeUp);
        errors.push(rms(&bench.samples.iter().filter(|s| s.mode == Mode::Track).copied().collect::<Vec<_>>()));
    }
    let [at_zero, elsewhere, without] = errors[..] else { panic!("{errors:?}") };
    println!("at 0: {at_zero:.5} rad, at 1.3: {elsewhere:.5}, not known: {without:.5}");
    assert!(elsewhere < 1.5 * at_zero && elsewhere < 0.5 * without, "{errors:?}");
}

/// The drive of a reading acts half a tick later on average, and is the model's there, by the host's own compensator.
/// At 2π rad/s half a millisecond is 36° of a cogging of 200 per radian. At the first tick there is no error yet: all
/// of the drive is feed-forward.
#[test]
fn the_board_looks_as_far_ahead_as_the_host() {
    let effect = Effect::new(Kind::Cogging, &[0.2, 200.0, 0.0]);
    let mut bench = Bench::new();
    let effects = [WireEffect::new(&effect)].into_iter().collect();
    assert_eq!(bench.command(Command::LoadModel(Model { effects, ..model() })), Reply::Done);
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    let trajectory = Trajectory::Sine { amplitude: 1.0, period_s: 1.0 };
    assert_eq!(bench.command(track(trajectory, pid(), true)), Reply::Done);
    bench.steps(100);
    let first = bench.samples.iter().find(|sample| sample.mode == Mode::Track).unwrap();
    let reference = Sine::<f32>::of_period(1.0, 1000.0, 1e-3_f32).unwrap().at(0);
    let code = |lead: f64| {
        let feed = Compensator::<f32>::new(&PLANT, &[effect]).unwrap().with_lead(lead).unwrap().on();
        f64::from(feed.drive(reference)) / FULL_SCALE * f64::from(FULL_SCALE_CODE)
    };
    let (led, late) = (code(lead_s(1e-3, 0)), code(0.0));
    println!("drive code {}, led {led:.1}, not led {late:.1}", first.drive_code);
    assert!((f64::from(first.drive_code) - led).abs() < 2.0, "{} {led}", first.drive_code);
    assert!((led - late).abs() > 100.0, "{led} {late}");
}

#[test]
fn the_adaptive_law_follows() {
    for error in [
        rms(&run::<f32>(track(SINE, adaptive(), false), Mode::Track)),
        rms(&run::<Q32>(track(SINE, adaptive(), false), Mode::Track)),
    ] {
        // 3 % of the peak: friction is in the law's model, and starts at its true value.
        assert!(error < 0.03, "rms error {error} rad");
    }
}

#[test]
fn hold_stays_and_a_move_arrives() {
    holds_and_moves::<f32>();
    holds_and_moves::<Q32>();
}

fn holds_and_moves<R: Fast>() {
    let held = run::<R>(track(Trajectory::Hold, pid(), false), Mode::Hold);
    assert!(held.iter().all(|sample| sample.count == 0 && sample.reference == 0));
    let jerk = Trajectory::MinimumJerk { distance: -2.0, duration_s: 1.5 };
    let moved = run::<R>(track(jerk, pid(), true), Mode::Track);
    let last = moved.last().unwrap();
    assert_eq!(last.reference, -2000);
    // Within two hundredths of the move: the integral's last bit takes longer than the 2.5 s of rest.
    assert!((last.count - last.reference).abs() <= 40, "{last:?}");
}

#[test]
fn gains_past_the_sampled_loop_and_a_missing_model_are_refused() {
    let mut bench = Bench::new();
    let wild = ControllerGains::Pid(Pid { kp: 50.0, ki: 0.0, kd: 50.0, error_rate: TWO_TICKS });
    let refused = |field| Reply::Error(CommandError::Range(field));
    assert_eq!(bench.command(track(SINE, pid(), false)), refused(Field::B));
    assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
    assert_eq!(bench.command(track(SINE, wild, false)), refused(Field::Kd));
    // Half of what a count of 1 mrad makes in a filter of 2 ticks of 1 ms is 0.167 rad/s.
    let ControllerGains::Adaptive(law) = adaptive() else { panic!() };
    let with = |delta| track(SINE, ControllerGains::Adaptive(Adaptive { delta, ..law }), false);
    assert_eq!(bench.command(with(0.16)), refused(Field::Delta));
    assert_eq!(bench.command(with(0.167)), Reply::Done);
    assert_eq!(bench.command(Command::Stop), Reply::Done);
    assert_eq!(bench.status().mode, Mode::Idle);
}

/// An S-curve of 2 rad within 1.5 rad/s, 8 rad/s² and 100 rad/s³, there and back with rests of 0.2 s. The reference
/// is that of the limits, to the count it is rounded to and one that f32 may tip over.
#[test]
fn an_s_curve_is_the_one_of_its_limits() {
    let limits = (2.0, 1.5, 8.0, 100.0, 1e-3);
    let (distance, speed, acceleration, jerk, tick_s) = limits;
    let phases = Profile::<f64>::s_curve_phases(distance, speed, acceleration, jerk, tick_s).unwrap();
    let profile = Profile::<f64>::s_curve(distance, speed, acceleration, jerk, tick_s).unwrap();
    let profile = profile.back_and_forth(0.2).unwrap();
    let trajectory = Trajectory::Profile {
        distance: distance as f32,
        jerk_ticks: phases.jerk,
        acceleration_ticks: phases.acceleration,
        cruise_ticks: phases.cruise,
        rest_ticks: 200,
    };
    let command = || track(trajectory, pid(), true);
    for samples in [run::<f32>(command(), Mode::Track), run::<Q32>(command(), Mode::Track)] {
        is_the_profile(&samples, &profile);
    }
}

fn is_the_profile(samples: &[Sample], profile: &Profile<f64>) {
    let first = samples[0].tick;
    for sample in samples {
        let expected = (profile.at(sample.tick - first).x / STEP).round() as i32;
        assert!((sample.reference - expected).abs() <= 1, "{sample:?}: {expected}");
    }
    // Both ways in 4 s, and the axis with it: at rest it is where it was sent, to two counts.
    assert!(profile.ticks() < 1800 && samples.len() == 4000);
    let there = &samples[profile.ticks() as usize + 190];
    assert!((there.reference, (there.count - 2000).abs() <= 2) == (2000, true), "{there:?}");
    assert!(rms(samples) < 2.0 * STEP, "{}", rms(samples));
}

/// On a reversed encoder every loop is one of positive feedback: the drive grows with the motion against it, and keeps its sign.
#[test]
fn no_controller_runs_on_a_reversed_encoder() {
    for controller in [pid(), adaptive()] {
        let mut bench = Bench::new();
        bench.world.0.borrow_mut().reversed = true;
        assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
        assert_eq!(bench.command(track(SINE, controller, false)), Reply::Done);
        assert_eq!(bench.until_ended(4100).ending, Ending::Fault(FaultCause::WrongDirection));
        assert!(!bench.world.0.borrow().enabled);
        // 1/64 of a revolution is asked of the guard; at the most a tenth has been turned when the drive goes off.
        let record = bench.fault().unwrap();
        assert!(record.value < 0 && record.value > -400, "{record:?}");
    }
}

/// A step that the drive cannot follow, with a run's bound of a fifth of the settings'. The integral goes back by
/// what the limit in force cuts off. The step arrives without overshoot, as with a limit in the settings. (It
/// overshot by 17 counts of 1000 where the integral was frozen, and by 58 where it was frozen for the settings' limit
/// alone.)
#[test]
fn the_integral_goes_back_by_what_the_limit_cuts_off() {
    let overshoot = |settings_code: i16, bound: i16| {
        let mut bench = Bench::with_memory([0; 8], Settings { drive_max_code: settings_code, ..settings() });
        assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
        assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
        let bounds = Bounds { max_ticks: 3000, drive_max_code: bound, ..Bounds::default() };
        let trajectory = Trajectory::Step { distance: 1.0 };
        let step = Track { trajectory, controller: pid(), feed_forward: false, compensation: false, bounds };
        assert_eq!(bench.command(Command::StartTrack(step)), Reply::Done);
        let ended = bench.until_ended(3100);
        assert_eq!(ended.ending, Ending::TimeUp);
        // It is told for how long: from the step on, until it brakes.
        assert!((100..1000).contains(&ended.saturated), "{ended:?}");
        let last = bench.samples.iter().rfind(|sample| sample.mode == Mode::Track).unwrap();
        assert!((last.count - 1000).abs() <= 1, "{last:?}");
        bench.samples.iter().map(|sample| sample.count).max().unwrap() - 1000
    };
    let fifth = FULL_SCALE_CODE / 5;
    let (known, bound) = (overshoot(fifth, 0), overshoot(FULL_SCALE_CODE, fifth));
    println!("overshoot in counts: limit of the settings {known}, of the run {bound}");
    assert_eq!(bound, known);
    assert!((0..=1).contains(&known), "{known}");
}

/// What the power stage cannot give is no setting: controllers and hosts could not tell that it saturates.
#[test]
fn a_limit_above_the_power_stage_s_is_refused() {
    let stage = FULL_SCALE_CODE / 100 * 95;
    let start = Settings { drive_max_code: stage, ..settings() };
    let world = World { stage_limit: Some(stage), ..World::default() };
    let mut bench = Bench::on(world, Loaded::defaults(start));
    let above = Settings { drive_max_code: stage + 1, ..start };
    assert_eq!(bench.command(Command::SetSettings(above)), Reply::Error(CommandError::Settings(Field::DriveMax)));
    assert_eq!(bench.command(Command::SetSettings(start)), Reply::Done);
}
