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
#[allow(clippy::struct_excessive_bools, reason = "four facts that do not depend on one another")]
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
    /// Catalogue names of the effects that this one becomes with certain parameters, or in a limit. Where such an
    /// effect does as well, it is the one to name.
    pub generalises: &'static [&'static str],
    /// Effects that cannot stand beside it in one model; each of them says the same of this one.
    pub excludes: &'static [Relation],
    /// Effects that look like the residual of this one, whose law idealises something. To name one of them beside it
    /// takes other evidence than the simulation's.
    pub residue: &'static [Relation],
    /// Whether several of it may stand in one model, with other parameters.
    pub repeats: bool,
    /// Whether the law holds only where the position is an angle in radians.
    pub needs_angle: bool,
    /// Whether its phase belongs to the encoder's zero, which an incremental encoder finds anew for every recording.
    pub phase_per_recording: bool,
    /// Whether it depends on the time of the session: recordings tell it only if they share a clock.
    pub shared_clock: bool,
}

/// Another effect, and why it is related.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Relation {
    /// Its catalogue name.
    pub name: &'static str,
    /// The reason, for a reader.
    pub why: &'static str,
}

impl Definition {
    /// No relations to other effects and no special needs: what a definition has unless it says otherwise.
    pub(super) const PLAIN: Self = Self {
        name: "",
        title: "",
        law: "",
        acts_in: ActsIn::Force,
        parameters: &[],
        shown_by: "",
        confused_with: &[],
        compensation: None,
        generalises: &[],
        excludes: &[],
        residue: &[],
        repeats: false,
        needs_angle: false,
        phase_per_recording: false,
        shared_clock: false,
    };

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
