//! Errors of the library as Python's exceptions.

use breakaway::command::failure::Failure;
use pyo3::prelude::*;
use serde_json::json;

/// The exception of an error, with the text that the command prints.
pub fn exception(py: Python<'_>, error: &anyhow::Error) -> PyErr {
    let Failure { kind, message, file, line, column, hint } = Failure::of(error);
    let family = Failure::family(error);
    let document = json!({
        "family": family, "kind": kind, "message": message, "file": file, "line": line, "column": column, "hint": hint,
    });
    let made = py.import("breakaway._errors").and_then(|errors| errors.call_method1("of", (document.to_string(),)));
    made.map_or_else(|error| error, PyErr::from_value)
}
