//! The frequency response from drive to position, without a model: gain, phase, coherence, and what stands out in it.
//!
//! Spectra are averaged over segments by Welch's method ([`spectra`]). A rational function with a delay is fitted where they
//! are coherent ([`rational`], [`modes`]): its poles are resonances, its zeros antiresonances (docs/theory.md, section 8).

mod error;
mod even;
mod modes;
mod rational;
mod spectra;

use nalgebra::Complex;

pub use error::ResponseError;

use crate::recording::Recording;
use spectra::Spectra;

/// Segments that all recordings together should give. The standard error of a gain is then 18 % at a coherence of ½.
const SEGMENTS: usize = 16;
/// Shortest segment, samples: below it there are too few frequencies.
const SHORTEST: usize = 32;
/// Lines next to zero that hold what the window spreads of the mean.
const SPREAD_LINES: usize = 2;
/// Frequencies are given up to this share of the sampling rate. Above it the held drive's images are large.
const HIGHEST: f64 = 0.4;
/// A mode as wide as so many lines is widened by less than 4 %.
const RESOLVED_LINES: f64 = 4.0;
/// A frequency is coherent up to this standard error of its gain, as a share.
const MOST_ERROR: f64 = 0.1;
/// And with a coherence that chance reaches once in so many frequencies.
const CHANCE: f64 = 0.01;
/// And if so large a share of the frequencies within a sixth of an octave is coherent too: a multisine has gaps.
const LEAST_NEIGHBOURS: f64 = 1.0 / 3.0;
const NEIGHBOURHOOD_OCTAVES: f64 = 1.0 / 6.0;

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error, by the jackknife over groups of segments.
    pub se: f64,
}

/// A resonance or an antiresonance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Natural frequency, Hz.
    pub frequency_hz: Estimate,
    /// Damping ratio. An antiresonance of drive and sensor on two bodies may have a negative one.
    pub damping_ratio: Estimate,
}

/// The response at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Position over drive, as a complex number: of the drive itself, not of its samples.
    pub response: Complex<f64>,
    /// Standard error of the gain.
    pub gain_se: f64,
    /// Phase, rad, continued from the lowest frequency.
    pub phase_rad: f64,
    /// Share of the position's power that follows the drive linearly, 0 to 1.
    pub coherence: f64,
    /// Whether the coherence suffices.
    pub coherent: bool,
}

/// A frequency response, and what stands out in it.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    /// The response, by frequency.
    pub points: Vec<Point>,
    /// Segments that were averaged.
    pub segments: usize,
    /// Length of a segment, s. Frequencies are its reciprocal apart.
    pub segment_s: f64,
    /// Resonances, by frequency.
    pub resonances: Vec<Mode>,
    /// Antiresonances, by frequency.
    pub antiresonances: Vec<Mode>,
    /// Delay from drive to position, s; `None` where too few frequencies are coherent.
    pub delay_s: Option<Estimate>,
    /// Some recordings were not sampled evenly, and were interpolated.
    pub interpolated: bool,
}

impl FrequencyResponse {
    /// Of recordings of one axis. A segment has `segment_s`, or as much as gives 16 segments.
    ///
    /// # Errors
    /// [`ResponseError`].
    pub fn of(recordings: &[Recording], segment_s: Option<f64>) -> Result<Self, ResponseError> {
        let even = even::of(recordings)?;
        let length = match segment_s {
            Some(segment_s) => (segment_s / even.interval_s).round() as usize,
            None => spectra::longest(&even.pieces, SEGMENTS),
        };
        let recorded = even.pieces.iter().map(even::Piece::len).max().unwrap_or(0);
        if length < SHORTEST || length > recorded {
            let seconds = |samples: usize| samples as f64 * even.interval_s;
            return Err(match segment_s {
                Some(segment_s) => {
                    ResponseError::Segment { segment_s, least_s: seconds(SHORTEST), most_s: seconds(recorded) }
                }
                None => ResponseError::TooShort { samples: recorded, needed: SHORTEST },
            });
        }
        let spectra = Spectra::of(&even, length);
        let points = spectra.points();
        if !points.iter().any(|point| point.coherent) {
            return Err(ResponseError::Incoherent { segments: spectra.segments() });
        }
        let found = modes::find(&spectra);
        Ok(Self {
            points,
            segments: spectra.segments(),
            segment_s: length as f64 * even.interval_s,
            resonances: found.resonances,
            antiresonances: found.antiresonances,
            delay_s: found.delay_s,
            interpolated: even.interpolated,
        })
    }

    /// Whether a mode is too narrow for the segments: the window then widens it, and its damping ratio is too large.
    pub fn is_narrow(&self, mode: &Mode) -> bool {
        2.0 * mode.damping_ratio.value.abs() * mode.frequency_hz.value < RESOLVED_LINES / self.segment_s
    }

    /// The points at which the coherence suffices.
    pub fn coherent(&self) -> impl DoubleEndedIterator<Item = &Point> {
        self.points.iter().filter(|point| point.coherent)
    }
}

#[cfg(test)]
mod tests;
