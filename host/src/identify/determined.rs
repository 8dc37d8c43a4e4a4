//! What the data determine: a load that is significant, and parameters that are not told from zero.

use super::result::{ModelEstimate, Undetermined, Value};

/// A load is reported when it exceeds this many standard errors and this share of the Coulomb friction.
const LOAD_SIGNIFICANCE: (f64, f64) = (4.0, 0.01);

/// The load, where it exceeds its error and a share of the Coulomb friction.
pub(super) fn significant_load(best: &ModelEstimate) -> Option<Value> {
    let (errors, share) = LOAD_SIGNIFICANCE;
    best.load.filter(|load| load.value.abs() > (errors * load.se).max(share * best.f1.value))
}

pub(super) fn weakly_determined(estimate: &ModelEstimate, undetermined: &mut Vec<Undetermined>) {
    for (parameter, value, advice) in [
        ("b", estimate.b, "record faster reversals: a relay experiment with a larger h1"),
        ("c", estimate.c, "record higher speeds, or relay experiments with different h2"),
        ("f1", estimate.f1, "record slower motion in both directions, or relay experiments with different h2"),
    ] {
        if !value.se.is_finite() || value.se > 0.3 * value.value.abs() || value.value < 0.0 {
            undetermined.push(Undetermined {
                parameter,
                advice: format!(
                    "{:.3e} ± {:.1e} does not differ from zero, or not from the other terms, beyond its error: {advice}",
                    value.value, value.se
                ),
            });
        }
    }
}
