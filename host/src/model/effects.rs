//! The effects a model file may name: those of the core's catalogue.

use breakaway_core::plant::Kind;
use breakaway_core::plant::effect::{Definition, Parameter, Role};

/// The effects a model file may name, in the order of the catalogue: the one place that reading and writing of models ask.
pub fn known_effects() -> impl Iterator<Item = &'static Definition> {
    Kind::ALL.iter().map(|kind| kind.definition())
}

/// The catalogue's definition of `name`.
pub(super) fn known_effect(name: &str) -> Option<&'static Definition> {
    Kind::from_name(name).map(Kind::definition)
}

/// A parameter's range in words, in the canonical form of its effect; limits that only keep the arithmetic finite are left
/// out.
pub fn range(parameter: &Parameter) -> String {
    /// From here a limit is a guard, not physics.
    const GUARD: f64 = 1e7;
    const TINY: f64 = 1e-6;
    if matches!(parameter.role, Role::Phase { .. }) {
        return "above −π, to π".to_owned();
    }
    let Parameter { min, max, .. } = *parameter;
    match (min > -GUARD, max < GUARD) {
        (false, false) => "any".to_owned(),
        (true, false) if min > 0.0 && min <= TINY => "above 0".to_owned(),
        (true, false) => format!("{min} or more"),
        (true, true) if min > 0.0 && min <= TINY => format!("above 0, to {max}"),
        (false, true) => format!("{max} or less"),
        (true, true) => format!("{min} to {max}"),
    }
}
