//! What a file is that is not what was asked for: a model given as a recording, a page, a program.

use std::fmt;

/// What the content of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// A recording, CSV.
    Recording,
    /// A model, TOML.
    Model,
    /// An experiment, TOML.
    Experiment,
    /// A controller, TOML.
    Controller,
    /// TOML of no known kind.
    Toml,
    /// HTML or XML.
    Page,
    /// JSON.
    Json,
    /// Bytes that are no text.
    Binary,
}

impl fmt::Display for Content {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Recording => "a recording (CSV)",
            Self::Model => "a model (TOML)",
            Self::Experiment => "an experiment (TOML)",
            Self::Controller => "a controller (TOML)",
            Self::Toml => "a TOML file",
            Self::Page => "a page (HTML or XML)",
            Self::Json => "a JSON file",
            Self::Binary => "binary data",
        })
    }
}

impl Content {
    /// The kind with its form.
    pub(crate) fn described(self) -> String {
        match self {
            Self::Recording => "a recording (CSV with a header row)".to_owned(),
            Self::Model => "a model (TOML with [base])".to_owned(),
            Self::Experiment => "an experiment (TOML with [excitation])".to_owned(),
            other => other.to_string(),
        }
    }

    /// What to do where this is wanted, and `found` was given.
    pub(crate) const fn instead_of(self, found: Self) -> &'static str {
        match (self, found) {
            (Self::Recording, Self::Model | Self::Experiment | Self::Controller | Self::Toml) => {
                "check the order of the arguments: a model is given by --model"
            }
            (Self::Recording, _) => "give the log as CSV, MCAP, WPILOG, ULog, npz, MAT or Parquet",
            (Self::Model, Self::Controller) => "give the model it was tuned from, or by --controller the controller",
            (Self::Controller, _) => "`breakaway tune MODEL.toml -o FILE` writes a controller",
            (Self::Experiment, _) => "docs/formats.md has examples",
            _ => "check the order of the arguments",
        }
    }
}

/// What a file with this content seems to be, or `None`. Asked only when its reader refuses it.
pub fn seems(content: &[u8]) -> Option<Content> {
    let text = std::str::from_utf8(content).ok();
    let binary = |byte: &u8| *byte < b' ' && !b"\t\n\r".contains(byte);
    // A recording in an old code page is not UTF-8 either, but has no control characters.
    let Some(text) = text.filter(|text| !text.bytes().any(|byte| binary(&byte))) else {
        return content.iter().any(binary).then_some(Content::Binary);
    };
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let first = lines.clone().next()?;
    if first.starts_with('<') {
        return Some(Content::Page);
    }
    if first.starts_with('{') {
        return Some(Content::Json);
    }
    let has = |section: &str| lines.clone().any(|line| line.starts_with(section));
    // Neither a header row of units, `[s],[V]`, nor one with an equals sign in a name.
    let single = |part: &str| !part.contains([',', ';', '\t']);
    if first.starts_with('[') && single(first) || first.split_once('=').is_some_and(|(key, _)| single(key)) {
        return Some(match () {
            () if has("[controller]") || has("[pid]") => Content::Controller,
            () if has("[excitation") => Content::Experiment,
            () if has("[base]") => Content::Model,
            () => Content::Toml,
        });
    }
    let columns = |line: &str| line.split([',', ';', '\t']).count();
    let second = lines.nth(1)?;
    (columns(first) > 1 && columns(first) == columns(second)).then_some(Content::Recording)
}

#[cfg(test)]
mod tests {
    use super::{Content, seems};

    #[test]
    fn each_kind_of_file_is_known() {
        for (content, expected) in [
            (&b"# tick: 0.001 s\nt,u,x\n0,1,2\n"[..], Some(Content::Recording)),
            (b"[base]\nb = 1\n", Some(Content::Model)),
            (b"# by\n\nname = \"relay\"\n[excitation]\n", Some(Content::Experiment)),
            (b"[controller]\n[pid]\n", Some(Content::Controller)),
            (b"[base]\n[model]\n[pid]\n", Some(Content::Controller)),
            (b"a = 1\n", Some(Content::Toml)),
            (b"<!DOCTYPE html>\n", Some(Content::Page)),
            (b"{\"verdict\": 1}\n", Some(Content::Json)),
            (b"\x7fELF\x01\x00\x00", Some(Content::Binary)),
            (b"[s],[V]\n0,1\n", Some(Content::Recording)),
            // Latin-1, no text that is known, nothing.
            (b"\xb5m,x\n1,2\n", None),
            (b"hello\nworld\n", None),
            (b"", None),
        ] {
            assert_eq!(seems(content), expected, "{:?}", String::from_utf8_lossy(content));
        }
    }
}
