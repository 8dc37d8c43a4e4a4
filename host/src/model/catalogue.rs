//! Effects of a model file, and the same as the simulator takes them.

use breakaway_core::plant::{Effect, Kind, MAX_EFFECTS};

use super::{EffectEntry, Model};
use crate::recording::Units;

/// More effects than the plant carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the model has {0} effects; at most {MAX_EFFECTS} can be simulated at once")]
pub struct TooManyEffects(usize);

impl Model {
    /// The effects as the plant takes them.
    ///
    /// # Errors
    /// [`TooManyEffects`].
    pub fn plant_effects(&self) -> Result<Vec<Effect<f64>>, TooManyEffects> {
        if self.effects.len() > MAX_EFFECTS {
            return Err(TooManyEffects(self.effects.len()));
        }
        Ok(self.effects.iter().filter_map(EffectEntry::effect).collect())
    }
}

impl EffectEntry {
    /// The entry of an effect with the standard errors of its parameters, in their order.
    pub fn of(effect: &Effect<f64>, errors: &[Option<f64>]) -> Self {
        let definition = effect.kind.definition();
        let mut entry = Self {
            name: definition.name.to_owned(),
            parameters: std::collections::BTreeMap::new(),
            se: std::collections::BTreeMap::new(),
        };
        for (i, parameter) in definition.parameters.iter().enumerate() {
            entry.parameters.insert(parameter.symbol.to_owned(), effect.p[i]);
            if let Some(Some(se)) = errors.get(i)
                && se.is_finite()
            {
                entry.se.insert(parameter.symbol.to_owned(), *se);
            }
        }
        entry
    }

    /// The effect of that name with the entry's parameters; `None` for a name outside the catalogue, which reading
    /// a model file has refused.
    pub fn effect(&self) -> Option<Effect<f64>> {
        let kind = Kind::from_name(&self.name)?;
        let mut effect = Effect::new(kind, &[]);
        for (i, parameter) in kind.definition().parameters.iter().enumerate() {
            if let Some(value) = self.parameters.get(parameter.symbol) {
                effect.p[i] = *value;
            }
        }
        Some(effect)
    }
}

/// A parameter's unit with the drive's and position's own units in place of `U` and `X`.
pub fn unit(template: &str, units: &Units) -> String {
    template
        .chars()
        .map(|c| match c {
            'U' => units.u.clone(),
            'X' => units.x.clone(),
            other => other.to_string(),
        })
        .collect()
}
