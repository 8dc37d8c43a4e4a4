//! What an identification gives: numbers with errors, the estimators' answers, what stays open.

use super::choice::Choice;
use super::gravity::GravityTrial;
use super::remark::Remark;
use super::winding::Winding;
use crate::fit::Fit;

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
}

/// What one estimator says.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelEstimate {
    /// Name: `weak_form`, `output_error`, and for relay limit cycles `modulating` and `describing_function`.
    pub estimator: &'static str,
    /// Inertia.
    pub b: Value,
    /// Viscous.
    pub c: Value,
    /// Coulomb.
    pub f1: Value,
    /// Constant load, where both directions are seen.
    pub load: Option<Value>,
}

/// A parameter that the data cannot determine, and what would.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undetermined {
    /// `b`, `c`, `f1` or `load`.
    pub parameter: &'static str,
    /// Why, and the experiment that would.
    pub advice: String,
}

/// The result of an identification.
#[derive(Clone, Debug)]
pub struct Identification {
    /// The estimate to use.
    pub best: ModelEstimate,
    /// Whose it is, and why.
    pub choice: Choice,
    /// All estimates.
    pub estimates: Vec<ModelEstimate>,
    /// The load, if it is significant.
    pub load: Option<Value>,
    /// What the data cannot determine.
    pub undetermined: Vec<Undetermined>,
    /// Position noise, position units.
    pub noise: f64,
    /// Median over the segments of the root mean square simulation error, position units.
    pub simulation_error: f64,
    /// Correlation of the weak-form residual between neighbouring windows that do not overlap.
    pub residual_correlation: f64,
    /// Whether the simulation error is down to the noise.
    pub white: bool,
    /// Gravity beside the base, where the position is an angle, the motion covers enough of it, and the model misses something.
    pub gravity: Option<GravityTrial>,
    /// The motor's winding, where the current is recorded.
    pub winding: Option<Winding>,
    /// What is remarked beside the numbers.
    pub remarks: Vec<Remark>,
    /// The output-error fit.
    pub fit: Option<Fit>,
}

/// A base model to start a fit from.
#[derive(Clone, Debug)]
pub struct StartingModel {
    /// The estimate.
    pub best: ModelEstimate,
    /// Remarks in words, without the one that the base misses something: a discovery says what it misses.
    pub remarks: Vec<String>,
}
