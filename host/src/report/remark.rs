//! Remarks in JSON documents (docs/formats.md, section "JSON results").

use schemars::JsonSchema;
use serde::Serialize;

/// A remark: what it is about, and the sentence that a person reads.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct RemarkJson {
    /// Its kind, in snake case.
    pub kind: &'static str,
    /// The sentence.
    pub text: String,
}

impl RemarkJson {
    /// A remark of a kind.
    pub fn new(kind: &'static str, text: &impl ToString) -> Self {
        Self { kind, text: text.to_string() }
    }
}
