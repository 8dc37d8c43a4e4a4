//! Sine fit of a recorded signal: the core's batch fit, a first guess of the frequency, and its errors in words.

mod guess;

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use breakaway_core::estimate::sine::{FrequencySearch, SineError, SineModel, fit_free};

pub use breakaway_core::estimate::sine::{SineErrors, SineFit};

use crate::recording::Signal;

/// Why a signal has no sine fit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum SineFitError {
    /// No or hardly any samples between `--from` and `--to`.
    #[error("{samples} sample(s) from {from_s} s to {to_s} s; the recording runs from {first_s} s to {last_s} s")]
    Window {
        /// Samples in the window.
        samples: usize,
        /// Start of the window, s.
        from_s: f64,
        /// End of the window, s.
        to_s: f64,
        /// First time of the recording, s.
        first_s: f64,
        /// Last time of the recording, s.
        last_s: f64,
    },
    /// The core's fit refused.
    #[error("{}", in_words(.0))]
    Fit(#[serde(skip)] SineError),
}

/// Fits one sine with offset to the samples whose time lies in `window`. `period_s` is a guess, right within a factor of two;
/// without it the strongest line of the signal's spectrum is looked at. The clock may jitter and have gaps.
///
/// # Errors
/// [`SineFitError`].
pub fn fit(signal: &Signal, window: RangeInclusive<f64>, period_s: Option<f64>) -> Result<SineFit, SineFitError> {
    let start = signal.t.partition_point(|t| t < window.start());
    let end = signal.t.partition_point(|t| t <= window.end());
    let t = signal.t.get(start..end).unwrap_or_default();
    let y = signal.y.get(start..end).unwrap_or_default();
    if t.len() < crate::recording::MIN_ROWS {
        return Err(SineFitError::Window {
            samples: t.len(),
            from_s: *window.start(),
            to_s: *window.end(),
            first_s: signal.t.first().copied().unwrap_or(0.0),
            last_s: signal.t.last().copied().unwrap_or(0.0),
        });
    }
    let search = |range| {
        let samples = t.iter().copied().zip(y.iter().copied());
        fit_free(samples, range, SineModel::default()).map_err(SineFitError::Fit)
    };
    if let Some(period) = period_s {
        return search(FrequencySearch::around(TAU / period));
    }
    let line = guess::strongest_line(t, y).ok_or(SineFitError::Fit(SineError::ZeroSignal))?;
    // The spectrum's line is known to within its step; a range of two saves 90 % of the time that half to twice would take.
    let reach = 2.0 * line.step;
    if reach < 0.25 * line.omega {
        let near = search(FrequencySearch::between(line.omega - reach, line.omega + reach));
        if !matches!(near, Err(SineFitError::Fit(SineError::SearchEdge { .. }))) {
            return near;
        }
    }
    search(FrequencySearch::around(line.omega))
}

/// What the core's error means for the owner of the recording, who knows periods and `--period`.
fn in_words(error: &SineError) -> String {
    match error {
        SineError::TooFewCycles { .. } => format!("{error}, or give --period if the guess is wrong"),
        SineError::Frequency { limit_rad_s } => {
            format!("the period is too short for the sampling rate: it must be more than {:.4e} s", TAU / limit_rad_s)
        }
        SineError::SearchEdge { omega_rad_s } => format!(
            "the best frequency is at the edge of the search (period {:.4e} s); give a better --period, or record more cycles",
            TAU / omega_rad_s
        ),
        SineError::Recentre { omega_rad_s } => {
            format!("the guess of the frequency is too far off; give --period {:.4e}", TAU / omega_rad_s)
        }
        SineError::OutOfReach => format!("{error}; give a better --period"),
        other => other.to_string(),
    }
}
