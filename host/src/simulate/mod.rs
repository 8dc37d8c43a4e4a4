//! The simulated axis: event-exact base plant, stepped plant with any effects, sampled experiments.

pub mod axis;
pub mod exact;
pub mod experiment;
pub mod limit_cycle;
pub mod motion;
pub mod suite;

/// Why an experiment could not be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum SimulateError {
    /// The experiment file cannot be read, or is of another kind.
    #[error(transparent)]
    File(#[from] crate::file::FileError),
    /// The experiment file is not what it should be.
    #[error("{file} is not an experiment: {reason}")]
    Malformed {
        /// File.
        file: String,
        /// Line, and what was expected.
        reason: String,
    },
    /// A field is out of range.
    #[error("{field} = {} is out of range: it must be {need}", readable(*value))]
    Range {
        /// Field of the experiment file.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The range.
        need: &'static str,
    },
    /// The relay refuses its configuration.
    #[error("the relay refuses its configuration: {0}")]
    Relay(String),
    /// The position left the range of numbers.
    #[error("the simulation of {experiment} diverged at t = {t} s: the model is unstable or its units are wrong")]
    Diverged {
        /// Experiment.
        experiment: String,
        /// Session time, s.
        t: f64,
    },
    /// The axis does not move.
    #[error(
        "the axis does not break away below the drive limit of {}: raise the limit, or free the axis. It counts as \
         moving when its reading has changed by ten encoder steps or ten deviations of the noise",
        readable(*.0)
    )]
    NoBreakaway(f64),
}

/// A number of any size in a message: not three hundred digits of it.
fn readable(value: f64) -> String {
    let plain = value == 0.0 || (1e-4..1e9).contains(&value.abs()) || !value.is_finite();
    if plain { value.to_string() } else { format!("{value:e}") }
}
