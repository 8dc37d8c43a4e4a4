//! What the catalogue says of a parameter: its role, its range, and how a starting value is found.

use core::f64::consts::PI;

use super::Role;

/// Most parameters any effect has.
pub const MAX_PARAMETERS: usize = 5;

/// How a starting value of a parameter is found before it is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// The force is proportional to it, so least squares gives it.
    Amplitude,
    /// The phase of an amplitude, as its role says: least squares gives both together.
    Phase,
    /// The spectrum of the residual force gives it: a wave number or an angular frequency.
    Spectrum(Over),
    /// It is tried at these multiples of a quantity of the recordings.
    Grid(Scale, &'static [f64]),
    /// It is the angular frequency of a body on a spring, rad/s. It is tried from the first to the second value, in
    /// the steps that a segment resolves.
    Resonance(f64, f64),
}

/// The coordinate of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Force against position.
    Position,
    /// Force times direction of motion against position.
    PositionAndDirection,
    /// Force against session time.
    Time,
}

/// A quantity of the recordings that sizes a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// One.
    Unit,
    /// Root mean square velocity.
    Speed,
    /// Largest |drive|.
    Drive,
    /// Coulomb friction f1.
    Coulomb,
    /// Viscous coefficient c.
    Viscous,
    /// Length of the session, s.
    Session,
    /// Coulomb friction over the stroke: the stiffness of a presliding as long as the stroke.
    Presliding,
    /// Largest |position|.
    Extent,
    /// Typical travel within a segment of 0.4 s.
    Stroke,
    /// Critical bristle damping at a presliding of a thirtieth of the stroke.
    BristleDamping,
}

/// One parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// What it is in the law.
    pub role: Role,
    /// Symbol, as in the law and in model files.
    pub symbol: &'static str,
    /// Unit of its role, with `U` for the drive's and `X` for the position's.
    pub unit: &'static str,
    /// What it is, for a reader.
    pub meaning: &'static str,
    /// Smallest valid value.
    pub min: f64,
    /// Largest valid value.
    pub max: f64,
    /// Value at which it is held unless a fit refines the law's form; `None` for a parameter that is always fitted.
    pub default: Option<f64>,
    /// How a starting value is found.
    pub search: Search,
}

impl Parameter {
    /// A parameter that is always fitted, and starts as an amplitude.
    pub const fn new(role: Role, symbol: &'static str, meaning: &'static str, min: f64, max: f64) -> Self {
        Self { role, symbol, unit: role.unit(), meaning, min, max, default: None, search: Search::Amplitude }
    }
    /// The phase of the amplitude that stands at `of` among the effect's parameters. Any number of turns is valid,
    /// since a fit may pass from one turn to the next.
    pub const fn phase(symbol: &'static str, of: usize, meaning: &'static str) -> Self {
        Self::new(Role::Phase { of }, symbol, meaning, -1e9, 1e9).search(Search::Phase)
    }
    /// The same, with another start of its search.
    pub const fn search(self, search: Search) -> Self {
        Self { search, ..self }
    }
    /// A refinement of the law's form: the parameter is held at `default` until it is asked for.
    pub const fn refinement(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }
    /// Smallest and largest value in the [canonical](super::Effect::canonical) form, for a reader. A canonical phase is
    /// above −π; files may hold others.
    pub const fn canonical_range(&self) -> (f64, f64) {
        match self.role {
            Role::Phase { .. } => (-PI, PI),
            _ => (self.min, self.max),
        }
    }
}
