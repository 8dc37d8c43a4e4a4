//! Weights of the windows, by the speed in them.

use super::regression::rms;
use super::sides::Fitted;
use super::weak_form::WeakForm;

/// Weights of the windows on either side.
#[derive(Clone, Debug)]
pub struct Weights {
    /// Of the drive's residual.
    pub u: Vec<f64>,
    /// Of the acceleration's.
    pub a: Vec<f64>,
}

impl Weights {
    /// Equal ones.
    pub fn equal(form: &WeakForm<'_>) -> Self {
        Self { u: vec![1.0; form.rows.len()], a: vec![1.0; form.rows.len()] }
    }

    /// The inverse rms residual in classes of the speed, each a factor of two wide. Jitter and ripple grow with speed.
    pub fn of(form: &WeakForm<'_>, fitted: &Fitted) -> Self {
        Self { u: by_speed(form, &fitted.u.residual), a: by_speed(form, &fitted.a.residual) }
    }
}

/// Weights of the windows: the inverse rms residual in classes of the speed, each a factor of two wide.
pub(super) fn by_speed(form: &WeakForm<'_>, residual: &[f64]) -> Vec<f64> {
    let class = |v: f64| (v.abs() / form.v95).max(1e-6).log2().floor() as i32;
    let overall = rms(residual).max(f64::MIN_POSITIVE);
    let mut sums: std::collections::BTreeMap<i32, (f64, f64)> = std::collections::BTreeMap::new();
    for (r, v) in residual.iter().zip(&form.row_v) {
        let sum = sums.entry(class(*v)).or_default();
        sum.0 += r * r;
        sum.1 += 1.0;
    }
    let each = form.row_v.iter().map(|v| {
        let (square, count) = sums[&class(*v)];
        // The rms of a class with few windows is drawn to that of all.
        1.0 / ((square + 20.0 * overall * overall * 1e-2) / (count + 0.2)).sqrt().max(1e-3 * overall)
    });
    each.collect()
}
