//! What the catalogue says of its effects is true of their laws.

use std::f64::consts::PI;

use breakaway_core::plant::effect::{Instant, Parameter, Role, Search};
use breakaway_core::plant::{Base, Drive, Effect, Kind, Plant};
use proptest::prelude::*;

fn parameters(kind: Kind) -> &'static [Parameter] {
    kind.definition().parameters
}

fn has_a_phase(kind: Kind) -> bool {
    parameters(kind).iter().any(|p| matches!(p.role, Role::Phase { .. }))
}

/// Role and search say the same: a program that goes by the one is not misled by the other.
#[test]
fn a_role_is_searched_as_what_it_is() {
    for &kind in Kind::ALL {
        for (index, p) in parameters(kind).iter().enumerate() {
            let said = (kind.name(), p.symbol);
            assert_eq!(matches!(p.role, Role::Phase { .. }), p.search == Search::Phase, "{said:?}");
            let frequency = matches!(p.role, Role::WaveNumber | Role::AngularFrequency);
            assert_eq!(frequency, matches!(p.search, Search::Spectrum(_)), "{said:?}");
            assert_eq!(p.role == Role::NaturalFrequency, matches!(p.search, Search::Resonance(..)), "{said:?}");
            if let Role::Phase { of } = p.role {
                let amplitude = parameters(kind)[of];
                assert!(of < index && amplitude.search == Search::Amplitude, "{said:?}");
                assert_eq!(amplitude.min, -amplitude.max, "{said:?}: it is turned by half a turn");
            }
        }
    }
}

/// The size of a unit where those of drive, position and time are `u`, `x` and `s`.
fn size(unit: &str, [u, x, s]: [f64; 3]) -> f64 {
    match unit {
        "U" => u,
        "X" => x,
        "U/X" => u / x,
        "U·s/X" => u * s / x,
        "U·s²/X²" => u * s * s / (x * x),
        "1/X" => 1.0 / x,
        "X/s" => x / s,
        "s" => s,
        "1/s" | "rad/s" => 1.0 / s,
        "1" | "rad" => 1.0,
        _ => panic!("{unit} has no size here"),
    }
}

/// An effect of each kind that acts strongly on [`moved`].
fn strong(kind: Kind, units: [f64; 3]) -> Effect<f64> {
    let value = |p: &Parameter| match p.role {
        Role::TimeConstant | Role::Delay => 4e-3,
        Role::Instant => 0.1,
        Role::NaturalFrequency => 80.0,
        Role::Stiffness => 60.0,
        Role::Damping => 0.05,
        Role::Gap => 0.02,
        Role::Exponent => 1.5,
        _ => 0.3,
    };
    let values: Vec<f64> = parameters(kind).iter().map(|p| value(p) * size(p.unit, units)).collect();
    Effect::new(kind, &values)
}

/// Measured position and velocity after 0.4 s of a drive of both signs, as multiples of the units.
fn moved(effects: &[Effect<f64>], units: [f64; 3]) -> [f64; 2] {
    let unit = |name| size(name, units);
    let base = Base { b: 0.02685 * unit("U·s/X") * unit("s"), c: 0.11 * unit("U·s/X"), f1: 0.5 * unit("U") };
    let plant = Plant { base, effects };
    let drive: Vec<f64> = (0..400).map(|k| 2.0 * (0.05 * f64::from(k)).sin() * unit("U")).collect();
    let ts = 1e-3 * unit("s");
    let mut state = plant.at_rest(0.0);
    let n = plant.sub_steps(ts);
    for k in 0..drive.len() {
        plant.advance(&mut state, Drive { u: &drive[..=k], ts, t: k as f64 * ts }, n);
    }
    [plant.measured(state.x) / unit("X"), state.v / unit("X/s")]
}

/// A role's unit is the parameter's: in other units of drive, position and time the same machine moves alike. By powers of 2,
/// which round nothing: to the bit. Where x is an angle it has one unit.
#[test]
fn units_are_those_of_the_roles() {
    for &kind in Kind::ALL {
        let here = moved(&[strong(kind, [1.0; 3])], [1.0; 3]);
        assert_ne!(here, moved(&[], [1.0; 3]), "{}: it does nothing here, so nothing is tested", kind.name());
        let x = if matches!(kind, Kind::GravityLoad | Kind::EncoderEccentricity) { 1.0 } else { 0.25 };
        for units in [[4.0, 1.0, 1.0], [1.0, x, 1.0], [1.0, 1.0, 4.0], [2.0, x, 0.25]] {
            assert_eq!(moved(&[strong(kind, units)], units), here, "{} {units:?}", kind.name());
        }
    }
}

fn hooks(effect: &Effect<f64>, at: &Instant<f64>) -> [f64; 3] {
    let base = Base { b: 0.02685, c: 0.11, f1: 0.5 };
    [effect.force(at), effect.level(&base, at), effect.sensor(at.x)]
}

proptest! {
    /// Phases come into (−π, π], amplitudes become positive, and the law stays the same to 1e-11: angles up to 1e4 rad
    /// are rounded by 2e-12, and amplitudes add up to 3. A second time nothing changes, to the bit.
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
