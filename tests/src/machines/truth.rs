//! What is known of a machine: the effects that a discovery may name, and the values of parameters.

use breakaway_core::plant::Kind;

/// The right result of a discovery on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth<'a> {
    /// Something is missing from the base model.
    Effects {
        /// Names that may stand first.
        lead: &'a [Kind],
        /// Names, at least one of which must be given, in whatever place.
        needed: &'a [Kind],
        /// Further names that are also true of the machine.
        also: &'a [Kind],
    },
    /// Something is missing that no effect of the catalogue describes.
    Outside {
        /// Names that are true of the machine, beside what is missing.
        also: &'a [Kind],
    },
    /// Nothing material is missing.
    Nothing,
    /// The recordings hold no drive: nothing can be asked of them.
    NoDrive,
}

impl<'a> Truth<'a> {
    /// A truth that needs the leading name alone.
    pub const fn lead(lead: &'a [Kind], also: &'a [Kind]) -> Self {
        Self::Effects { lead, needed: lead, also }
    }

    /// Whether `kind` is true of the machine, in whatever place.
    pub fn allows(&self, kind: Kind) -> bool {
        match self {
            Self::Effects { lead, needed, also } => [lead, needed, also].iter().any(|names| names.contains(&kind)),
            Self::Outside { also } => also.contains(&kind),
            Self::Nothing | Self::NoDrive => false,
        }
    }

    /// In words, for the page.
    pub fn words(&self) -> String {
        let list = |names: &[Kind], word: &str| names.iter().map(|k| k.name()).collect::<Vec<_>>().join(word);
        match self {
            Self::Nothing => "nothing".to_owned(),
            Self::NoDrive => "no drive logged".to_owned(),
            Self::Outside { also: [] } => "outside the catalogue".to_owned(),
            Self::Outside { also } => format!("outside the catalogue; also {}", list(also, ", ")),
            Self::Effects { lead, needed, also } => {
                let mut words = list(lead, " or ");
                if needed != lead {
                    words = format!("{words}, with {}", list(needed, " or "));
                }
                if !also.is_empty() {
                    words = format!("{words}; also {}", list(also, ", "));
                }
                words
            }
        }
    }
}

/// A parameter whose value is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Its effect; `None` for b, c, f1 of the base.
    pub of: Option<Kind>,
    /// Symbol, as the catalogue of effects has it.
    pub symbol: &'static str,
    /// Least value, in the units of the recordings.
    pub from: f64,
    /// Largest value; equal to `from` where one value is known.
    pub to: f64,
    /// Whether the sign is a matter of convention (phase, direction): magnitudes are compared.
    pub magnitude: bool,
    /// Who says so.
    pub source: &'static str,
}

impl Known {
    /// One value.
    pub const fn new(of: Option<Kind>, symbol: &'static str, value: f64, source: &'static str) -> Self {
        Self { of, symbol, from: value, to: value, magnitude: false, source }
    }

    /// A range.
    pub const fn within(of: Option<Kind>, symbol: &'static str, [from, to]: [f64; 2], source: &'static str) -> Self {
        Self { of, symbol, from, to, magnitude: false, source }
    }

    /// The same, its sign left open.
    pub const fn unsigned(self) -> Self {
        Self { magnitude: true, ..self }
    }

    /// `effect.symbol`, or `symbol` of the base.
    pub fn label(&self) -> String {
        self.of.map_or_else(|| self.symbol.to_owned(), |kind| format!("{}.{}", kind.name(), self.symbol))
    }

    /// The value in words: `16`, or `8.4 to 10.6`.
    pub fn value(&self) -> String {
        let sign = if self.magnitude { "±" } else { "" };
        let [from, to] = [self.from, self.to].map(significant);
        if from == to { format!("{sign}{from}") } else { format!("{sign}{from} to {to}") }
    }
}

/// Four significant digits, as published values have.
fn significant(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words of the page, and which names are true: those of all three lists.
    #[test]
    fn a_truth_says_what_it_allows() {
        const TRUTH: Truth<'_> = Truth::Effects {
            lead: &[Kind::AsymmetricViscous, Kind::ConstantLoad],
            needed: &[Kind::AsymmetricViscous],
            also: &[Kind::Delay],
        };
        assert_eq!(TRUTH.words(), "asymmetric_viscous or constant_load, with asymmetric_viscous; also delay");
        assert!(TRUTH.allows(Kind::ConstantLoad) && TRUTH.allows(Kind::Delay) && !TRUTH.allows(Kind::Dahl));
        assert!(!Truth::Nothing.allows(Kind::Dahl));
        let outside = Truth::Outside { also: &[Kind::GravityLoad] };
        assert_eq!(outside.words(), "outside the catalogue; also gravity_load");
        assert!(outside.allows(Kind::GravityLoad) && !outside.allows(Kind::Dahl));
        assert_eq!(Known::within(None, "f1", [8.4, 10.6], "").value(), "8.4 to 10.6");
        assert_eq!(Known::new(Some(Kind::GravityLoad), "m", 5.7, "").unsigned().value(), "±5.7");
    }
}
