//! An error as a JSON document (docs/formats.md, "Errors").

use std::io::{self, Write as _};

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::UsageError;
use super::output::versioned;
use crate::control::ControlError;
use crate::device::DeviceError;
use crate::device::set_points::LineError;
use crate::device::virtual_board::VirtualBoardError;
use crate::discover::request::DiscoverError;
use crate::export::ExportError;
use crate::file::{FileError, TargetError};
use crate::fit::FitError;
use crate::fleet::machine::FolderError;
use crate::identify::estimate::IdentifyError;
use crate::model::ModelError;
use crate::models::CardError;
use crate::recording::RecordingError;
use crate::report::figure::RasterError;
use crate::response::ResponseError;
use crate::simulate::SimulateError;
use crate::sine::SineFitError;

/// What could not be done.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Failure {
    /// Name of the error, in snake case: `wrong_column`, `not_found`, `usage`; `other` for one without a name.
    pub kind: String,
    /// The message, as on standard error.
    pub message: String,
    /// The file, as it was given.
    pub file: Option<String>,
    /// Line in the file, from 1.
    pub line: Option<u64>,
    /// Name of the column.
    pub column: Option<String>,
    /// What to do: what stands after the first semicolon of the message.
    pub hint: Option<String>,
}

/// The document.
#[derive(Serialize, JsonSchema)]
pub(in crate::command) struct Document<'a> {
    error: &'a Failure,
}

impl Failure {
    /// Of a command that failed.
    pub fn of(error: &anyhow::Error) -> Self {
        let typed = error.chain().find_map(typed).unwrap_or(Value::Null);
        Self { kind: kind(error, &typed), ..Self::at(format!("{error:#}"), &typed) }
    }

    /// Whose error it is: `recording`, `model`, `file` and so on; `usage` of arguments, `other` of one without a name.
    pub fn family(error: &anyhow::Error) -> &'static str {
        if error.is::<UsageError>() {
            return "usage";
        }
        error.chain().find_map(family).unwrap_or("other")
    }

    /// Of a command line that is wrong.
    pub fn of_usage(error: &clap::Error) -> Self {
        let text = error.render().to_string();
        let message = text.split("\n\n").next().unwrap_or(&text).trim_start_matches("error: ").to_owned();
        Self { kind: "usage".to_owned(), ..Self::at(message, &Value::Null) }
    }

    /// The message, and the place that the innermost error names.
    fn at(message: String, typed: &Value) -> Self {
        let own = innermost(typed);
        let at = own.get("at").unwrap_or(own);
        let field = |name: &str| [&at[name], &at["place"][name]].into_iter().find(|value| !value.is_null()).cloned();
        let text = |name: &str| field(name).and_then(|value| value.as_str().map(str::to_owned));
        let hint = message.split_once("; ").map(|(_, hint)| hint.to_owned());
        Self {
            file: text("file"),
            line: field("line").and_then(|line| line.as_u64()),
            column: text("column"),
            hint,
            message,
            ..Self::default()
        }
    }

    /// Writes the document to standard output.
    pub fn print(&self) {
        let document =
            versioned(&Document { error: self }).and_then(|document| serde_json::to_string_pretty(&document));
        if let Ok(text) = document {
            // Whoever has closed standard output (`| head`) reads no document; the exit code tells.
            let _ = writeln!(io::stdout(), "{text}");
        }
    }
}

/// An error of this crate with its fields; `None` for another's.
fn typed(error: &(dyn std::error::Error + 'static)) -> Option<Value> {
    macro_rules! first_of {
        ($($own:ty),*) => {
            None$(.or_else(|| error.downcast_ref::<$own>().and_then(|own| serde_json::to_value(own).ok())))*
        };
    }
    first_of!(
        RecordingError,
        ModelError,
        FileError,
        TargetError,
        DeviceError,
        VirtualBoardError,
        DiscoverError,
        IdentifyError,
        FitError,
        SimulateError,
        ControlError,
        SineFitError,
        FolderError,
        LineError,
        ExportError,
        CardError,
        ResponseError,
        RasterError
    )
}

/// The family of an error of this crate; that of the error which it passes on, where that has one.
fn family(error: &(dyn std::error::Error + 'static)) -> Option<&'static str> {
    let passed_on = match typed(error)?["kind"].as_str() {
        Some("file") => Some("file"),
        Some("identify") => Some("identify"),
        Some("fit") => Some("fit"),
        _ => None,
    };
    let is = |name, found: bool| found.then_some(name);
    passed_on
        .or_else(|| is("recording", error.is::<RecordingError>()))
        .or_else(|| is("model", error.is::<ModelError>()))
        .or_else(|| is("file", error.is::<FileError>() || error.is::<TargetError>() || error.is::<FolderError>()))
        .or_else(|| is("device", error.is::<DeviceError>() || error.is::<VirtualBoardError>()))
        .or_else(|| is("discover", error.is::<DiscoverError>()))
        .or_else(|| is("identify", error.is::<IdentifyError>()))
        .or_else(|| is("fit", error.is::<FitError>()))
        .or_else(|| is("simulate", error.is::<SimulateError>()))
        .or_else(|| is("control", error.is::<ControlError>() || error.is::<LineError>()))
        .or_else(|| is("sine", error.is::<SineFitError>()))
        .or_else(|| is("export", error.is::<ExportError>()))
        .or_else(|| is("card", error.is::<CardError>()))
        .or_else(|| is("response", error.is::<ResponseError>()))
}

/// The error that an error passes on.
fn innermost(typed: &Value) -> &Value {
    if typed["at"]["kind"].is_string() { innermost(&typed["at"]) } else { typed }
}

fn kind(error: &anyhow::Error, typed: &Value) -> String {
    if error.is::<UsageError>() {
        return "usage".to_owned();
    }
    innermost(typed)["kind"].as_str().unwrap_or("other").to_owned()
}
