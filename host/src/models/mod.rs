//! The motor library: cards of identified machines. The folder `models/` of the project holds them; they are in the
//! program, so that it needs no files.

pub mod card;
pub mod check;
pub mod compare;
pub mod held_out;
pub mod page;

use std::path::Path;

pub use card::Card;

use crate::file::FileError;
use crate::nearest::{did_you_mean, nearest};

/// Name and text of every card, by name.
const CARDS: [(&str, &str); 9] = [
    ("ak80", include_str!("../../../models/ak80.toml")),
    ("emps", include_str!("../../../models/emps.toml")),
    ("flexlink", include_str!("../../../models/flexlink.toml")),
    ("frc-left", include_str!("../../../models/frc-left.toml")),
    ("frc-right", include_str!("../../../models/frc-right.toml")),
    ("hsm150", include_str!("../../../models/hsm150.toml")),
    ("laas", include_str!("../../../models/laas.toml")),
    ("odrive", include_str!("../../../models/odrive.toml")),
    ("xl330", include_str!("../../../models/xl330.toml")),
];

/// Why a card cannot be used.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum CardError {
    /// The file cannot be read, or is of another kind.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is no card.
    #[error("{file} is not a motor card: {reason}")]
    Malformed {
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// Neither a card of the library nor a file.
    #[error(
        "no motor card `{name}`{}; the library has {}; a path to a card ends in .toml",
        did_you_mean(nearest.as_deref()), names.join(", ")
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// The most similar name.
        nearest: Option<String>,
        /// All names.
        names: Vec<&'static str>,
    },
    /// It fails its check.
    #[error("the card {name} fails its check: {}", faults.join("; "))]
    Faults {
        /// The card.
        name: String,
        /// What is wrong, one sentence each.
        faults: Vec<String>,
    },
}

/// Names of the library's cards.
pub fn names() -> Vec<&'static str> {
    CARDS.iter().map(|(name, _)| *name).collect()
}

/// All cards of the library, by name.
///
/// # Errors
/// A card that cannot be read, which the tests rule out.
pub fn all() -> Result<Vec<Card>, CardError> {
    CARDS.iter().map(|(name, text)| Card::parse(&format!("models/{name}.toml"), text)).collect()
}

/// A card of the library by its name, or one in a file by its path.
///
/// # Errors
/// [`CardError`].
pub fn card(name: &str) -> Result<Card, CardError> {
    if let Some((name, text)) = CARDS.iter().find(|(known, _)| *known == name) {
        return Card::parse(&format!("models/{name}.toml"), text);
    }
    if Path::new(name).extension().is_some_and(|kind| kind == "toml") {
        return Card::read(Path::new(name));
    }
    let names = names();
    let nearest = nearest(name, names.iter().copied()).map(str::to_owned);
    Err(CardError::Unknown { name: name.to_owned(), nearest, names })
}
