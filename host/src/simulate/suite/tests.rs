//! The suite is sized from the break-away force, which is found.

use super::*;
use crate::recording::Units;
use breakaway_core::plant::{Base, Effect, Kind};

const MACHINE: Machine = Machine {
    drive_limit: 5.0,
    travel: 5.0,
    tick_s: 1e-3,
    sensor: Sensor { encoder_step: 1e-3, noise: 5e-4, delay_ticks: 0 },
    seed: 1,
};

fn axis(f1: f64, effects: &[Effect<f64>]) -> Axis {
    Axis::new(Base { b: 0.02685, c: 0.11, f1 }, effects, Units::default())
}

/// The drive at which the reading has moved by ten steps is above the friction. The difference is what the ramp (2.5
/// V/s at most) gains while the body covers them: x = rate·t³/(6b) = 0.01 rad takes 0.09 s, 0.22 V. Read back from
/// the motion, the noise of half a step leaves 7 mV, the standard deviation of 30 seeds of an independent simulation.
/// Three of them are allowed. With stiction the same simulation finds 0.77 V.
#[test]
fn the_break_away_force_is_found() {
    for f1 in [0.05, 0.5, 2.0] {
        let found = breakaway(&axis(f1, &[]), &MACHINE).unwrap();
        assert!(found.moved_at > f1 && found.moved_at < f1 + 0.25, "{f1}: {found:?}");
        assert!((found.force - f1).abs() < 0.021, "{f1}: {found:?}");
    }
    let stiction = [Effect::new(Kind::Stiction, &[0.3])];
    let found = breakaway(&axis(0.5, &stiction), &MACHINE).unwrap();
    assert!(found.moved_at > 0.8 && found.moved_at < 1.05, "with stiction {found:?}");
    assert!((found.force - 0.77).abs() < 0.022, "with stiction {found:?}");
    assert_eq!(breakaway(&axis(6.0, &[]), &MACHINE), Err(SimulateError::NoBreakaway(5.0)));
}

/// Five recordings to fit and three to score (docs/formats.md, section "The standard suite"); all are valid, within the drive's limit, and move the axis.
#[test]
fn the_suite_runs_and_moves_the_axis() {
    let suite = suite(0.6, &MACHINE);
    assert_eq!(suite.iter().filter(|(role, _)| *role == Role::Fit).count(), 5);
    assert_eq!(suite.iter().filter(|(role, _)| *role == Role::Score).count(), 3);
    let mut axis = axis(0.5, &[]);
    let mut seeds = Vec::new();
    let mut end = f64::NEG_INFINITY;
    for (_, experiment) in &suite {
        let recording = axis.run(experiment).unwrap().recording;
        assert_eq!(recording.t.len(), experiment.samples());
        assert!(recording.t[0] > end, "{} starts on the running clock", experiment.name);
        end = recording.t[recording.t.len() - 1];
        assert!(recording.u.iter().all(|u| u.abs() <= MACHINE.drive_limit));
        let (min, max) = recording.x.iter().fold((f64::MAX, f64::MIN), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
        assert!(max - min > 0.02 && max - min < 4.0 * MACHINE.travel, "{}: {min} to {max}", experiment.name);
        seeds.push(experiment.seed);
    }
    seeds.dedup();
    assert_eq!(seeds.len(), suite.len());
}
