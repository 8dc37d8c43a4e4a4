//! From a model to a controller and its closed loop: tuning, the controller's file, references, tracking on the simulated plant.

pub mod design;
pub mod file;
pub mod reference;
pub mod tracking;

use breakaway_core::control::{AdaptiveError, CompensatorError, DriftError, TuningError};

use crate::file::FileError;

/// Why a controller cannot be made, read or run.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ControlError {
    /// The gains are past what the sampled loop allows.
    #[error("{0}")]
    Tuning(String),
    /// One count of the encoder drives too much at any bandwidth worth having.
    #[error(
        "an encoder step of {step:?} bears a bandwidth of {bandwidth_hz:.2e} Hz: check --encoder-step and the model's units, \
         or ask for a --bandwidth"
    )]
    Encoder {
        /// Its step, X.
        step: f64,
        /// Largest bandwidth, Hz.
        bandwidth_hz: f64,
    },
    /// The model cannot be compensated.
    #[error("the model cannot be compensated: {0}")]
    Compensator(
        #[from]
        #[serde(skip)]
        CompensatorError,
    ),
    /// The drift watch refuses its settings.
    #[error("the drift watch refuses its settings: {0}")]
    Drift(
        #[from]
        #[serde(skip)]
        DriftError,
    ),
    /// The reference is not one.
    #[error("--reference {text}: {reason}")]
    Reference {
        /// What was given.
        text: String,
        /// What is wrong with it, and what it should be.
        reason: String,
    },
    /// The file cannot be read, or is of another kind.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not a controller.
    #[error("{file} is not a controller: {reason}")]
    Malformed {
        /// The file.
        file: String,
        /// Line, and what was expected.
        reason: String,
    },
}

impl From<TuningError> for ControlError {
    fn from(error: TuningError) -> Self {
        Self::Tuning(match error {
            TuningError::Bandwidth { largest_hz } if largest_hz < 1e-4 => {
                "no bandwidth is possible with this model, tick and delay: check --tick (s) and the model's units"
                    .into()
            }
            other => other.to_string(),
        })
    }
}

impl From<AdaptiveError> for ControlError {
    fn from(error: AdaptiveError) -> Self {
        match error {
            AdaptiveError::Gains(error) => error.into(),
            AdaptiveError::Sigma => Self::Tuning(format!("{error}; lower --adaptation-rate, or check --encoder-step")),
            other => Self::Tuning(other.to_string()),
        }
    }
}
