//! The drift watch: what it says of a run, and that it says nothing while the model holds.

use breakaway_core::link::{Bounds, Command, Ending, Event, Mismatch, Mode, Reply, Track, Trajectory, WireEffect};
use breakaway_core::plant::{Base, Effect, Kind};

use crate::bench::{Bench, PLANT};
use crate::track::{model, pid};

/// A sine of 1 rad at 0.5 Hz, without end, on a bench that has the model of its plant.
fn following(effects: &[Effect<f64>]) -> Bench {
    let mut bench = Bench::new();
    bench.world.0.borrow_mut().plant.effects = effects.to_vec();
    let effects = effects.iter().map(WireEffect::new).collect();
    let model = breakaway_core::link::Model { effects, ..model() };
    assert_eq!(bench.command(Command::LoadModel(model)), Reply::Done);
    let trajectory = Trajectory::Sine { amplitude: 1.0, period_s: 2.0 };
    let track =
        Track { trajectory, controller: pid(), feed_forward: true, compensation: true, bounds: Bounds::default() };
    assert_eq!(bench.command(Command::StartTrack(track)), Reply::Done);
    bench
}

fn mismatches(bench: &Bench) -> Vec<Mismatch> {
    let found = bench.events.iter().filter_map(|event| match event {
        Event::ModelMismatch(mismatch) => Some(*mismatch),
        _ => None,
    });
    found.collect()
}

/// Friction 30 % up in the middle of a run is reported within 2 s as resistance, as by the core's own watch
/// (docs/control.md). 30 % down is reported as ease.
#[test]
fn a_change_of_friction_is_told_within_two_seconds() {
    for (factor, sign) in [(1.3, -1.0), (0.7, 1.0)] {
        let mut bench = following(&[]);
        // Taught by a stroke and a half either way.
        bench.steps(5_000);
        assert_eq!(mismatches(&bench), [], "before anything has changed");
        bench.world.0.borrow_mut().plant.base = Base { f1: factor * PLANT.f1, ..PLANT };
        let mut ticks = 0;
        while mismatches(&bench).is_empty() {
            bench.step();
            ticks += 1;
            assert!(ticks <= 2000, "f1 times {factor}: nothing within 2 s");
        }
        let found = mismatches(&bench)[0];
        println!("f1 times {factor}: after {ticks} ms, {found:?}");
        assert_eq!(f64::from(found.score.signum()), sign, "{found:?}");
        assert!(found.direction.abs() == 1 && found.score.abs() > 3.0 && found.speed_bin < 16, "{found:?}");
        assert_eq!(bench.status().mode, Mode::Track, "it only tells");
    }
}

/// Five minutes without a word, on the plant of the papers and on one with cogging that the model knows.
#[test]
fn nothing_is_told_while_the_model_holds() {
    for effects in [&[][..], &[Effect::new(Kind::Cogging, &[0.2, 7.0, 1.0])]] {
        let mut bench = following(effects);
        bench.steps(300_000);
        assert_eq!(bench.status().mode, Mode::Track);
        assert_eq!(mismatches(&bench), []);
    }
}

/// What follows another model is not measured with the old one, and a rest is not watched.
#[test]
fn each_run_is_learnt_anew() {
    let mut bench = following(&[]);
    bench.steps(30_000);
    assert_eq!(bench.command(Command::Stop), Reply::Done);
    assert_eq!(bench.until_ended(10).ending, Ending::Stopped);
    bench.world.0.borrow_mut().plant.base = Base { f1: 1.3 * PLANT.f1, ..PLANT };
    let changed = breakaway_core::link::Model { f1: 1.3 * model().f1, ..model() };
    assert_eq!(bench.command(Command::LoadModel(changed)), Reply::Done);
    for trajectory in [Trajectory::Sine { amplitude: 1.0, period_s: 2.0 }, Trajectory::Hold] {
        let bounds = Bounds { max_ticks: 40_000, ..Bounds::default() };
        let track = Track { trajectory, controller: pid(), feed_forward: true, compensation: true, bounds };
        bench.events.clear();
        assert_eq!(bench.command(Command::StartTrack(track)), Reply::Done);
        assert_eq!(bench.until_ended(41_000).ending, Ending::TimeUp);
        assert_eq!(mismatches(&bench), [], "{trajectory:?}");
    }
}
