//! What can be wrong with a list in a field.

use super::Place;

/// Why a field that is a list gives no number.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ListError {
    /// A list where one number is wanted.
    #[error("{place}: `{text}` is a list; give one of its elements, `{}[0]` is the first", place.column)]
    Whole {
        /// Where.
        place: Place,
        /// The field.
        text: String,
    },
    /// A list without the element that is wanted.
    #[error("{place}: element {element} is wanted of a list of {found}, counted from 0")]
    NoElement {
        /// Where.
        place: Place,
        /// The element.
        element: usize,
        /// Elements found.
        found: usize,
    },
}
