//! Reading a machine's files, as the `breakaway` command would; a file whose clock is at fault is split there.

use std::fs;
use std::path::{Path, PathBuf};

use breakaway::recording::{MIN_ROWS, ReadOptions, Recording, RecordingError};

use super::Machine;

/// One file: its recordings, and what is to be said of it.
#[derive(Clone, Debug)]
pub struct Source {
    /// Name of the file.
    pub file: String,
    /// The file's recordings: one, several where it was split, none where it was refused.
    pub recordings: Vec<Recording>,
    /// The reader's refusal, if there was one.
    pub remark: Option<String>,
}

/// Why a machine cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadingError {
    /// The folder cannot be listed.
    #[error("{folder}: cannot be listed")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Another number of files than the catalogue says.
    #[error("{folder}: {found} files, and the catalogue says {expected}")]
    Files {
        /// The folder.
        folder: PathBuf,
        /// Files there.
        found: usize,
        /// Files of the catalogue.
        expected: usize,
    },
    /// No drive was logged.
    #[error("no drive logged")]
    NoDrive,
}

/// The paths of a machine's files, by name.
///
/// # Errors
/// [`ReadingError::Folder`] and [`ReadingError::Files`].
pub fn files(machine: &Machine, data: &Path) -> Result<Vec<PathBuf>, ReadingError> {
    let folder = data.join(machine.folder);
    let listed = |source| ReadingError::Folder { folder: folder.clone(), source };
    let mut paths = Vec::new();
    for entry in fs::read_dir(&folder).map_err(listed)? {
        let path = entry.map_err(listed)?.path();
        let csv = path.extension().is_some_and(|ending| ending == "csv");
        if csv && file_name(&path).starts_with(machine.prefix) {
            paths.push(path);
        }
    }
    if paths.len() != machine.files {
        return Err(ReadingError::Files { folder, found: paths.len(), expected: machine.files });
    }
    paths.sort();
    Ok(paths)
}

/// Reads a machine's files, by name.
///
/// # Errors
/// [`ReadingError`]. A file that the reader refuses is no error: its [`Source`] says so.
pub fn read(machine: &Machine, data: &Path) -> Result<Vec<Source>, ReadingError> {
    let options = machine.columns.options().ok_or(ReadingError::NoDrive)?;
    let mut sources: Vec<Source> = files(machine, data)?.iter().map(|path| source(path, &options)).collect();
    if let Some(units) = machine.columns.units() {
        for recording in sources.iter_mut().flat_map(|source| &mut source.recordings) {
            recording.units = units.clone();
        }
    }
    Ok(sources)
}

fn source(path: &Path, options: &ReadOptions) -> Source {
    let file = file_name(path);
    match Recording::read(path, options) {
        Ok(recording) => Source { file, recordings: vec![recording], remark: None },
        Err(error) => {
            let faulty = matches!(error, RecordingError::TimeRepeats { .. } | RecordingError::TimeDecreases { .. });
            let recordings = if faulty { split_at_the_clock(path, options) } else { Vec::new() };
            let folder = path.parent().map(|folder| format!("{}/", folder.display())).unwrap_or_default();
            let remark = error.to_string().replace(&folder, "");
            Source { file, recordings, remark: Some(remark) }
        }
    }
}

/// The pieces of a file between the rows at which time does not increase, as far as the reader takes them.
fn split_at_the_clock(path: &Path, options: &ReadOptions) -> Vec<Recording> {
    let text = fs::read_to_string(path).unwrap_or_default();
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let pieces = pieces(&text, options.time.as_deref().unwrap_or("t"));
    let several = pieces.len() > 1;
    let read = |(k, piece): (usize, &String)| {
        let name = if several { format!("{stem} part {}", k + 1) } else { stem.clone() };
        let recording = Recording::read_from(&stem, piece.as_bytes(), options).ok()?;
        Some(Recording { name, ..recording })
    };
    pieces.iter().enumerate().filter_map(read).collect()
}

/// The header row with the rows of each piece; pieces of fewer than [`MIN_ROWS`] rows are left out.
fn pieces(text: &str, time: &str) -> Vec<String> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let header = lines.next().unwrap_or_default();
    let column = header.split(',').position(|name| name.trim() == time).unwrap_or(0);
    let stamp = |line: &str| line.split(',').nth(column).and_then(|field| field.trim().parse::<f64>().ok());
    let mut runs: Vec<Vec<&str>> = Vec::new();
    let mut before = None;
    for line in lines {
        let now = stamp(line);
        match runs.last_mut() {
            Some(run) if now > before => run.push(line),
            _ => runs.push(vec![line]),
        }
        before = now;
    }
    let long = runs.iter().filter(|run| run.len() >= MIN_ROWS);
    long.map(|run| format!("{header}\n{}\n", run.join("\n"))).collect()
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(times: impl IntoIterator<Item = usize>) -> String {
        let rows: Vec<String> = times.into_iter().map(|t| format!("{t},0.5,{}\n", t * t)).collect();
        rows.concat()
    }

    /// A stamp that stands still makes pieces of one row, which are dropped; a restarted clock begins a second piece.
    #[test]
    fn a_file_is_split_where_its_clock_stands_still_or_restarts() {
        let text = format!("t_s,u,x\n{}{}{}", rows(0..10), rows([9, 9, 9]), rows(0..8));
        let found = pieces(&text, "t_s");
        assert_eq!(found, [format!("t_s,u,x\n{}", rows(0..10)), format!("t_s,u,x\n{}", rows(0..8))]);
        // Seven rows are too few for a recording.
        assert!(pieces(&format!("t_s,u,x\n{}", rows(0..7)), "t_s").is_empty());
    }
}
