//! Why a model cannot be exported.

use super::Target;

/// Why a model cannot be exported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ExportError {
    /// The unit of the drive says nothing of what it is.
    #[error(
        "{target} needs N·m or N, and the drive's unit `{unit}` does not say what the drive is; give --drive voltage, \
         current, duty or effort with the motor's constants, or --drive-gain, the force per drive unit"
    )]
    Drive {
        /// The target.
        target: Target,
        /// The drive's unit.
        unit: String,
    },
    /// The unit of the position is neither an angle nor a length.
    #[error(
        "{target} needs rad or m, and the position's unit is `{unit}`; give --counts-per-turn if the position is in counts, \
         or write `x` under [units] of the model (rad, deg, turns, m, mm, um)"
    )]
    Position {
        /// The target.
        target: Target,
        /// The position's unit.
        unit: String,
    },
    /// Constants of the motor are not given.
    #[error(
        "{target} needs N·m or N: a drive of `{unit}` needs {missing}; or give --drive-gain, the force per drive unit, or \
         --motor CARD, a card of the motor library that holds them"
    )]
    Constants {
        /// The target.
        target: Target,
        /// The drive's unit.
        unit: String,
        /// The options that are missing.
        missing: String,
    },
    /// A constant that is of no use.
    #[error("{option} is given, and a drive of `{unit}` has no use for it: {reason}")]
    Useless {
        /// The option.
        option: &'static str,
        /// The drive's unit.
        unit: String,
        /// Why.
        reason: &'static str,
    },
}
