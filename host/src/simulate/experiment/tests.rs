//! Excitations: peaks, shapes, and the same bytes for the same seed.

use super::*;
use crate::recording::Units;
use crate::simulate::axis::Axis;
use breakaway_core::plant::{Base, Effect, Kind};

/// The peak is 1 over the period and over any longer time, to the 2 % = 1 − cos(π/16) by which 16 points per fastest cycle
/// may miss a crest.
#[test]
fn a_multisine_peaks_at_one() {
    for seed in 0..8 {
        let sines = Multisine::new(0.25, 16.0, seed);
        let peak = |seconds: u32| (0..seconds * 2000).map(|i| sines.at(f64::from(i) * 5e-4).abs()).fold(0.0, f64::max);
        let (scaled, longer) = (peak(4), peak(60));
        assert!((0.999..1.02).contains(&scaled), "seed {seed}: {scaled}");
        assert!((longer - scaled).abs() < 1e-9, "seed {seed}: {longer}");
    }
    assert_ne!(Multisine::new(0.25, 16.0, 1).at(0.1), Multisine::new(0.25, 16.0, 2).at(0.1));
}

#[test]
fn references_have_their_shapes() {
    let triangle = Reference::Triangle { amplitude: 2.0, period_s: 4.0 };
    for (t, x) in
        [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (1.5, 1.0), (2.0, 0.0), (3.0, -2.0), (3.5, -1.0), (4.0, 0.0), (9.0, 2.0)]
    {
        assert!((triangle.at(t) - x).abs() < 1e-12, "{t}: {}", triangle.at(t));
    }
    let sine = Reference::Sine { amplitude: 3.0, period_s: 2.0 };
    for (t, x) in [(0.0, 0.0), (0.5, 3.0), (1.0, 0.0), (1.5, -3.0), (2.5, 3.0)] {
        assert!((sine.at(t) - x).abs() < 1e-12, "{t}");
    }
    assert_eq!(Reference::Start.at(7.0), 0.0);
}

fn experiment(excitation: Excitation, seed: u64) -> Experiment {
    Experiment {
        name: "e".into(),
        tick_s: 1e-3,
        duration_s: 2.0,
        seed,
        drive_limit: 2.0,
        travel_limit: f64::INFINITY,
        excitation,
        sensor: Sensor { encoder_step: 1e-3, noise: 5e-4, delay_ticks: 1 },
    }
}

fn bytes(experiment: &Experiment, effects: &[Effect<f64>]) -> Vec<u8> {
    let base = Base { b: 0.02685, c: 0.11, f1: 0.5 };
    let run = Axis::new(base, effects, Units::default()).run(experiment).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    run.recording.write(&path).unwrap();
    std::fs::read(path).unwrap()
}

/// By the exact and by the stepped simulator, the same seed writes the same file, another seed another one.
#[test]
fn the_same_seed_gives_the_same_bytes() {
    let relay = Excitation::Relay { h1: 2.0, h2: 1.5, hysteresis: None, reference: Reference::Start };
    let sines = Excitation::Multisine { amplitude: 3.0, from_hz: 0.5, to_hz: 10.0, centring: 0.1 };
    let stribeck = [Effect::new(Kind::Stribeck, &[0.2, 0.5])];
    for effects in [&[][..], &stribeck] {
        for excitation in [&relay, &sines] {
            let one = bytes(&experiment(excitation.clone(), 1), effects);
            assert_eq!(one, bytes(&experiment(excitation.clone(), 1), effects));
            assert_ne!(one, bytes(&experiment(excitation.clone(), 2), effects));
        }
    }
}

/// The drive never exceeds its limit, and the first sample of a delayed loop applies nothing.
#[test]
fn limits_and_delay_are_kept() {
    let sines = Excitation::Multisine { amplitude: 3.0, from_hz: 0.5, to_hz: 10.0, centring: 0.0 };
    let base = Base { b: 0.02685, c: 0.11, f1: 0.5 };
    let run = Axis::new(base, &[], Units::default()).run(&experiment(sines, 1)).unwrap();
    let u = &run.recording.u;
    assert_eq!(u[0], 0.0);
    assert!(u.iter().all(|u| u.abs() <= 2.0) && u.iter().any(|u| u.abs() == 2.0));
}

#[test]
fn fields_out_of_range_are_named() {
    let sine = |frequency_hz| Excitation::Sine { amplitude: 1.0, frequency_hz, centring: 0.0 };
    let refused = |change: &dyn Fn(&mut Experiment)| {
        let mut e = experiment(sine(1.0), 1);
        change(&mut e);
        match e.check() {
            Err(SimulateError::Range { field, .. }) => field,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(refused(&|e| e.tick_s = 0.0), "tick_s");
    assert_eq!(refused(&|e| e.duration_s = f64::NAN), "duration_s");
    assert_eq!(refused(&|e| e.duration_s = 1e9), "duration_s / tick_s");
    assert_eq!(refused(&|e| e.sensor.noise = -1.0), "sensor.noise");
    assert_eq!(refused(&|e| e.travel_limit = f64::NAN), "travel_limit");
    assert_eq!(refused(&|e| e.excitation = sine(500.0)), "excitation.frequency_hz");
    let relay = Excitation::Relay { h1: 0.0, h2: 1.0, hysteresis: None, reference: Reference::Start };
    assert_eq!(refused(&|e| e.excitation = relay.clone()), "excitation.h1");
}
