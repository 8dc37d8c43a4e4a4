//! The base model by equation error in weak form, and whether its answer can be an axis'.

use nalgebra::{DMatrix, DVector};

use super::error::IdentifyError;
use super::result::{ModelEstimate, Value};
use super::weak::{self, WeakFit, Window};

/// The estimator's name.
pub(super) const WEAK_FORM: &str = "weak_form";
/// Standard errors from which a negative friction is taken at its word.
pub(super) const SIGNIFICANCE: f64 = 4.0;
/// A drive that follows the direction of motion to within this share is friction and nothing else.
const SAME_DRIVE: f64 = 1e-6;

/// Whether a friction is negative by more than its error.
pub(super) fn negative(friction: Value) -> bool {
    friction.value < -SIGNIFICANCE * friction.se
}

/// Root mean square of the drive that a fit leaves, over the drive's.
pub(super) fn unexplained(fit: &WeakFit, windows: &[Window]) -> f64 {
    fit.residual.norm() / windows.iter().map(|w| w.drive * w.drive).sum::<f64>().sqrt()
}

pub(super) fn both_directions(windows: &[Window]) -> bool {
    let forward = windows.iter().filter(|w| w.direction > 0.0).count();
    let least = (windows.len() / 50).max(3);
    forward >= least && windows.len() - forward >= least
}

/// Whether the drive has one value for each direction of motion: b = c = 0 then solves the equation.
fn follows_direction(windows: &[Window]) -> bool {
    [-1.0, 1.0].iter().all(|sign| {
        let means = || windows.iter().filter(|w| w.direction * sign > 0.0).map(|w| w.drive / w.unit);
        let (low, high) = means().fold((f64::MAX, f64::MIN), |(low, high), u| (low.min(u), high.max(u)));
        high - low <= SAME_DRIVE * high.abs().max(low.abs()) || low > high
    })
}

pub(super) fn solve_base(windows: &[Window], both: bool) -> Result<WeakFit, IdentifyError> {
    let (columns, target) = weak::base_columns(windows);
    let columns: DMatrix<f64> = if both { columns } else { columns.columns(0, 3).into_owned() };
    let refuse = |parameter, advice| Err(IdentifyError::Undetermined { parameter, advice });
    if follows_direction(windows) {
        return refuse(
            "b",
            "the drive never changes while the axis moves one way. Friction f1 equal to the drive explains all of \
             it. Record a drive that changes, such as a relay experiment or a sine",
        );
    }
    match weak::solve(&columns, &DVector::from_column_slice(target.as_slice())) {
        Some(fit) if fit.condition < 1e8 => Ok(fit),
        _ => {
            let flat = |j: usize| {
                let column = columns.column(j);
                let mean = column.mean();
                column.iter().all(|value| (value - mean).abs() <= 1e-3 * mean.abs())
            };
            if flat(1) {
                refuse(
                    "c",
                    "the speed never changes, so viscous and Coulomb friction are one force: record several speeds",
                )
            } else {
                refuse(
                    "b",
                    "inertia and friction forces keep one ratio throughout: record reversals at more than one drive level",
                )
            }
        }
    }
}

pub(super) fn from_weak(fit: &WeakFit, both: bool) -> ModelEstimate {
    let value = |i: usize| Value { value: fit.coefficients[i], se: fit.covariance[(i, i)].max(0.0).sqrt() };
    ModelEstimate { estimator: WEAK_FORM, b: value(0), c: value(1), f1: value(2), load: both.then(|| value(3)) }
}
