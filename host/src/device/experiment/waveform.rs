//! A multisine as one period of the board's waveform table.

use std::f64::consts::TAU;

use breakaway_core::excite::waveform::TABLE_POINTS;
use breakaway_core::link::WaveformPart;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::device::DeviceError;

/// Highest harmonic: four points of the table per period. The drive is recorded as it was applied, so that straight lines
/// between the points cost amplitude (a tenth at this harmonic), not accuracy.
const MOST_HARMONICS: usize = TABLE_POINTS / 4;
/// Points of a part.
const PART: usize = 64;

/// The harmonics of `from_hz` up to `to_hz` with random phases and a peak of 1, as parts of the table; and its period, s.
///
/// # Errors
/// [`DeviceError::Range`] if the table is too short for so many harmonics.
pub fn multisine(from_hz: f64, to_hz: f64, seed: u64) -> Result<(Vec<WaveformPart>, f64), DeviceError> {
    let harmonics = (to_hz / from_hz * (1.0 + 1e-9)).floor() as usize;
    if harmonics > MOST_HARMONICS {
        let need = format!("on a board at most {MOST_HARMONICS} times from_hz");
        return Err(DeviceError::Range { what: "excitation.to_hz", value: to_hz, need });
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let phases: Vec<f64> = (0..harmonics).map(|_| rng.random_range(0.0..TAU)).collect();
    let point = |i: usize| -> f64 {
        let at = TAU * i as f64 / TABLE_POINTS as f64;
        phases.iter().enumerate().map(|(k, phase)| ((k + 1) as f64 * at + phase).sin()).sum()
    };
    let points: Vec<f64> = (0..TABLE_POINTS).map(point).collect();
    let peak = points.iter().fold(f64::MIN_POSITIVE, |peak, value| peak.max(value.abs()));
    let scaled: Vec<i16> = points.iter().map(|value| (value / peak * 32_767.0).round() as i16).collect();
    let parts = scaled
        .chunks(PART)
        .enumerate()
        .map(|(i, chunk)| WaveformPart { offset: (i * PART) as u16, points: chunk.iter().copied().collect() })
        .collect();
    Ok((parts, 1.0 / from_hz))
}
