//! What the catalogue says of an effect beside others, over recordings and over a session.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;

use breakaway_core::plant::effect::{Held, Instant, Relation, Role};
use breakaway_core::plant::{Base, Effect, Kind};

use super::{has_a_phase, moved, parameters, strong};

const PLAIN: [f64; 3] = [1.0; 3];

fn named(relations: &[Relation]) -> impl Iterator<Item = Kind> {
    relations.iter().map(|relation| {
        assert!(!relation.why.is_empty(), "{relation:?}");
        Kind::from_name(relation.name).unwrap_or_else(|| panic!("{relation:?}: no such effect"))
    })
}

/// No definition leaves a text at the empty one that it starts from, or names what is not in the catalogue, or itself.
#[test]
fn definitions_are_complete() {
    for &kind in Kind::ALL {
        let d = kind.definition();
        for text in [d.name, d.title, d.law, d.shown_by] {
            assert!(!text.is_empty(), "{kind:?}");
        }
        assert!(!d.parameters.is_empty(), "{kind:?}");
        let names = d.confused_with.iter().chain(d.generalises).map(|name| Kind::from_name(name));
        for other in names.chain(named(d.excludes).chain(named(d.residue)).map(Some)) {
            assert!(other.is_some_and(|other| other != kind), "{kind:?} {other:?}");
        }
    }
}

/// What excludes another is excluded by it, for the same reason. Of laws with bristles and of second bodies a plant
/// has one; an effect excludes itself unless it repeats.
#[test]
fn exclusion_is_mutual() {
    for &a in Kind::ALL {
        assert_eq!(a.excludes(a).is_none(), a.definition().repeats, "{a:?}");
        let tells_apart = |role| matches!(role, Role::WaveNumber | Role::AngularFrequency | Role::Position);
        let has_a_place = parameters(a).iter().any(|p| tells_apart(p.role));
        assert!(has_a_place || !a.definition().repeats, "{a:?} has nothing to tell one from the other");
        for &b in Kind::ALL.iter().filter(|b| **b != a) {
            assert_eq!(a.excludes(b), b.excludes(a), "{a:?} {b:?}");
            if (a.bristles() && b.bristles()) || (a.second_body() && b.second_body()) {
                assert!(a.excludes(b).is_some(), "{a:?} {b:?}");
            }
        }
    }
}

/// Beside bristles a level at rest changes nothing, to the bit: the reason for which they exclude it.
#[test]
fn bristles_leave_no_room_for_stiction() {
    let stiction = strong(Kind::Stiction, PLAIN);
    assert_ne!(moved(&[stiction], PLAIN), moved(&[], PLAIN));
    for kind in [Kind::Dahl, Kind::LuGre] {
        let alone = moved(&[strong(kind, PLAIN)], PLAIN);
        assert_eq!(moved(&[strong(kind, PLAIN), stiction], PLAIN), alone);
        assert!(kind.excludes(Kind::Stiction).is_some());
    }
}

/// The general effect with the parameters that make it the special one.
fn as_special(general: Kind, special: Kind) -> Option<Effect<f64>> {
    let [a, b, ..] = strong(special, PLAIN).p;
    let parameters: &[f64] = match (general, special) {
        (Kind::Cogging, Kind::GravityLoad) => &[a, 1.0, b],
        (Kind::Cogging | Kind::TimePeriodic, Kind::ConstantLoad) => &[a, 1e-9, -FRAC_PI_2],
        // A wave of 63 000 position units is straight where the axis moves.
        (Kind::Cogging, Kind::Spring) => &[-a / 1e-4, 1e-4, -1e-4 * b],
        (Kind::Spring, Kind::ConstantLoad) => &[1e-7, -a / 1e-7],
        (Kind::LuGre, Kind::Dahl) => &[a, 0.0, 0.0, 1.0],
        // Bristles of 5e-6, f1 over their stiffness.
        (Kind::LuGre, Kind::Stribeck) => &[1e5, 0.0, a, b],
        _ => return None,
    };
    Some(Effect::new(general, parameters))
}

/// What generalises another is it with some parameters: the motion differs by less than a thousandth of what the effect
/// does to it. Stiff bristles are a limit: 0.027 of it here, and less the stiffer. Nothing generalises in a circle.
#[test]
fn a_general_effect_becomes_the_special_one() {
    for &general in Kind::ALL {
        for &special in Kind::ALL {
            let same = as_special(general, special);
            assert_eq!(same.is_some(), general.generalises(special), "{general:?} {special:?}");
            let Some(same) = same else { continue };
            let mut effect = strong(special, PLAIN);
            if special == Kind::Stribeck {
                // LuGre friction has the usual exponent.
                effect.p[2] = 2.0;
            }
            let (without, with, general_form) = (moved(&[], PLAIN), moved(&[effect], PLAIN), moved(&[same], PLAIN));
            let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            let within = if special == Kind::Stribeck { 0.05 } else { 1e-3 };
            let (off, whole) = (distance(&general_form, &with), distance(&without, &with));
            assert!(off < within * whole, "{general:?} {special:?}: {off} of {whole}");
        }
        assert!(!below(general).contains(general.name()), "{general:?}");
    }
}

/// An effect in the place of another moves the axis alike, to rounding. The two may be confused. A dead time may be a dead
/// zone.
#[test]
fn an_effect_in_the_place_of_another_is_that() {
    let mut all = Vec::new();
    for &special in Kind::ALL {
        let effect = strong(special, PLAIN);
        for (general, same) in Kind::ALL.iter().filter_map(|general| Some((*general, effect.as_kind(*general)?))) {
            let worst = moved(&[effect], PLAIN)
                .iter()
                .zip(moved(&[same], PLAIN))
                .fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
            assert!(worst < 1e-9, "{general:?} {special:?}: {worst}");
            let confused = |a: Kind, b: Kind| a.definition().confused_with.contains(&b.name());
            assert!(same.kind == general && (confused(general, special) || confused(special, general)), "{general:?}");
            all.push((general, special));
        }
    }
    assert_eq!(all, [(Kind::PwmDeadTime, Kind::DeadZone)]);
    // A dead zone of no width loses nothing.
    let none = Effect::new(Kind::DeadZone, &[0.0]).as_kind(Kind::PwmDeadTime).unwrap();
    assert_eq!(moved(&[none], PLAIN), moved(&[], PLAIN));
}

/// Everything that an effect generalises, in any number of steps.
fn below(kind: Kind) -> BTreeSet<&'static str> {
    let mut all = BTreeSet::new();
    let mut open = vec![kind];
    while let Some(kind) = open.pop() {
        let new = kind.definition().generalises.iter().filter(|name| all.insert(**name));
        open.extend(new.filter_map(|name| Kind::from_name(name)));
    }
    all
}

/// The law of an effect without a memory at position `x` and session time `t`.
fn law(effect: &Effect<f64>, x: f64, t: f64) -> [f64; 5] {
    let base = Base { b: 0.02685, c: 0.11, f1: 0.5 };
    let at = Instant { t, x, v: 1.3, u: 0.9, over_s: 0.0 };
    let mut memory = [0.1, 0.2, 0.0];
    let past = Held { u: &[0.9], ts: 1e-3, from_s: 0.0 };
    let drive = effect.drive(&at, past, &mut memory, 1e-3);
    [drive, effect.force(&at), effect.level(&base, &at), effect.inertia(t, &memory), effect.sensor(x)]
}

/// Effects of the session's time need recordings with a common clock, and no others do.
#[test]
fn a_shared_clock_is_asked_for_by_what_depends_on_time() {
    for &kind in Kind::ALL {
        let effect = strong(kind, PLAIN);
        let depends = law(&effect, 0.4, 1e-3) != law(&effect, 0.4, 3.0);
        assert_eq!(depends, kind.definition().shared_clock, "{kind:?}");
        assert_eq!(depends, parameters(kind).iter().any(|p| of_the_session(kind, p.role)), "{kind:?}");
    }
}

/// Roles that say by themselves that a law depends on the time of the session.
fn of_the_session(kind: Kind, role: Role) -> bool {
    matches!(role, Role::Rate | Role::Instant | Role::AngularFrequency)
        || (role == Role::TimeConstant && kind == Kind::FrictionDrift)
}

/// A phase along the position belongs to the encoder's zero; one in time belongs to the clock.
#[test]
fn a_phase_along_the_position_is_the_recordings_own() {
    for &kind in Kind::ALL {
        let effect = strong(kind, PLAIN);
        let periodic = has_a_phase(kind) && law(&effect, 0.4, 0.1) != law(&effect, 1.0, 0.1);
        assert_eq!(periodic, kind.definition().phase_per_recording, "{kind:?}");
    }
}
