//! Whether the recordings tell the inertia.

use super::engine::FAR;
use super::judge::ruling::Ruling;

/// Why a model's inertia `b` is no measurement; `None` where it is one. `over_noise` is the model's held-out error over the
/// sensor's noise, and `unit` that of b.
///
/// The forces tell no inertia where the drive determines little of the acceleration: below break-away, or where the
/// velocity alone follows the drive. The simulated motion tells it there only near the sensor's noise. Further off, the fit
/// takes the inertia that hides best what the model misses, and its standard error says nothing of that.
pub(super) fn untold(ruling: &Ruling, b: f64, over_noise: f64, unit: &str) -> Option<String> {
    let percent = 100.0 * ruling.coherence.clamp(0.0, 1.0);
    let by_force = ruling.base.b;
    (!ruling.tells_inertia() && over_noise > FAR).then(|| {
        format!(
            "the recordings do not tell the inertia: the drive determines {percent:.0} % of the acceleration. The forces \
             give b = {by_force:.2e} {unit}, and the model has {b:.2e}. Record steps and reversals that accelerate the axis"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An arm that hardly moves (CICESE): the drive determines nothing of its acceleration. Near the noise the motion tells
    /// the inertia nevertheless. Where the drive determines the acceleration, the forces do.
    #[test]
    fn what_neither_forces_nor_motion_tell_is_said() {
        let with = |coherence: f64| Ruling { coherence, ..Ruling::naming(&[], [0.1, 400.0]) };
        let remark = |coherence: f64, over_noise: f64| untold(&with(coherence), 271.0, over_noise, "Nm·s²/rad");
        let said = remark(0.05, 400.0).unwrap();
        assert!(said.contains("determines 5 %") && said.contains("has 2.71e2"), "{said}");
        assert_eq!([remark(0.05, 2.0), remark(0.6, 400.0)], [None, None]);
    }
}
