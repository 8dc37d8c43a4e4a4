//! From a model to a controller and its closed loop: tuning, the controller's file, references, tracking on the simulated plant.

pub mod design;
pub mod file;
pub mod reference;
pub mod tracking;

use breakaway_core::control::{AdaptiveError, CompensatorError, DriftError, TrajectoryError, TuningError};

/// Why a controller cannot be made, read or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ControlError {
    /// The gains are past what the sampled loop allows.
    #[error("{0}")]
    Tuning(String),
    /// The model cannot be compensated.
    #[error("the model cannot be compensated: {0:?}")]
    Compensator(CompensatorError),
    /// The drift watch refuses its settings.
    #[error("the drift watch refuses its settings: {0:?}")]
    Drift(DriftError),
    /// The reference is not one.
    #[error("--reference {text}: {reason}")]
    Reference {
        /// What was given.
        text: String,
        /// What is wrong with it, and what it should be.
        reason: String,
    },
    /// The file cannot be read.
    #[error("{file}: the controller cannot be read; check the path")]
    Read {
        /// The file.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
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
            TuningError::B => "b must be a finite number above 0".into(),
            TuningError::C => "c must be a finite number, 0 or more".into(),
            TuningError::Tick => "the tick must be above 0".into(),
            TuningError::Limit => "the drive limit must be above 0".into(),
            TuningError::Gain => "kv and lambda2 must be above 0, lambda1 and filter_s 0 or more".into(),
            TuningError::Bandwidth { largest_hz } if largest_hz < 1e-4 => {
                "no bandwidth is possible with this model, tick and delay: check --tick (s) and the model's units"
                    .into()
            }
            TuningError::Bandwidth { largest_hz } => format!(
                "the bandwidth is past what this tick and delay allow; the largest for this model is {largest_hz:.4} Hz"
            ),
            TuningError::Rate { largest_per_s } => {
                format!("kv + lambda2 is past what this tick and delay allow; the largest is {largest_per_s:.4} per s")
            }
        })
    }
}

impl From<AdaptiveError> for ControlError {
    fn from(error: AdaptiveError) -> Self {
        let past = |name: &str, largest: f64| {
            Self::Tuning(format!("adaptation gain {name} is past what this tick allows; the largest is {largest:.4e}"))
        };
        match error {
            AdaptiveError::Gains(error) => error.into(),
            AdaptiveError::B { largest } => past("b", largest),
            AdaptiveError::C { largest } => past("c", largest),
            AdaptiveError::F1 { largest } => past("f1", largest),
            AdaptiveError::F { largest } => past("f", largest),
            AdaptiveError::Delta => Self::Tuning("delta must be above 0".into()),
            AdaptiveError::Sigma => {
                Self::Tuning(
                    "the adaptive law's sigma must be 0 or more, and sigma times the gain f times the tick at most 1; lower \
                     --adaptation-rate, or check --encoder-step"
                        .into(),
                )
            }
            AdaptiveError::SmallestB => Self::Tuning("b_min must be 0 or more".into()),
            AdaptiveError::Start => Self::Tuning("start values must be 0 or more".into()),
            AdaptiveError::Motion => Self::Tuning("speed and acceleration must be 0 or more".into()),
        }
    }
}

impl From<CompensatorError> for ControlError {
    fn from(error: CompensatorError) -> Self {
        Self::Compensator(error)
    }
}

impl From<DriftError> for ControlError {
    fn from(error: DriftError) -> Self {
        Self::Drift(error)
    }
}

/// What a reference of the core refuses, in words.
fn trajectory_reason(error: TrajectoryError) -> &'static str {
    match error {
        TrajectoryError::Tick => "the tick must be above 0",
        TrajectoryError::Distance => "the amplitude or distance must be a finite number",
        TrajectoryError::Frequency => "the frequency must be above 0 and below half the tick rate",
        TrajectoryError::Speed => "the speed must be above 0",
        TrajectoryError::Acceleration => "the acceleration must be above 0",
        TrajectoryError::Jerk => "the jerk must be above 0",
        TrajectoryError::Duration => "the move or the rest takes too long",
        TrajectoryError::Empty => "there are no samples",
    }
}
