//! What is kept of a machine: model, report, and the result with what it was made of.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde_json::{Value, json};

use super::hash::hash;
use super::machine::Inputs;
use crate::file::{make_folder, write_whole};
use crate::model::Model;

/// Key of the result under which stands what it was made of.
const MADE_OF: &str = "fleet";

/// What a discovery leaves for a machine.
#[derive(Clone, Debug)]
pub struct Found {
    /// The improved model.
    pub model: Model,
    /// The report, HTML.
    pub report: String,
    /// The JSON document of `discover`.
    pub document: Value,
}

/// What a result is made of: the same again is not worked out again.
///
/// # Errors
/// An input that cannot be read.
pub fn made_of(inputs: &Inputs, options: &Value) -> anyhow::Result<Value> {
    let of = |role: &str, paths: &[PathBuf]| -> anyhow::Result<Vec<Value>> {
        let row = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Ok(json!({ "role": role, "file": name, "sha256": hash(path)? }))
        };
        paths.iter().map(row).collect()
    };
    let mut list = of("fit", &inputs.fit)?;
    list.extend(of("score", &inputs.score)?);
    list.extend(of("model", inputs.model.as_slice())?);
    Ok(json!({ "version": env!("CARGO_PKG_VERSION"), "options": options, "inputs": list }))
}

/// The files of a machine's result in its folder of the output.
#[derive(Clone, Debug)]
pub struct Place {
    folder: PathBuf,
}

impl Place {
    /// The place of a machine.
    pub fn new(output: &Path, machine: &str) -> Self {
        Self { folder: output.join(machine) }
    }

    /// The improved model.
    pub fn model(&self) -> PathBuf {
        self.folder.join("improved.toml")
    }

    /// The report.
    pub fn report(&self) -> PathBuf {
        self.folder.join("report.html")
    }

    /// The result.
    pub fn result(&self) -> PathBuf {
        self.folder.join("result.json")
    }

    /// The document that is there, if it and its files are whole and made of the same.
    pub fn kept(&self, made_of: &Value) -> Option<Value> {
        if !self.model().is_file() || !self.report().is_file() {
            return None;
        }
        let document: Value = serde_json::from_slice(&fs::read(self.result()).ok()?).ok()?;
        (document.get(MADE_OF) == Some(made_of)).then_some(document)
    }

    /// Writes what was found, the result last: as long as it is not there, the machine is not done.
    ///
    /// # Errors
    /// A folder or file that cannot be written.
    pub fn keep(&self, found: &Found, made_of: &Value) -> anyhow::Result<Value> {
        make_folder(&self.folder)?;
        remove(&self.result())?;
        found.model.write(&self.model())?;
        write(&self.report(), &found.report)?;
        let mut document = found.document.clone();
        if let Some(keys) = document.as_object_mut() {
            keys.insert(MADE_OF.to_owned(), made_of.clone());
        }
        write(&self.result(), &(serde_json::to_string_pretty(&document)? + "\n"))?;
        Ok(document)
    }

    /// Takes away what an earlier run found in inputs that are no longer those of the machine.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn clear(&self) -> anyhow::Result<()> {
        [self.result(), self.model(), self.report()].iter().try_for_each(|path| remove(path))
    }
}

fn remove(path: &Path) -> anyhow::Result<()> {
    match fs::remove_file(path) {
        Err(error) if !matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            Err(error).with_context(|| format!("cannot remove the old {}", path.display()))
        }
        _ => Ok(()),
    }
}

/// Writes a text whole, or not at all.
///
/// # Errors
/// What the system says, with the file's name.
pub fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    write_whole(path, |out: &mut dyn Write| out.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}
