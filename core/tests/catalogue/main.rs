//! What the catalogue says of its effects is true of their laws.

mod canonical;
mod relations;

use breakaway_core::plant::effect::{ActsIn, Element, Parameter, Role, Search};
use breakaway_core::plant::{Base, Drive, Effect, Kind, Plant};

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

/// The size of a unit, such as U·s²/X², where those of drive, position and time are `u`, `x` and `s`.
fn size(unit: &str, [u, x, s]: [f64; 3]) -> f64 {
    let factor = |name: &str| {
        let base = match name.trim_end_matches(['²', '³']) {
            "U" => u,
            "X" => x,
            "s" => s,
            "1" | "rad" => 1.0,
            _ => panic!("{unit}: {name} is no unit of the catalogue"),
        };
        match name.chars().last() {
            Some('²') => base * base,
            Some('³') => base * base * base,
            _ => base,
        }
    };
    let product = |side: &str| side.split('·').map(factor).product::<f64>();
    unit.split_once('/').map_or_else(|| product(unit), |(above, below)| product(above) / product(below))
}

/// An effect of each kind that acts strongly on [`moved`].
fn strong(kind: Kind, units: [f64; 3]) -> Effect<f64> {
    let value = |p: &Parameter| match p.role {
        Role::TimeConstant | Role::Delay => 4e-3,
        Role::Instant => 0.1,
        Role::NaturalFrequency => 80.0,
        Role::Stiffness => 60.0,
        Role::Damping => 0.05,
        // The motion goes to .097, so that it reaches a stop.
        Role::Gap | Role::Position => 0.02,
        Role::Exponent => 1.5,
        _ => 0.3,
    };
    let values: Vec<f64> = parameters(kind).iter().map(|p| value(p) * size(p.unit, units)).collect();
    Effect::new(kind, &values)
}

/// Measured position in each of 400 samples of 1 ms under a drive of both signs, as a multiple of its unit.
fn moved(effects: &[Effect<f64>], units: [f64; 3]) -> Vec<f64> {
    let unit = |name| size(name, units);
    let base = Base { b: 0.02685 * unit("U·s/X") * unit("s"), c: 0.11 * unit("U·s/X"), f1: 0.5 * unit("U") };
    let plant = Plant { base, effects };
    let drive: Vec<f64> = (0..400).map(|k| 2.0 * (0.05 * f64::from(k)).sin() * unit("U")).collect();
    let ts = 1e-3 * unit("s");
    let mut state = plant.at_rest(0.0);
    let n = plant.sub_steps(ts);
    let mut step = |k: usize| {
        plant.advance(&mut state, Drive { u: &drive[..=k], ts, t: k as f64 * ts }, n);
        plant.measured(state.x) / unit("X")
    };
    (0..drive.len()).map(&mut step).collect()
}

/// Every effect says what it is as a part of a machine. In other units of force and position the part is the one that
/// the converted parameters give, by powers of 2 to the bit. The drive's own numbers stay in drive units.
#[test]
fn every_effect_is_a_part_of_a_machine_in_any_unit() {
    let base = |force: f64| Base { b: 1.0, c: 1.0, f1: 0.5 * force };
    for &kind in Kind::ALL {
        let here = strong(kind, [1.0; 3]).element(&base(1.0));
        assert_ne!(here, Element::Other, "{}", kind.name());
        let definition = kind.definition();
        if definition.acts_in == ActsIn::Drive || definition.needs_angle {
            continue;
        }
        for [force, length] in [[4.0, 1.0], [1.0, 0.25], [2.0, 0.5]] {
            let there = strong(kind, [force, length, 1.0]).element(&base(force));
            assert_eq!(whole(here.in_units(force, length)), whole(there), "{} {force} {length}", kind.name());
        }
    }
}

/// Bristles whose level does not depend on the speed have any speed.
fn whole(element: Element) -> Element {
    match element {
        Element::Bristles { stiffness, damping, rise: 0.0, .. } => {
            Element::Bristles { stiffness, damping, rise: 0.0, speed: 1.0 }
        }
        other => other,
    }
}

/// A role's unit is the parameter's: in other units of drive, position and time the same machine moves alike. By
/// powers of 2, which round nothing: to the bit. A law that needs an angle does not, and no other says that it does.
#[test]
fn units_are_those_of_the_roles() {
    for &kind in Kind::ALL {
        let here = moved(&[strong(kind, [1.0; 3])], [1.0; 3]);
        assert_ne!(here, moved(&[], [1.0; 3]), "{}: it does nothing here, so nothing is tested", kind.name());
        let angle = kind.definition().needs_angle;
        for units in [[4.0, 1.0, 1.0], [1.0, 0.25, 1.0], [1.0, 1.0, 4.0], [2.0, 0.25, 0.25]] {
            let same = moved(&[strong(kind, units)], units) == here;
            assert_eq!(same, units[1] == 1.0 || !angle, "{} {units:?}", kind.name());
        }
    }
}
