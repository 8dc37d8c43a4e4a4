//! A reference that is sent piece by piece.

use std::f64::consts::PI;

use breakaway_core::control::Fast;
use breakaway_core::link::{
    Bounds, Command, CommandError, Ended, Ending, FaultCause, Field, Following, Limit, MOST_AHEAD, Mode, Reply, Sample,
    SetPoint, SetPoints, Settings, Track, Trajectory,
};
use breakaway_core::scalar::Q32;
use breakaway_firmware::storage::Loaded;
use breakaway_rig::STEP;

use crate::bench::{Bench, World, settings};
use crate::track::{adaptive, model, pid};

/// Ticks between two set-points.
const EVERY: u32 = 20;

fn follow(ahead: u8, hold_ticks: u32, bounds: Bounds) -> Command {
    let trajectory = Trajectory::Follow { ahead, hold_ticks };
    Command::StartTrack(Track { trajectory, controller: pid(), feed_forward: true, compensation: true, bounds })
}

/// A bench that follows, with its samples.
fn following<R: Fast>(ahead: u8, hold_ticks: u32, settings: Settings) -> Bench<R> {
    let mut bench = Bench::<R>::computing(World::default(), Loaded::defaults(settings));
    assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    assert_eq!(bench.command(follow(ahead, hold_ticks, Bounds::default())), Reply::Done);
    bench
}

fn send<R: Fast>(bench: &mut Bench<R>, sequence: u32, last: bool, points: &[SetPoint]) -> Reply {
    let points = points.iter().copied().collect();
    bench.command(Command::SetPoints(SetPoints { sequence, last, points }))
}

fn taken(reply: Reply) -> Following {
    match reply {
        Reply::Following(following) => following,
        other => panic!("{other:?}"),
    }
}

/// `count` set-points of `x = 1 − cos πt`, which begins at rest.
fn cosine(count: u32) -> Vec<SetPoint> {
    (1..=count)
        .map(|k| {
            let t = f64::from(k * EVERY) * 1e-3;
            let (position, velocity) = ((1.0 - (PI * t).cos()) as f32, (PI * (PI * t).sin()) as f32);
            SetPoint { ticks: EVERY, position, velocity }
        })
        .collect()
}

/// Sends all as soon as there is room, and lets the run end. The bench sends a frame per tick, and replies before samples: where
/// there is no room the host waits as a real one does.
fn pour<R: Fast>(bench: &mut Bench<R>, points: &[SetPoint]) -> Ended {
    let mut next = 0;
    while next < points.len() {
        let some = &points[next..points.len().min(next + 16)];
        let state = taken(send(bench, next as u32, next + some.len() == points.len(), some));
        assert!(usize::from(state.room) <= MOST_AHEAD && state.dry == 0, "{state:?}");
        next = state.next as usize;
        if state.room == 0 {
            bench.steps(10);
        }
    }
    bench.until_ended(2 * EVERY * MOST_AHEAD as u32)
}

fn tracked(bench: &[Sample]) -> Vec<Sample> {
    bench.iter().filter(|sample| sample.mode == Mode::Track).copied().collect()
}

/// A host that is faster than real time loses nothing: the reference is the cosine, tick by tick. The cubic differs from it by
/// at most (π·0.02)⁴/384 = 4·10⁻⁸ rad; in Q32 and f32 rounding is below a tenth of a count. So each tick agrees to a count.
#[test]
fn set_points_that_come_faster_than_real_time_are_all_followed() {
    fn check<R: Fast>() {
        let mut bench = following::<R>(4, 500, settings());
        let ended = pour(&mut bench, &cosine(200));
        assert_eq!(ended.ending, Ending::TimeUp);
        let samples = tracked(&bench.samples);
        // It rests until four wait; the motion takes 200 pieces, and the tick at its end.
        let start = samples.len() - 1 - 200 * EVERY as usize;
        assert!((1..50).contains(&start), "{start}");
        for (k, sample) in samples.iter().enumerate() {
            let t = k.saturating_sub(start) as f64 * 1e-3;
            let wanted = (1.0 - (PI * t).cos()) / STEP;
            assert!((f64::from(sample.reference) - wanted).abs() <= 1.0, "tick {k}: {sample:?}, not {wanted}");
        }
        // The exact model is compensated: what is left is the encoder's step, and break-away from rest.
        let worst = samples.iter().map(|s| (s.reference - s.count).abs()).max().unwrap();
        assert!(worst < 20, "{worst} counts of 2000");
    }
    check::<f32>();
    check::<Q32>();
}

/// Where the set-points stop in full motion, the reference stands still at the last one for `hold_ticks`. Then the run
/// ends, off or braked as the settings say. It is a limit: the next run may start.
#[test]
fn set_points_that_run_dry_are_held_and_end_the_run() {
    for brake in [false, true] {
        let mut bench = following::<f32>(4, 300, Settings { brake, ..settings() });
        let points = cosine(25);
        let sent = taken(send(&mut bench, 0, false, &points[..16]));
        assert_eq!(sent, Following { next: 16, room: MOST_AHEAD as u8 - 16, dry: 0 });
        let ended = bench.until_ended(1000);
        assert_eq!(ended.ending, Ending::Limit { limit: Limit::SetPoints, value: 300 });
        let samples = tracked(&bench.samples);
        let last = (f64::from(points[15].position) / STEP).round() as i32;
        let held = samples.iter().rev().take_while(|sample| sample.reference == last).count();
        // The tick in which the last piece ends is the first of the 300.
        assert_eq!(held, 300);
        assert!((samples.last().unwrap().count - last).abs() <= 2, "{:?}", samples.last());
        let world = bench.world.0.borrow();
        assert_eq!((world.enabled, world.braking, world.drive), (false, brake, 0));
        drop(world);
        assert_eq!(bench.fault(), None);
        bench.events.clear();
        assert_eq!(bench.command(follow(1, 1, Bounds::default())), Reply::Done);
        assert!(matches!(bench.until_ended(10).ending, Ending::Limit { limit: Limit::SetPoints, value: 1 }));
    }
}

/// A stream that stutters is held meanwhile, is told so, and begins again from rest when `ahead` set-points wait.
#[test]
fn a_stream_that_stutters_goes_on_from_where_it_rests() {
    let mut bench = following::<f32>(3, 500, settings());
    let points = cosine(40);
    assert_eq!(taken(send(&mut bench, 0, false, &points[..10])).dry, 0);
    bench.steps(10 * EVERY + 100);
    // Two are not enough to begin.
    let waiting = taken(send(&mut bench, 10, false, &points[10..12]));
    assert_eq!(waiting, Following { next: 12, room: MOST_AHEAD as u8 - 2, dry: 1 });
    bench.steps(200);
    assert_eq!(taken(send(&mut bench, 12, false, &[])).room, MOST_AHEAD as u8 - 2);
    let more = taken(send(&mut bench, 12, true, &points[12..20]));
    assert_eq!(more.next, 20);
    assert_eq!(bench.until_ended(1000).ending, Ending::TimeUp);
    let samples = tracked(&bench.samples);
    let steps = samples.windows(2).map(|pair| (pair[1].reference - pair[0].reference).abs()).max().unwrap();
    // π rad/s at its fastest, and half as much again on the way from rest: no jump.
    assert!(steps <= 5, "{steps} counts in a tick");
    assert_eq!(samples.last().unwrap().reference, (f64::from(points[19].position) / STEP).round() as i32);
}

/// What was taken is left out when it comes again; a gap in the numbers is refused, and so is more after the last.
#[test]
fn numbers_tell_what_is_new() {
    let mut bench = following::<f32>(4, 500, settings());
    let points = cosine(9);
    assert_eq!(taken(send(&mut bench, 0, false, &points[..5])).next, 5);
    assert_eq!(taken(send(&mut bench, 0, false, &points[..5])).next, 5);
    assert_eq!(taken(send(&mut bench, 3, false, &points[3..7])).next, 7);
    let refused = Reply::Error(CommandError::Range(Field::SetPointSequence));
    assert_eq!(send(&mut bench, 8, false, &points[8..]), refused);
    assert_eq!(taken(send(&mut bench, 7, true, &points[7..])).next, 9);
    assert_eq!(taken(send(&mut bench, 7, true, &points[7..])).next, 9);
    assert_eq!(send(&mut bench, 9, false, &points[8..]), refused);
    let ended = bench.until_ended(1000);
    assert_eq!(ended.ending, Ending::TimeUp);
    let moved = tracked(&bench.samples).windows(2).filter(|pair| pair[1].reference != pair[0].reference).count();
    assert!(moved <= 9 * EVERY as usize, "{moved} ticks of motion: something was followed twice");
    assert_eq!(send(&mut bench, 9, false, &[]), Reply::Error(CommandError::NotFollowing));
}

/// Each is checked before it is taken: travel of settings and run, speed, also on the way between two good ends.
#[test]
fn a_set_point_out_of_range_is_refused() {
    // 10 rad either way, 5 rad/s.
    let narrow =
        Settings { travel_min_counts: -10_000, travel_max_counts: 10_000, speed_max_counts_per_s: 5000, ..settings() };
    let mut bench = following::<f32>(1, 500, narrow);
    let point = |ticks, position, velocity| SetPoint { ticks, position, velocity };
    let [position, velocity] = [Field::SetPointPosition, Field::SetPointVelocity].map(CommandError::Range);
    for (point, error) in [
        (point(5000, 10.1, 0.0), position),
        (point(5000, -10.1, 0.0), position),
        // Over the limit and back: 3 s at 5 rad/s lead 5 rad further than the end.
        (point(3000, 9.0, -5.0), position),
        (point(1, 0.0, f32::NAN), velocity),
        (point(1, f32::INFINITY, 0.0), position),
        (point(1, f32::MAX, f32::MAX), position),
        (point(1000, 1.0, 5.1), velocity),
        (point(100, 1.0, 0.0), velocity),
    ] {
        assert_eq!(send(&mut bench, 0, false, &[point]), Reply::Error(error), "{point:?}");
        // A good one before it is not taken either.
        let two = [SetPoint { ticks: 500, position: 0.0, velocity: 0.0 }, point];
        assert_eq!(send(&mut bench, 0, false, &two), Reply::Error(error), "{point:?}");
    }
    assert_eq!(taken(send(&mut bench, 0, false, &[])).next, 0);
    // The same 9 rad without the swing, in the time that 5 rad/s and a start from rest need.
    assert_eq!(taken(send(&mut bench, 0, false, &[point(5400, 9.0, 0.0)])).next, 1);
    assert_eq!(bench.command(Command::Stop), Reply::Done);
    bench.steps(5);
    // The run's own bound is narrower.
    let bounds = Bounds { travel_counts: 2000, ..Bounds::default() };
    assert_eq!(bench.command(follow(1, 500, bounds)), Reply::Done);
    bench.steps(2);
    assert_eq!(send(&mut bench, 0, false, &[point(5000, 2.1, 0.0)]), Reply::Error(position));
    assert_eq!(taken(send(&mut bench, 0, false, &[point(5000, -1.9, 0.0)])).next, 1);
}

/// The travel limits count from zero, the set-points from where the run started.
#[test]
fn travel_is_counted_from_zero() {
    let limits = Settings { travel_min_counts: -1000, travel_max_counts: 1000, ..settings() };
    let mut bench = Bench::with_memory([0; 8], limits);
    assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
    assert_eq!(bench.command(Command::Zero { count: 900 }), Reply::Done);
    assert_eq!(bench.command(follow(1, 500, Bounds::default())), Reply::Done);
    bench.steps(2);
    let point = |position| [SetPoint { ticks: 2000, position, velocity: 0.0 }];
    let refused = Reply::Error(CommandError::Range(Field::SetPointPosition));
    assert_eq!(send(&mut bench, 0, false, &point(0.11)), refused);
    assert_eq!(send(&mut bench, 0, false, &point(-1.91)), refused);
    assert_eq!(taken(send(&mut bench, 0, false, &point(-1.89))).next, 1);
}

/// A host that says nothing at all is a lost link, whatever the run would still hold.
#[test]
fn a_host_that_falls_silent_while_set_points_are_held() {
    let mut bench = following::<f32>(1, 5000, Settings { command_timeout_ms: 200, ..settings() });
    assert_eq!(taken(send(&mut bench, 0, false, &cosine(5))).next, 5);
    bench.keep_alive = 0;
    assert_eq!(bench.until_ended(400).ending, Ending::Fault(FaultCause::LinkLost));
}

/// No set-points without their run; no adaptive law, whose rates need the reference beforehand.
#[test]
fn set_points_need_their_run() {
    let mut bench = Bench::new();
    assert_eq!(send(&mut bench, 0, false, &cosine(1)), Reply::Error(CommandError::NotFollowing));
    assert_eq!(bench.command(Command::LoadModel(model())), Reply::Done);
    let trajectory = Trajectory::Follow { ahead: 1, hold_ticks: 100 };
    let (controller, bounds) = (adaptive(), Bounds::default());
    let law = Command::StartTrack(Track { trajectory, controller, feed_forward: false, compensation: false, bounds });
    assert_eq!(bench.command(law), Reply::Error(CommandError::Unsupported));
    assert_eq!(bench.command(crate::track::track(crate::track::SINE, pid(), false)), Reply::Done);
    assert_eq!(send(&mut bench, 0, false, &cosine(1)), Reply::Error(CommandError::NotFollowing));
}
