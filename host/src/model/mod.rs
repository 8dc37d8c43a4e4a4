//! Model files: the base plant with standard errors, units, and named effects, as TOML a person can read and edit.

mod angle;
pub mod catalogue;
mod effects;
mod error;
mod read;
mod write;

use std::collections::BTreeMap;

use breakaway_core::plant::Base;

use crate::recording::Units;

pub use effects::{known_effects, range};
pub use error::ModelError;

/// A model of an axis: the base equation and named effects on top of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// `b·ẍ + c·ẋ + f1·sgn(ẋ) = u`.
    pub base: Base<f64>,
    /// Standard errors of the base, where they are known.
    pub base_se: BaseSe,
    /// Units of drive and position; all parameters follow from them.
    pub units: Units,
    /// Effects, in the order in which they were added.
    pub effects: Vec<EffectEntry>,
    /// Where the model comes from, one remark per line: the comments at the top of the file.
    pub provenance: Vec<String>,
}

/// Standard errors of [`Base`], in the units of its parameters; `None` where the data did not tell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BaseSe {
    /// Of b.
    pub b: Option<f64>,
    /// Of c.
    pub c: Option<f64>,
    /// Of f1.
    pub f1: Option<f64>,
}

/// One effect of a model file: its catalogue name, and its parameters by symbol.
#[derive(Clone, Debug, PartialEq)]
pub struct EffectEntry {
    /// Name in the catalogue ([`known_effects`]).
    pub name: String,
    /// Value of each parameter.
    pub parameters: BTreeMap<String, f64>,
    /// Standard errors of the parameters, where they are known.
    pub se: BTreeMap<String, f64>,
}

impl Units {
    /// Unit of b, e.g. `V·s²/rad`.
    pub fn of_b(&self) -> String {
        format!("{}·s²/{}", self.u, self.x)
    }

    /// Unit of c, e.g. `V·s/rad`.
    pub fn of_c(&self) -> String {
        format!("{}·s/{}", self.u, self.x)
    }

    /// Unit of f1 and of every force, e.g. `V`.
    pub fn of_f1(&self) -> String {
        self.u.clone()
    }
}
