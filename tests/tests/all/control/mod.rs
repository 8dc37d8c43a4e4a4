//! The controller on the simulated axis, end to end: what compensation of an effect gains (docs/theory.md, section 6).
//!
//! The loop is the one of `breakaway track`: the core's controller in f32 behind an encoder and a tick of delay.

mod adaptation;
mod compensation;
mod encoder;
mod robust;

use breakaway::control::design::{Design, Request};
use breakaway::control::reference::Reference;
use breakaway::control::tracking::{Bench, track};
use breakaway::model::{BaseSe, EffectEntry, Model};
use breakaway::recording::Units;
use breakaway_core::plant::{Base, Effect};

/// The papers' plant, f2 lumped into c (docs/theory.md, section 1).
const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
/// 8000 counts per turn.
const STEP: f64 = std::f64::consts::TAU / 8000.0;

fn model(effects: &[Effect<f64>]) -> Model {
    Model {
        base: BASE,
        base_se: BaseSe::default(),
        units: Units { u: "V".into(), x: "rad".into() },
        effects: effects.iter().map(|effect| EffectEntry::of(effect, &[])).collect(),
        provenance: Vec::new(),
    }
}

/// RMS of the error on `plant` with nothing compensated (`None`), or with the base and these effects, behind
/// an encoder of that step.
fn error(plant: &[Effect<f64>], compensated: Option<&[Effect<f64>]>, reference: &str, step: f64) -> f64 {
    let request = Request {
        tick_s: 1e-3,
        delay_ticks: 1,
        bandwidth_hz: Some(10.0),
        drive_limit: 12.0,
        encoder_step: step,
        speed: Some(5.0),
        acceleration: Some(50.0),
        adaptation_rate: 2.0,
    };
    let mut design = Design::new(&model(&[]), &request).unwrap();
    design.compensate = compensated.is_some();
    let controller = design.controller_for::<f32>(&BASE, compensated.unwrap_or(&[])).unwrap();
    let bench = Bench { tick_s: 1e-3, delay_ticks: 1, encoder_step: step, noise: 0.0, drive_limit: 12.0, seed: 1 };
    let reference: Reference = reference.parse().unwrap();
    let points = reference.points(1e-3, 24_000).unwrap();
    track(&model(plant), &controller, &points, &bench, 4_000).unwrap().rms()
}
