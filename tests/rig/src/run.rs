//! The numbers of the papers' axis, and experiments on it.

use breakaway_core::link::{Bounds, FULL_SCALE_CODE, Reference, Relay};

/// Control ticks per second.
pub const TICK_HZ: u32 = 1000;
/// Encoder step, rad.
pub const STEP: f64 = 1e-3;
/// Drive at full scale, V.
pub const FULL_SCALE: f64 = 5.0;

/// Drive code of a voltage.
pub fn code(volts: f64) -> i16 {
    (volts / FULL_SCALE * f64::from(FULL_SCALE_CODE)).round() as i16
}

/// A dual relay of amplitudes in V, until it is stopped where `ticks` is 0.
pub fn relay(h1: f64, h2: f64, ticks: u32) -> Relay {
    Relay {
        h1_code: code(h1),
        h2_code: code(h2),
        hysteresis_counts: Some(1),
        reference: Reference::default(),
        until_settled: false,
        append: true,
        bounds: Bounds { max_ticks: ticks, ..Bounds::default() },
    }
}
