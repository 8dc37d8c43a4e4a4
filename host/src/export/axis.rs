//! A model in SI units at the load, as the targets translate it.

use breakaway_core::plant::effect::Element;
use serde::Serialize;

use super::fate::{Fate, Row, kept};
use super::units::Scale;
use crate::model::{EffectEntry, Model};

/// Inertia and friction of one side of the gear, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Values {
    /// kg·m², or kg of a linear load.
    pub inertia: f64,
    /// N·m·s/rad, or N·s/m.
    pub viscous: f64,
    /// N·m, or N.
    pub coulomb: f64,
}

/// Both sides of the gear.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Sides {
    /// Behind the gear: what a simulator's joint takes.
    pub load: Values,
    /// Before it; of a linear axis the motor's rotation.
    pub motor: Values,
    /// Force at the load per drive unit, N·m or N.
    pub force_per_drive: f64,
    /// Motor's turns per load's turn, or rad per m.
    pub gear: f64,
    /// Whether the load moves along a line.
    pub linear: bool,
}

/// An effect of the model.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Catalogue name.
    pub name: &'static str,
    /// Its law.
    pub law: &'static str,
    /// Its numbers, in the model's units, for a comment.
    pub said: String,
    /// In SI at the load; numbers of the drive itself in drive units.
    pub element: Element,
    /// Place along the drive's path, of those that act there.
    pub along_the_drive: u8,
}

/// The model in SI at the load.
pub(super) struct Axis {
    pub name: String,
    pub base: Values,
    pub parts: Vec<Part>,
    pub scale: Scale,
    pub timestep_s: f64,
    /// The base's numbers in the model's units, for comments: b, c, f1.
    pub said: [String; 3],
    /// Unit of the drive.
    pub drive_unit: String,
}

/// What a target makes of a part: a fate, and as what.
pub(super) type Decided = (Fate, String);

/// Units of inertia, viscous and Coulomb friction about an axis.
const ROTATION: [&str; 3] = ["kg·m²", "N·m·s/rad", "N·m"];

impl Axis {
    pub fn new(model: &Model, scale: Scale, name: String, timestep_s: f64) -> Self {
        let Scale { force, length, .. } = scale;
        let base = model.base;
        let units = &model.units;
        let parts = model.effects.iter().filter_map(|entry| part(entry, model, scale)).collect();
        Self {
            name,
            base: Values {
                inertia: base.b * force / length,
                viscous: base.c * force / length,
                coulomb: base.f1 * force,
            },
            parts,
            scale,
            timestep_s,
            said: [
                format!("b = {} {}", super::number(base.b), units.of_b()),
                format!("c = {} {}", super::number(base.c), units.of_c()),
                format!("f1 = {} {}", super::number(base.f1), units.of_f1()),
            ],
            drive_unit: units.u.clone(),
        }
    }

    pub fn sides(&self) -> Sides {
        let Scale { gear, force, linear, .. } = self.scale;
        let Values { inertia, viscous, coulomb } = self.base;
        let motor =
            Values { inertia: inertia / (gear * gear), viscous: viscous / (gear * gear), coulomb: coulomb / gear };
        Sides { load: self.base, motor, force_per_drive: force, gear, linear }
    }

    /// Unit of force at the load.
    pub const fn force_unit(&self) -> &'static str {
        if self.scale.linear { "N" } else { "N·m" }
    }

    /// The share of the inertia that moves as a second body, 0 to 1.
    pub fn second_share(&self) -> f64 {
        let share = |part: &Part| match part.element {
            Element::SprungLoad { share, .. } | Element::LooseLoad { share, .. } => Some(share),
            _ => None,
        };
        self.parts.iter().find_map(share).unwrap_or(0.0)
    }

    /// Kind and direction of the joint, as URDF and SDF write them.
    pub const fn joint(&self) -> (&'static str, &'static str) {
        if self.scale.linear { ("prismatic", "1 0 0") } else { ("revolute", "0 0 1") }
    }

    /// The force of the largest drive, at the load.
    pub fn largest_force(&self) -> Option<f64> {
        self.parts.iter().find_map(|part| match part.element {
            Element::DriveLimit { largest } => Some(largest * self.scale.force),
            _ => None,
        })
    }

    /// Lines on both sides of the gear.
    pub fn summary(&self) -> Vec<String> {
        let sides = self.sides();
        let side = |name: &str, v: &Values, units: [&str; 3]| {
            let [inertia, viscous, coulomb] = [v.inertia, v.viscous, v.coulomb].map(super::number);
            format!(
                "{name}: inertia {inertia} {}, viscous {viscous} {}, Coulomb {coulomb} {}",
                units[0], units[1], units[2]
            )
        };
        let at_load = if self.scale.linear { ["kg", "N·s/m", "N"] } else { ROTATION };
        let mut lines = vec![side("At the load", &sides.load, at_load)];
        if sides.gear != 1.0 {
            lines.push(side("At the motor", &sides.motor, ROTATION));
        }
        let force = super::number(sides.force_per_drive);
        lines.push(format!("1 {} of drive is {force} {} at the load.", self.drive_unit, self.force_unit()));
        lines
    }
}

/// The rows of the base.
pub(super) fn base_rows(decided: [Decided; 3]) -> Vec<Row> {
    let named = [("b", "b·ẍ"), ("c", "c·ẋ"), ("f1", "f1·sgn ẋ")];
    let row = |((what, law), (fate, how)): ((&str, &str), Decided)| Row {
        what: what.to_owned(),
        law: law.to_owned(),
        fate,
        how,
    };
    named.into_iter().zip(decided).map(row).collect()
}

/// The rows of the base where all is kept, each as what.
pub(super) fn base_kept(names: [&str; 3]) -> Vec<Row> {
    base_rows(names.map(kept))
}

impl Part {
    /// Its row.
    pub fn row(&self, (fate, how): Decided) -> Row {
        Row { what: self.name.to_owned(), law: self.law.to_owned(), fate, how }
    }
}

fn part(entry: &EffectEntry, model: &Model, scale: Scale) -> Option<Part> {
    let effect = entry.effect()?;
    let definition = effect.kind.definition();
    let numbers = definition.parameters.iter().zip(effect.p);
    // A refinement at its default says nothing.
    let said = numbers.filter(|(p, value)| p.default != Some(*value)).map(|(p, value)| {
        let unit = crate::model::catalogue::unit(p.unit, &model.units);
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        format!("{} = {}{unit}", p.symbol, super::number(value))
    });
    Some(Part {
        name: definition.name,
        law: definition.law,
        said: said.collect::<Vec<_>>().join(", "),
        element: effect.element(&model.base).in_units(scale.force, scale.length),
        along_the_drive: effect.kind.along_the_drive(),
    })
}
