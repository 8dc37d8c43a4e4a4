//! The canonical form: phases within half a turn, the law unchanged.

use std::f64::consts::PI;

use breakaway_core::plant::effect::{Instant, Parameter, Role};
use breakaway_core::plant::{Base, Effect, Kind};
use proptest::prelude::*;

use super::{has_a_phase, parameters};

fn hooks(effect: &Effect<f64>, at: &Instant<f64>) -> [f64; 3] {
    let base = Base { b: 0.02685, c: 0.11, f1: 0.5 };
    [effect.force(at), effect.level(&base, at), effect.sensor(at.x)]
}

proptest! {
    /// Phases come into (−π, π], amplitudes become positive, and the law stays the same to 1e-11. Angles up to 1e4
    /// rad are rounded by 2e-12, and amplitudes add up to 3. A second time nothing changes, to the bit.
    #[test]
    fn the_canonical_form_is_the_same_effect(
        a in -1.0..1.0_f64, a2 in -2.0..2.0_f64, phases in prop::array::uniform2(-1e4..1e4_f64), whole in any::<bool>(),
        x in -10.0..10.0_f64, t in 0.0..100.0_f64,
    ) {
        let multiple = |phase: f64| if whole { (phase * 0.01).round() * PI } else { phase };
        for &kind in Kind::ALL.iter().filter(|kind| has_a_phase(**kind)) {
            let mut order = phases.into_iter().map(multiple);
            let mut amplitudes = [a, a2].into_iter();
            let values: Vec<f64> = parameters(kind).iter().map(|p| match p.role {
                Role::Phase { .. } => order.next().unwrap(),
                Role::WaveNumber => 7.0,
                Role::AngularFrequency => 0.7,
                _ => amplitudes.next().unwrap(),
            }).collect();
            let effect = Effect::new(kind, &values);
            let canonical = effect.canonical();
            for p in parameters(kind).iter().zip(canonical.p) {
                if let (Parameter { role: Role::Phase { of }, .. }, phase) = p {
                    prop_assert!(phase > -PI && phase <= PI && canonical.p[*of] >= 0.0, "{:?}", canonical);
                }
            }
            let at = Instant { t, x, v: 0.3, u: 0.0, over_s: 0.0 };
            for (was, is) in hooks(&effect, &at).into_iter().zip(hooks(&canonical, &at)) {
                prop_assert!((was - is).abs() < 1e-11, "{:?} {} {}", effect, was, is);
            }
            prop_assert_eq!(canonical.canonical(), canonical);
        }
    }
}

/// An effect without a phase is its own canonical form, and what is not finite stays so.
#[test]
fn only_phases_are_turned() {
    for &kind in Kind::ALL.iter().filter(|kind| !has_a_phase(**kind)) {
        let effect = Effect::new(kind, &[-0.5, -7.0, 300.0, -0.1, 40.0]);
        assert_eq!(effect.canonical(), effect);
    }
    let lost = Effect::new(Kind::GravityLoad, &[1.0, f64::INFINITY]);
    assert_eq!(lost.canonical(), lost);
    let half = Effect::new(Kind::GravityLoad, &[-1.0, 0.0]).canonical();
    assert_eq!(half.p[..2], [1.0, PI]);
    let other_half = Effect::new(Kind::GravityLoad, &[1.0, -PI]).canonical();
    assert_eq!(other_half.p[..2], [1.0, PI]);
}
