//! The acceptance numbers. Each is a test whose name begins with its row:
//!
//! | row | test |
//! |---|---|
//! | 1–5 | `core/tests/all/sine.rs` |
//! | 6 | `host/src/simulate/limit_cycle.rs` |
//! | 7, 8 | `tests/src/papers.rs` |
//! | 9 | `core/src/estimate/describing_function/tests.rs` |
//! | 10–12 | `core/tests/all/modulating.rs`; again here, on the host's simulated axis |
//! | 13 | here |
//! | 14 | `core/tests/all/relay.rs`, `host/src/simulate/limit_cycle.rs` |
//! | 15–18 | here |
//!
//! These tests cross crates. They run the core's estimators on the host's axis, the core's stepped plant against the
//! host's exact one, and the laws of the host's identification.

mod control;
mod laws;
mod plant;
mod rows;

use breakaway::recording::{Recording, Units};
use breakaway::simulate::axis::Axis;
use breakaway::simulate::experiment::{Excitation, Experiment, Reference, Sensor};
use breakaway_core::plant::{Base, Effect, Kind};

/// The papers' plant, f2 lumped into c (docs/theory.md, section 1).
const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
/// h1, h2 and period (s) of the pair of experiments of docs/theory.md, section 4.
const PAIR: [(f64, f64, f64); 2] = [(2.0, 1.5, 0.723195), (1.0, 0.7, 0.288730)];

/// A relay experiment on the simulated axis at 1 kHz, from standstill.
fn relay_record(load: f64, (h1, h2): (f64, f64), duration_s: f64, sensor: Sensor, seed: u64) -> Recording {
    let effects = [Effect::new(Kind::ConstantLoad, &[load])];
    let experiment = Experiment {
        name: format!("relay {h1} {h2}"),
        tick_s: 1e-3,
        duration_s,
        seed,
        drive_limit: f64::INFINITY,
        travel_limit: f64::INFINITY,
        excitation: Excitation::Relay { h1, h2, hysteresis: None, reference: Reference::Start },
        sensor,
    };
    Axis::new(BASE, &effects, Units::default()).run(&experiment).unwrap().recording
}

/// An encoder of step q with noise σ = q before it, and no delay.
fn sensor(q: f64) -> Sensor {
    Sensor { encoder_step: q, noise: q, delay_ticks: 0 }
}

fn assert_within(name: &str, found: [f64; 3], tolerances: [f64; 3]) {
    let relative = [found[0] / BASE.b - 1.0, found[1] / BASE.c - 1.0, found[2] / BASE.f1 - 1.0];
    println!("{name}: b {:+.1e} c {:+.1e} f1 {:+.1e}", relative[0], relative[1], relative[2]);
    for (error, tolerance) in relative.iter().zip(tolerances) {
        assert!(error.abs() < tolerance, "{name}: {relative:?}");
    }
}
