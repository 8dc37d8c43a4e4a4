//! Models to the board and back.

use breakaway_core::link::{self, Info, WireEffect};
use breakaway_core::plant::Base;

use super::DeviceError;
use super::scale::{Scale, decimal};
use super::text;
use crate::model::{BaseSe, EffectEntry, Model};

/// The model as the board takes it: single precision, in the board's units.
///
/// # Errors
/// [`DeviceError::Model`]: other units, too many effects, or a value out of range.
pub fn to_wire(model: &Model, scale: &Scale) -> Result<link::Model, DeviceError> {
    // A model without units has those of the examples.
    for (name, model, board, unknown) in
        [("drive", &model.units.u, &scale.units.u, "u"), ("position", &model.units.x, &scale.units.x, "x")]
    {
        if model != board && model != unknown {
            return Err(DeviceError::Model(format!(
                "its {name} is in {model}, the board's in {board}: identify from recordings of the board, or set the \
                 board's units (`settings set {name}_unit=…`)"
            )));
        }
    }
    let effects = model.plant_effects().map_err(|error| DeviceError::Model(error.to_string()))?;
    let wire = link::Model {
        b: model.base.b as f32,
        c: model.base.c as f32,
        f1: model.base.f1 as f32,
        effects: effects.iter().map(WireEffect::new).collect(),
    };
    wire.validate().map_err(|error| DeviceError::Model(text::refusal(&error)))?;
    Ok(wire)
}

/// The board's model as a file holds it.
///
/// # Errors
/// [`DeviceError::Model`]: an effect this program does not know.
pub fn from_wire(wire: &link::Model, info: &Info, scale: &Scale) -> Result<Model, DeviceError> {
    let mut effects = Vec::new();
    for index in 0..wire.effects.len() {
        let Some(effect) = wire.effect::<f64>(index) else { break };
        let mut effect = effect.map_err(|error| DeviceError::Model(text::refusal(&error)))?;
        for p in &mut effect.p {
            *p = decimal(*p as f32);
        }
        effects.push(EffectEntry::of(&effect, &[]));
    }
    Ok(Model {
        base: Base { b: decimal(wire.b), c: decimal(wire.c), f1: decimal(wire.f1) },
        base_se: BaseSe::default(),
        units: scale.units.clone(),
        effects,
        provenance: vec![format!("read from {}, firmware {} ({})", info.board, info.firmware, info.build)],
    })
}
