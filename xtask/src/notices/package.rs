//! A package in a product, and the texts in its sources that its licence asks to hand out.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;

use super::font;
use crate::run::root;

/// What cargo knows of a package.
#[derive(Debug, Deserialize)]
pub struct Package {
    name: String,
    version: String,
    manifest_path: PathBuf,
    license: Option<String>,
    repository: Option<String>,
    authors: Vec<String>,
    links: Option<String>,
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

/// Beginnings of the names of files that say under which terms a package is handed out.
const BEGINNINGS: [&str; 5] = ["license", "licence", "copying", "copyright", "notice"];
/// What packages say that they link. zstd and SQLite are compiled from sources in the package. Python's is that of whoever loads
/// the wheel. The others are names that a package takes so that it is linked once, with nothing behind them.
const LIBRARIES: [&str; 6] = ["zstd", "sqlite3", "pyo3-python", "python", "rayon-core", "wasm_bindgen"];

/// All packages of the answer of `cargo metadata`.
pub fn all(metadata: &str) -> Result<Vec<Package>> {
    let metadata: Metadata = serde_json::from_str(metadata).context("cargo metadata")?;
    Ok(metadata.packages)
}

impl Package {
    /// Name and version.
    pub fn version_of(&self) -> (String, String) {
        (self.name.clone(), self.version.clone())
    }

    /// Whether it has this name.
    pub fn is_called(&self, name: &str) -> bool {
        self.name == name
    }

    /// One of the workspace.
    pub fn is_ours(&self) -> bool {
        self.manifest_path.starts_with(root())
    }

    /// What to call it. Its sources are where its repository is.
    pub fn title(&self) -> String {
        let terms: Vec<&str> = [&self.license, &self.repository].into_iter().flatten().map(String::as_str).collect();
        format!("{} {} ({})", self.name, self.version, terms.join(", "))
    }

    /// The texts at the root of its sources. A package that has none is handed out under the standard text of its licence.
    ///
    /// # Errors
    /// There is neither, or a file cannot be read.
    pub fn texts(&self) -> Result<Vec<String>> {
        let mut texts = Vec::new();
        let folder = self.folder();
        for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
            let path = entry?.path();
            let name = path.file_name().map(|name| name.to_string_lossy().to_lowercase()).unwrap_or_default();
            if BEGINNINGS.iter().any(|start| name.starts_with(start)) && path.is_file() {
                let text = text(&path)?;
                // No package comes under it alone (deny.toml): it is one of two to choose from.
                if !text.contains("GNU GENERAL PUBLIC LICENSE") {
                    texts.push((path, text));
                }
            }
        }
        texts.sort();
        if texts.is_empty() {
            Ok(vec![self.standard()?])
        } else {
            Ok(texts.into_iter().map(|(_, text)| text).collect())
        }
    }

    /// What other people's code or fonts it has within it: a title, and the text of each.
    ///
    /// # Errors
    /// It links a library that is not known here, or a text is not where it was.
    pub fn bundled(&self) -> Result<Vec<(String, String)>> {
        if let Some(library) = &self.links {
            let known = LIBRARIES.contains(&library.as_str());
            ensure!(known, "{}: the licence of the library {library} is not known to `xtask/src/notices`", self.name);
        }
        let title = |what: &str| format!("{what} in {} {}", self.name, self.version);
        Ok(match self.name.as_str() {
            "zstd-sys" => vec![(title("zstd"), text(&self.folder().join("zstd/LICENSE"))?)],
            "libsqlite3-sys" => {
                let words = "SQLite is in the public domain. Its authors have dedicated it, and ask for no notice.";
                vec![(title("SQLite"), words.to_owned())]
            }
            "dejavu" => {
                let fonts = self.folder().join("assets/dejavu-fonts-ttf-2.37/ttf");
                vec![(title("the fonts DejaVu Sans"), font::licence(&fonts.join("DejaVuSans.ttf"))?)]
            }
            _ => Vec::new(),
        })
    }

    fn folder(&self) -> &Path {
        self.manifest_path.parent().unwrap_or(&self.manifest_path)
    }

    /// The text of its licence, of two that which is ours too: Apache names no holder, and MIT does.
    fn standard(&self) -> Result<String> {
        let offered: Vec<&str> = self.license.as_deref().unwrap_or_default().split([' ', '/']).collect();
        let offers = |licence: &str| offered.contains(&licence) && !offered.contains(&"AND");
        if offers("Apache-2.0") {
            return text(&root().join("LICENSE-APACHE"));
        }
        let holder = match &self.repository {
            _ if !self.authors.is_empty() => self.authors.join(", "),
            Some(repository) => format!("the authors of {}, {repository}", self.name),
            None => bail!("{}: it has no licence text, no authors and no repository", self.title()),
        };
        ensure!(offers("MIT"), "{}: it has no licence text, and is neither MIT nor Apache-2.0", self.title());
        mit(&format!("Copyright (c) {holder}"))
    }
}

/// The text of the MIT licence, with that line as the copyright.
pub fn mit(copyright: &str) -> Result<String> {
    let ours = text(&root().join("LICENSE-MIT"))?;
    let lines = ours.lines().map(|line| if line.starts_with("Copyright") { copyright } else { line });
    Ok(lines.collect::<Vec<_>>().join("\n"))
}

/// A text, whatever bytes are in it.
fn text(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| path.display().to_string())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
