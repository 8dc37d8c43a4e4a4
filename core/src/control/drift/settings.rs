//! Settings of the drift watch, and why they are refused.

use crate::control::compensator::CompensatorError;
use crate::scalar::Real;

/// Settings of the watch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftSettings<F = f64> {
    /// ωo, rad/s; several times the motion's own frequencies, well below 1/Ts.
    pub bandwidth_rad_s: F,
    /// Speed below which the axis counts as resting, X/s; > 0.
    pub rest_speed: F,
    /// Blocks of either direction that teach mean and scale; at least 8.
    pub calibration: u32,
    /// k: what a block may be off, in units of the scale; > 0.
    pub slack: F,
    /// h: the alarm's level; > 0.
    pub threshold: F,
    /// Smallest scale, drive units: a residual that happened to be still in the calibrated stretch must not make the
    /// watch nervous.
    pub smallest_scale: F,
}

impl<F: Real> DriftSettings<F> {
    /// Settings for a model with Coulomb friction `f1` (drive units) followed at ωo: slack 1, alarm at 12 (Gaussian
    /// blocks: one false alarm in 10¹¹ of them), 64 blocks of calibration, a scale of 2 % of f1 at least.
    pub fn usual(bandwidth_rad_s: F, rest_speed: F, f1: F) -> Self {
        let (slack, threshold) = (F::ONE, F::from_f64(12.0));
        Self { bandwidth_rad_s, rest_speed, calibration: 64, slack, threshold, smallest_scale: f1.scale(0.02) }
    }
}

/// Why a watch is refused; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriftError {
    /// The model.
    Model(CompensatorError),
    /// The tick is not finite and positive.
    Tick,
    /// ωo is not positive or above 1/(2·Ts).
    Bandwidth,
    /// The rest speed is not finite and positive.
    RestSpeed,
    /// Fewer than 8 blocks of calibration.
    Calibration,
    /// Slack or threshold is not finite and positive.
    Threshold,
    /// The smallest scale is not finite and positive.
    Scale,
}
