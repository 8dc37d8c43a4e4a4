//! The model on the wire.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::{CommandError, Field};
use crate::plant::effect::MAX_PARAMETERS;
use crate::plant::{Base, Effect, Kind, MAX_EFFECTS};
use crate::scalar::Real;

/// Number of an effect on the wire: a hash of its catalogue name, so that it stays when effects are added or moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EffectId(pub u32);

impl EffectId {
    /// The number of `kind`.
    #[must_use]
    pub fn of(kind: Kind) -> Self {
        Self(kind.name_hash())
    }

    /// The effect, if this build's catalogue has it.
    #[must_use]
    pub fn kind(self) -> Option<Kind> {
        Kind::from_name_hash(self.0)
    }
}

/// One effect: its number and its parameters, in the order of its definition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WireEffect {
    /// Which.
    pub id: EffectId,
    /// In the units of the model.
    pub parameters: Vec<f32, MAX_PARAMETERS>,
}

/// The base equation and named effects, in the drive and position units of [`Info`](super::Info).
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Model {
    /// Drive per acceleration, > 0.
    pub b: f32,
    /// Drive per velocity, ≥ 0.
    pub c: f32,
    /// Drive, ≥ 0.
    pub f1: f32,
    /// Effects on top.
    pub effects: Vec<WireEffect, MAX_EFFECTS>,
}

impl Clone for Model {
    // Out of line: it is half a KiB on a microcontroller.
    #[inline(never)]
    fn clone(&self) -> Self {
        let parameters = |effect: &WireEffect| Vec::from_slice(&effect.parameters).unwrap_or_default();
        let effects = self.effects.iter().map(|effect| WireEffect { id: effect.id, parameters: parameters(effect) });
        Self { b: self.b, c: self.c, f1: self.f1, effects: effects.collect() }
    }
}

impl Model {
    /// Checks the ranges of the base and of every effect.
    ///
    /// # Errors
    /// [`CommandError::Range`] names the field.
    pub fn validate(&self) -> Result<(), CommandError> {
        self.base::<f32>()?;
        for index in 0..self.effects.len() {
            self.effect::<f32>(index).transpose()?;
        }
        Ok(())
    }

    /// The base equation.
    ///
    /// # Errors
    /// [`CommandError::Range`] names the parameter.
    pub fn base<R: Real>(&self) -> Result<Base<R>, CommandError> {
        let base = Base::new(self.b, self.c, self.f1).map_err(|error| {
            CommandError::Range(match error {
                crate::plant::PlantError::B => Field::B,
                crate::plant::PlantError::C => Field::C,
                crate::plant::PlantError::F1 => Field::F1,
            })
        })?;
        let real = |value: f32| R::from_f64(f64::from(value));
        Ok(Base { b: real(base.b), c: real(base.c), f1: real(base.f1) })
    }

    /// Effect number `index`; `None` past the last.
    pub fn effect<R: Real>(&self, index: usize) -> Option<Result<Effect<R>, CommandError>> {
        Some(self.effects.get(index)?.effect())
    }
}

impl WireEffect {
    /// The effect on the wire.
    #[must_use]
    pub fn new<R: Real>(effect: &Effect<R>) -> Self {
        let count = effect.kind.ranges().len();
        let parameters = effect.p.iter().take(count).map(|p| p.to_f64() as f32).collect();
        Self { id: EffectId::of(effect.kind), parameters }
    }

    fn effect<R: Real>(&self) -> Result<Effect<R>, CommandError> {
        let kind = self.id.kind().ok_or(CommandError::Range(Field::EffectKind))?;
        let ranges = kind.ranges();
        let wrong = CommandError::Range(Field::EffectParameters);
        if self.parameters.len() != ranges.len() {
            return Err(wrong);
        }
        let mut p = [R::ZERO; MAX_PARAMETERS];
        for ((slot, [min, max]), value) in p.iter_mut().zip(ranges).zip(&self.parameters) {
            if !(value.is_finite() && value >= min && value <= max) {
                return Err(wrong);
            }
            *slot = R::from_f64(f64::from(*value));
        }
        Ok(Effect { kind, p })
    }
}
