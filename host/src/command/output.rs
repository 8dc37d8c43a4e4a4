//! Standard output: text for people, or one JSON document for machines; and what a command may write beside it.

use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Serialize;
use serde_json::Value;

use super::{UsageError, console};
use crate::file::{FileKind, Target, TargetError, apart, is_standard_input, may_write};
use crate::report::remark::RemarkJson;

/// How results are printed, and what they may replace.
#[derive(Clone, Copy, Debug)]
pub struct Output {
    /// JSON instead of text.
    pub json: bool,
    /// Files that breakaway did not write may be replaced.
    pub force: bool,
    /// Standard output is taken by a file (`-o -`): text goes to standard error.
    pub taken: bool,
}

impl Output {
    /// Checks before any work that each of `targets` may be written by a command that reads `inputs`.
    ///
    /// # Errors
    /// [`TargetError`]; a [`UsageError`] where the arguments contradict each other.
    pub fn claim(self, targets: &[(&Target, FileKind)], inputs: &[&Path]) -> anyhow::Result<Self> {
        let all: Vec<&Target> = targets.iter().map(|(target, _)| *target).collect();
        apart(&all).map_err(as_usage)?;
        if inputs.iter().filter(|path| is_standard_input(path)).count() > 1 {
            return Err(UsageError("`-` is given more than once; standard input can be read once".to_owned()).into());
        }
        let mut taken = self.taken;
        for (target, kind) in targets {
            match target {
                Target::Standard if self.json => return Err(as_usage(TargetError::StandardWithJson)),
                Target::Standard => taken = true,
                Target::File(path) => self.may_write(path, *kind, inputs)?,
            }
        }
        Ok(Self { taken, ..self })
    }

    /// Checks that a file may be written: see [`may_write`].
    ///
    /// # Errors
    /// [`TargetError`].
    pub fn may_write(self, path: &Path, kind: FileKind, inputs: &[&Path]) -> Result<(), TargetError> {
        may_write(path, kind, inputs, self.force)
    }

    /// A folder to write to, which `-` is not; `what` is what it is for, with an article.
    ///
    /// # Errors
    /// A [`UsageError`].
    pub fn folder<'a>(self, path: &'a Path, what: &'static str) -> anyhow::Result<&'a Path> {
        if path.as_os_str() == "-" { Err(as_usage(TargetError::NotStandard { what })) } else { Ok(path) }
    }

    /// Prints `document` as JSON, or with `--json` absent the text made from it.
    ///
    /// # Errors
    /// What standard output reports. That its reader has gone away (`| head`) is no error.
    pub fn print<T: Serialize>(self, document: &T, text: impl FnOnce(&T) -> String) -> anyhow::Result<()> {
        let mut text = if self.json { serde_json::to_string_pretty(&versioned(document)?)? } else { text(document) };
        PRINTED.store(true, Ordering::Relaxed);
        if !text.ends_with('\n') {
            text.push('\n');
        }
        if self.taken {
            eprint!("{text}");
            return Ok(());
        }
        let mut out = io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
            _ => Ok(()),
        }
    }
}

/// Version of the documents. It grows when a field goes away or changes its meaning, not when one is added.
pub const SCHEMA_VERSION: u32 = 1;

/// Whether this command has printed its document: a reason to fail that comes after it is no second document.
static PRINTED: AtomicBool = AtomicBool::new(false);

/// Whether standard output has its document already.
pub fn has_printed() -> bool {
    PRINTED.load(Ordering::Relaxed)
}

/// The document with its version, and with the warnings of this run among its remarks.
///
/// # Errors
/// A document that JSON cannot hold.
pub fn versioned<T: Serialize>(document: &T) -> serde_json::Result<Value> {
    with_warnings(document, console::warnings())
}

/// The document with its version, and with `warnings` among its remarks.
///
/// # Errors
/// A document that JSON cannot hold.
pub fn with_warnings<T: Serialize>(document: &T, warnings: Vec<String>) -> serde_json::Result<Value> {
    let mut value = serde_json::to_value(document)?;
    if let Value::Object(fields) = &mut value {
        let warnings = warnings.into_iter().map(|text| RemarkJson::new("warning", &text));
        let warnings: Vec<Value> = warnings.map(serde_json::to_value).collect::<Result<_, _>>()?;
        match fields.get_mut("remarks") {
            Some(Value::Array(remarks)) => remarks.extend(warnings),
            None if !warnings.is_empty() => _ = fields.insert("remarks".to_owned(), Value::Array(warnings)),
            _ => {}
        }
        fields.insert("schema_version".to_owned(), SCHEMA_VERSION.into());
    }
    Ok(value)
}

/// An error of the arguments as one of usage.
fn as_usage(error: TargetError) -> anyhow::Error {
    if error.is_usage() { UsageError(error.to_string()).into() } else { error.into() }
}
