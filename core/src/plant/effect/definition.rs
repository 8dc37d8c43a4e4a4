//! What the catalogue says of an effect.

use super::{Parameter, Role, Search};

/// Where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActsIn {
    /// Between the commanded and the effective drive.
    Drive,
    /// In the balance of forces.
    Force,
    /// Through extra mechanical state.
    Mechanics,
    /// Between the true and the measured position.
    Sensor,
}

/// What the catalogue says of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Definition {
    /// Catalogue name, as in model files and JSON.
    pub name: &'static str,
    /// Name for a reader.
    pub title: &'static str,
    /// The law, as added to `b·ẍ = u_a − c·v − f1·sgn v + Σ effects`.
    pub law: &'static str,
    /// Where it acts.
    pub acts_in: ActsIn,
    /// Its parameters, in order.
    pub parameters: &'static [Parameter],
    /// What shows it.
    pub shown_by: &'static str,
    /// Catalogue names it is confused with.
    pub confused_with: &'static [&'static str],
    /// What a controller can do about it; `None` if it cannot compensate it.
    pub compensation: Option<&'static str>,
}

impl Definition {
    /// Index of the parameter that is the width of a gap.
    pub(super) const fn gap(&self) -> Option<usize> {
        let mut index = 0;
        while index < self.parameters.len() {
            if let Role::Gap = self.parameters[index].role {
                return Some(index);
            }
            index += 1;
        }
        None
    }

    /// Whether a wave number or frequency of it comes from the spectrum of the residual force.
    pub fn periodic(&self) -> bool {
        self.parameters.iter().any(|parameter| matches!(parameter.search, Search::Spectrum(_)))
    }
}
