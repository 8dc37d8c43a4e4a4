//! Tests of the hidden plant against closed forms, the table's laws and itself.

mod cycles;
mod golden;
mod laws;
mod mechanics;
mod sensing;
mod sessions;
mod shaking;
mod worlds;

use crate::law::ForceLaw;

/// The papers' plant: b = 0.02685, c = 0.11, f1 = 0.5 (docs/theory.md, section 1).
fn papers() -> ForceLaw {
    ForceLaw { b: 0.02685, c: 0.11, f1: 0.5, ..ForceLaw::default() }
}

#[track_caller]
fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}
