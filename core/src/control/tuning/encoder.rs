//! Tuning behind an encoder: what one count makes of the drive is bounded.
//!
//! A count is a step of e, and ė of a step is the faster, the larger. Where the filter of 1/(8·ωc) alone lets a count
//! make too much of the drive, an observer takes its place. At 16·ωc it is as late as the filter, 7° at the
//! crossover, and a count makes less. It goes down to 6·ωc, 19°, as far as the encoder needs. What is too much even
//! then asks for less bandwidth.

use super::{Gains, TuningError, acceptable, largest_bandwidth_hz, tune};

/// The encoder, and what one count of it may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Encoder step, X; 0 where it is not known: then nothing is bounded.
    pub step: f64,
    /// The largest drive that one count may make, drive units.
    pub drive: f64,
}

impl Resolution {
    /// Whether one count makes no more than it may.
    fn bears(&self, gains: &Gains, tick_s: f64) -> bool {
        gains.drive_of_count(self.step, tick_s) <= self.drive
    }
}

/// The observer's bandwidth over the crossover: slowest and fastest.
const OBSERVER: [f64; 2] = [6.0, 16.0];
/// Halvings of an interval: to 1e-9 of it.
const HALVINGS: usize = 30;

/// The plant and the tick that gains are for.
#[derive(Clone, Copy)]
struct Place {
    b: f64,
    c: f64,
    tick_s: f64,
    delay_ticks: u32,
}

impl Place {
    fn tune(self, bandwidth_hz: f64) -> Result<Gains, TuningError> {
        tune(self.b, self.c, bandwidth_hz, self.tick_s, self.delay_ticks)
    }

    fn stable(self, gains: &Gains) -> bool {
        acceptable(gains, self.b, self.c, self.tick_s, self.delay_ticks)
    }

    /// Ratio of the slowest observer that leaves the margins; `None` if none does.
    fn slowest(self, filtered: Gains, bandwidth_hz: f64) -> Option<f64> {
        let stable = |ratio: f64| self.stable(&observed(filtered, bandwidth_hz, ratio));
        let [slowest, fastest] = OBSERVER;
        if stable(slowest) {
            Some(slowest)
        } else if stable(fastest) {
            // The margins grow with the ratio.
            Some(fastest - last(fastest - slowest, |less| stable(fastest - less)))
        } else {
            None
        }
    }
}

/// The gains of [`tune`], with an observer at `ratio` times the crossover in place of the filter.
fn observed(gains: Gains, bandwidth_hz: f64, ratio: f64) -> Gains {
    Gains { filter_s: 0.0, observer_rad_s: ratio * core::f64::consts::TAU * bandwidth_hz, ..gains }
}

/// The largest number up to `most` at which `holds`, which it does from 0 on up to there.
fn last(most: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// As [`tune`], behind an encoder: with an observer where the filter alone lets a count make more than it may. A bandwidth at
/// which no observer helps is not refused: [`Gains::drive_of_count`] tells, [`encoder_bandwidth_hz`] is the largest at which
/// one does.
///
/// # Errors
/// As [`tune`].
pub fn tune_behind(
    b: f64,
    c: f64,
    bandwidth_hz: f64,
    tick_s: f64,
    delay_ticks: u32,
    encoder: &Resolution,
) -> Result<Gains, TuningError> {
    let place = Place { b, c, tick_s, delay_ticks };
    let filtered = place.tune(bandwidth_hz)?;
    if encoder.bears(&filtered, tick_s) {
        return Ok(filtered);
    }
    let Some(slow) = place.slowest(filtered, bandwidth_hz) else { return Ok(filtered) };
    // What a count makes grows with the ratio.
    let borne = |more: f64| encoder.bears(&observed(filtered, bandwidth_hz, slow + more), tick_s);
    let [_, fastest] = OBSERVER;
    let ratio = if borne(fastest - slow) { fastest } else { slow + last(fastest - slow, borne) };
    Ok(observed(filtered, bandwidth_hz, ratio))
}

/// The largest bandwidth at which one count makes no more than it may, Hz; at most [`largest_bandwidth_hz`].
pub fn encoder_bandwidth_hz(b: f64, c: f64, tick_s: f64, delay_ticks: u32, encoder: &Resolution) -> f64 {
    let place = Place { b, c, tick_s, delay_ticks };
    let borne = |hz: f64| {
        let Ok(filtered) = place.tune(hz) else { return false };
        let slow = || place.slowest(filtered, hz).map(|ratio| observed(filtered, hz, ratio));
        encoder.bears(&filtered, tick_s) || slow().is_some_and(|gains| encoder.bears(&gains, tick_s))
    };
    let largest = largest_bandwidth_hz(b, c, tick_s, delay_ticks);
    if largest <= 0.0 || borne(largest) { largest } else { last(largest, borne) }
}

#[cfg(test)]
mod tests;
