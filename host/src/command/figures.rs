//! `--figures DIR`: every figure of a command, as a drawing, as a picture and as a table.

use std::path::{Path, PathBuf};

use super::output::Output;
use crate::file::{FileKind, Target, make_folder};
use crate::report::figure::Figure;

/// Where figures go; flatten it into a command's arguments.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct FiguresArgs {
    /// Write every figure to this folder, as SVG and PNG, and its numbers as CSV
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
}

/// How the name of every figure's file begins.
const PREFIX: &str = "figure-";
/// What a figure's file holds, by the ending of its name.
const ENDINGS: &[(&str, FileKind)] = &[
    ("svg", FileKind::Figure),
    #[cfg(feature = "command")]
    ("png", FileKind::Picture),
    ("csv", FileKind::FigureTable),
];

impl FiguresArgs {
    /// Before any work: the folder is there or can be made, and what has a figure's name in it may be replaced. How many
    /// figures there will be is not known yet.
    ///
    /// # Errors
    /// [`TargetError`](crate::file::TargetError); a folder that cannot be made.
    pub fn claim(&self, output: Output, inputs: &[&Path]) -> anyhow::Result<()> {
        let Some(folder) = &self.figures else { return Ok(()) };
        let folder = output.folder(folder, "a folder")?;
        make_folder(folder)?;
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            let ours = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX));
            if let Some(kind) = kind_by_ending(&path).filter(|_| ours) {
                output.may_write(&path, kind, inputs)?;
            }
        }
        Ok(())
    }

    /// Writes the figures of `draw`, which is not called where none are asked for. All names are checked before the first
    /// file is written.
    ///
    /// # Errors
    /// As [`claim`](Self::claim), and what the file system reports.
    pub fn write(&self, output: Output, inputs: &[&Path], draw: impl FnOnce() -> Vec<Figure>) -> anyhow::Result<()> {
        let Some(folder) = &self.figures else { return Ok(()) };
        let mut files = Vec::new();
        for (k, figure) in draw().iter().enumerate() {
            let name = format!("{PREFIX}{:02}-{}", k + 1, slug(&figure.title));
            for (ending, kind) in ENDINGS {
                files.push((folder.join(format!("{name}.{ending}")), *kind, bytes(figure, *kind)?));
            }
        }
        for (path, kind, _) in &files {
            output.may_write(path, *kind, inputs)?;
        }
        for (path, _, bytes) in files {
            Target::File(path).write(|out| out.write_all(&bytes))?;
        }
        Ok(())
    }
}

/// What a file of this name holds; `None` where it is none of a figure's.
fn kind_by_ending(path: &Path) -> Option<FileKind> {
    let own = path.extension()?.to_str()?.to_ascii_lowercase();
    ENDINGS.iter().find(|(ending, _)| *ending == own).map(|(_, kind)| *kind)
}

/// A figure as a file of this kind has it.
fn bytes(figure: &Figure, kind: FileKind) -> anyhow::Result<Vec<u8>> {
    Ok(match kind {
        #[cfg(feature = "command")]
        FileKind::Picture => figure.png()?,
        FileKind::FigureTable => figure.csv().into_bytes(),
        _ => figure.file().into_bytes(),
    })
}

/// What `--figure` writes: what the name ends in, else the drawing.
#[cfg(feature = "command")]
pub fn kind_of(target: &Target) -> FileKind {
    let Target::File(path) = target else { return FileKind::Figure };
    kind_by_ending(path).unwrap_or(FileKind::Figure)
}

/// Writes the one figure of `--figure`, as [`kind_of`] says.
///
/// # Errors
/// A figure that cannot be drawn as a picture, and what the file system reports.
#[cfg(feature = "command")]
pub fn write_one(target: &Target, figure: &Figure) -> anyhow::Result<()> {
    let bytes = bytes(figure, kind_of(target))?;
    Ok(target.write(|out| out.write_all(&bytes))?)
}

/// A title as a part of a file's name: small ASCII letters, digits, and `-` for what is between them; 48 letters at most.
fn slug(title: &str) -> String {
    let plain: String =
        title.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { ' ' }).collect();
    let words: Vec<&str> = plain.split_whitespace().collect();
    let slug = words.join("-");
    slug[..slug.len().min(48)].trim_end_matches('-').to_owned()
}

#[cfg(test)]
mod tests {
    use super::slug;

    #[test]
    fn a_title_becomes_a_name_that_every_file_system_takes() {
        assert_eq!(
            slug("Measured and simulated, ../rec 1.csv, from t = 1.20 s"),
            "measured-and-simulated-rec-1-csv-from-t-1-20-s"
        );
        assert_eq!(slug("Größe: ÷"), "gr-e");
        assert!(slug(&"long ".repeat(30)).len() <= 48);
    }
}
