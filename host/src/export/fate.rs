//! What becomes of a part of a model in a target.

use serde::Serialize;

/// What becomes of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// The target has the same law.
    Kept,
    /// The target has a law that is near.
    Approximated,
    /// The target has nothing of the kind.
    Lost,
}

/// What became of one part of the model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
pub struct Row {
    /// `b`, `c`, `f1`, or the effect's catalogue name.
    pub what: String,
    /// Its law.
    pub law: String,
    /// What became of it.
    pub fate: Fate,
    /// As what it stands in the file, and what differs; or why it is lost.
    pub how: String,
}

/// What a target's file gives.
pub(super) struct Written {
    pub text: String,
    pub rows: Vec<Row>,
    pub remarks: Vec<String>,
}

/// Kept as `how`.
pub(super) fn kept(how: impl Into<String>) -> (Fate, String) {
    (Fate::Kept, how.into())
}

/// Approximated; `how` says what differs.
pub(super) fn near(how: impl Into<String>) -> (Fate, String) {
    (Fate::Approximated, how.into())
}

/// Lost; `why` says what the target lacks.
pub(super) fn lost(why: impl Into<String>) -> (Fate, String) {
    (Fate::Lost, why.into())
}

/// Lines that list what is approximated and lost, for the head of a file.
pub(super) fn losses(rows: &[Row]) -> Vec<String> {
    let said = |row: &&Row| match row.fate {
        Fate::Kept => None,
        Fate::Approximated => Some(format!("APPROXIMATED {}: {}", row.what, row.how)),
        Fate::Lost => Some(format!("LOST {} ({}): {}", row.what, row.law, row.how)),
    };
    let lines: Vec<String> = rows.iter().filter_map(|row| said(&row)).collect();
    if lines.is_empty() { vec!["Nothing of the model is lost.".to_owned()] } else { lines }
}
