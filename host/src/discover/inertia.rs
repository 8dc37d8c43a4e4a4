//! What the recordings tell of the inertia.

use breakaway_core::plant::effect::Memory;

use super::gap::FAR;
use super::judge::ruling::Ruling;
use crate::fit::Candidate;

/// Largest factor by which a model's inertia may be outside what the measured forces allow. In 40 sessions of the hidden plant
/// the true one is outside by 1.08 at most (docs/discovery.md, section 7). Models of real machines that ignored the drive were
/// outside by 2.6 to 190.
const OUTSIDE: f64 = 2.0;

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

/// Whether the measured forces contradict the inertia of a model. Noise in the motion makes the inertia of side U too small,
/// and noise in the drive makes that of side A too large. The true one is between them (Frisch's bounds). Where the drive
/// tells nothing of the acceleration there are no such bounds.
pub(super) fn contradicted(ruling: &Ruling, model: &Candidate) -> bool {
    let [least, most] = inertias(model);
    let [of_u, of_a] = [ruling.base.b, ruling.base.b / ruling.coherence.min(1.0)];
    ruling.tells_inertia() && (most * OUTSIDE < of_u || least > of_a * OUTSIDE)
}

/// The least inertia that accelerates in a model, and the most. A second body may swing apart from the first, and a step
/// changes the inertia.
fn inertias(model: &Candidate) -> [f64; 2] {
    let b = model.base.b;
    model.effects.iter().fold([b, b], |[least, most], effect| {
        let [before, after] = [-f64::MAX, f64::MAX].map(|t| effect.inertia(t, &Memory::default()));
        [least * before.min(after), most * before.max(after).max(1.0)]
    })
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Base, Effect, Kind};

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

    /// The forces allow 1 to 2, and half and twice of it. A second body swings apart with .64 of the inertia, and a load is
    /// picked up that makes it four times as large. Where the forces tell no inertia they contradict none.
    #[test]
    fn an_inertia_is_between_those_of_two_regressions() {
        let ruling = |coherence: f64| Ruling { coherence, ..Ruling::naming(&[], [0.1, 9.0]) };
        let model = |b: f64, effects: &[Effect<f64>]| Candidate {
            base: Base { b, c: 1.0, f1: 1.0 },
            effects: effects.to_vec(),
        };
        let outside = |b: f64, effects: &[Effect<f64>]| contradicted(&ruling(0.5), &model(b, effects));
        assert_eq!([0.49, 0.51, 3.9, 4.1].map(|b| outside(b, &[])), [true, false, false, true]);
        let load = Effect::new(Kind::FlexibleCoupling, &[0.64, 16.0, 0.02]);
        assert_eq!([11.0, 11.2].map(|b| outside(b, &[load])), [false, true]);
        let step = Effect::new(Kind::InertiaStep, &[3.0, 9.0]);
        assert_eq!([0.12, 0.13, 4.1].map(|b| outside(b, &[step])), [true, false, true]);
        assert!(!contradicted(&ruling(0.29), &model(100.0, &[])));
    }
}
