//! What the catalogue says of an effect.

/// Most parameters any effect has.
pub const MAX_PARAMETERS: usize = 5;

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

/// How a starting value of a parameter is found before it is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// The force is proportional to it: solved for by least squares.
    Amplitude,
    /// The phase of the amplitude before it: solved for together with it.
    Phase,
    /// Wave number or angular frequency: from the spectrum of the residual force.
    Spectrum(Over),
    /// Tried at these multiples of a quantity of the recordings.
    Grid(Scale, &'static [f64]),
    /// Angular frequency of a body on a spring, rad/s: tried from the first to the second, as far apart as a segment tells
    /// two of them.
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
    /// Symbol, as in the law and in model files.
    pub symbol: &'static str,
    /// Unit, with `U` for the drive's and `X` for the position's.
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Smallest valid value.
    pub min: f64,
    /// Largest valid value.
    pub max: f64,
    /// Value held unless the parameter is refined on purpose; `None` for a parameter that is always fitted.
    pub default: Option<f64>,
    /// How a starting value is found.
    pub search: Search,
}

impl Parameter {
    /// A parameter that is always fitted; started as an amplitude.
    pub const fn new(symbol: &'static str, unit: &'static str, meaning: &'static str, min: f64, max: f64) -> Self {
        Self { symbol, unit, meaning, min, max, default: None, search: Search::Amplitude }
    }
    /// The same, started from the phase of the amplitude before it, a spectrum or a grid.
    pub const fn search(self, search: Search) -> Self {
        Self { search, ..self }
    }
    /// A refinement: held at `default` until asked for.
    pub const fn refinement(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }
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
    /// Whether a wave number or frequency of it comes from the spectrum of the residual force.
    pub fn periodic(&self) -> bool {
        self.parameters.iter().any(|parameter| matches!(parameter.search, Search::Spectrum(_)))
    }
}
