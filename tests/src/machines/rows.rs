//! A split and what became of it, as a row of docs/machines.csv.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

use breakaway_core::plant::Kind;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Machine;
use super::discovery::Said;
use super::score::{NO_DRIVE, Named, Score, score};
use super::splits::Split;

/// One row. A cell that has no value is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the machine.
    pub machine: String,
    /// Split, in words.
    pub split: String,
    /// Commit that was run.
    pub commit: String,
    /// Verdict, or `refused`, `panicked`, `no_drive`.
    pub verdict: String,
    /// Effects in order, joined by `+`, each followed by those tied with it: `spring~gravity_load+load_friction`.
    pub named: String,
    /// `b=1.2;c=0.1;f1=0.3;cogging.A=0.2`.
    pub parameters: String,
    /// Held-out force residual of the base, share of the drive.
    pub force_before: Option<f64>,
    /// The same of the final model.
    pub force_after: Option<f64>,
    /// Held-out open-loop error over 1 s of the base, position units.
    pub open_loop_before: Option<f64>,
    /// The same of the final model.
    pub open_loop_after: Option<f64>,
    /// Error of the drive-free curve over such windows, position units.
    pub drive_free: Option<f64>,
    /// Position noise, position units.
    pub noise: Option<f64>,
    /// Unit of the position.
    pub unit: String,
    /// Seconds of the clock.
    pub seconds: Option<f64>,
    /// What the reader or the discovery refused, and why.
    pub note: String,
}

/// Five significant digits, which the recordings do not exceed.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

impl Row {
    /// The row of a split.
    pub fn new(machine: &Machine, split: Split, commit: &str, said: Said) -> Self {
        let parameters = said.parameters.iter().map(|(label, value)| format!("{label}={}", rounded(*value)));
        let [force_before, force_after] = ends(said.force);
        let [open_loop_before, open_loop_after] = ends(said.open_loop);
        Self {
            machine: machine.name.to_owned(),
            split: split.to_string(),
            commit: commit.to_owned(),
            verdict: said.verdict,
            named: cell(&said.named),
            parameters: parameters.collect::<Vec<_>>().join(";"),
            force_before,
            force_after,
            open_loop_before,
            open_loop_after,
            drive_free: None,
            noise: said.noise.map(rounded),
            unit: String::new(),
            seconds: Some((10.0 * said.seconds).round() / 10.0),
            note: said.refusal.unwrap_or_default(),
        }
    }

    /// The row of a machine that logs no drive.
    pub fn no_drive(machine: &Machine, commit: &str) -> Self {
        Self {
            machine: machine.name.to_owned(),
            split: Split::All.to_string(),
            commit: commit.to_owned(),
            verdict: NO_DRIVE.to_owned(),
            ..Self::default()
        }
    }

    /// Adds what the recordings alone say.
    pub fn with(self, drive_free: Option<f64>, unit: &str, remarks: &[&str]) -> Self {
        let notes = remarks.iter().copied().chain(Some(self.note.as_str()).filter(|note| !note.is_empty()));
        let note = notes.collect::<Vec<_>>().join("; ");
        Self { drive_free: drive_free.map(rounded), unit: unit.to_owned(), note, ..self }
    }

    /// Whether it is of this split.
    pub fn is_of(&self, machine: &Machine, split: Split) -> bool {
        self.machine == machine.name && self.split == split.to_string()
    }

    /// The names, in order.
    ///
    /// # Errors
    /// The name that no effect has.
    pub fn names(&self) -> Result<Vec<Named>, String> {
        names(&self.named).map_err(|error| format!("{}, {}: {error}", self.machine, self.split))
    }

    /// The value of a parameter: `f1`, `cogging.A`.
    pub fn parameter(&self, label: &str) -> Option<f64> {
        let cells = self.parameters.split(';').filter_map(|cell| cell.split_once('='));
        cells.filter(|(of, _)| *of == label).find_map(|(_, value)| value.parse().ok())
    }

    /// The score by the machine's truth.
    ///
    /// # Errors
    /// As [`names`](Self::names).
    pub fn score(&self, machine: &Machine) -> Result<Score, String> {
        Ok(score(&machine.truth, &self.verdict, &self.names()?))
    }
}

/// Names as a cell: `spring~gravity_load+load_friction`.
pub fn cell(names: &[Named]) -> String {
    let one = |name: &Named| {
        let all = std::iter::once(&name.kind).chain(&name.tied).map(|kind| kind.name());
        all.collect::<Vec<_>>().join("~")
    };
    names.iter().map(one).collect::<Vec<_>>().join("+")
}

/// The names of a cell.
///
/// # Errors
/// The name that no effect has.
pub fn names(cell: &str) -> Result<Vec<Named>, String> {
    let kind = |name: &str| {
        let found = Kind::ALL.iter().copied().find(|kind| kind.name() == name);
        found.ok_or_else(|| format!("no effect is called `{name}`"))
    };
    let one = |names: &str| {
        let mut kinds = names.split('~').map(kind);
        let first = kinds.next().unwrap_or_else(|| kind(names))?;
        Ok(Named { kind: first, tied: kinds.collect::<Result<_, _>>()? })
    };
    cell.split('+').filter(|names| !names.is_empty()).map(one).collect()
}

fn ends(pair: Option<[f64; 2]>) -> [Option<f64>; 2] {
    pair.map_or([None; 2], |pair| pair.map(|value| Some(rounded(value))))
}

/// Reads the rows of a file; none where there is no file.
///
/// # Errors
/// A row that is none.
pub fn read<R: DeserializeOwned>(path: &Path) -> Result<Vec<R>, csv::Error> {
    match File::open(path) {
        Ok(file) => csv::Reader::from_reader(file).deserialize().collect(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(error.into()),
    }
}

/// Writes the rows in place of what the file held.
///
/// # Errors
/// The file cannot be written.
pub fn write<R: Serialize>(path: &Path, rows: &[R]) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_path(path)?;
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(writer.flush()?)
}

/// Adds a row at the end of the file, after the header where the file is new.
///
/// # Errors
/// The file cannot be written.
pub fn append<R: Serialize>(path: &Path, row: &R) -> Result<(), csv::Error> {
    let file = OpenOptions::new().create(true).append(true).open(path)?;
    let new = file.metadata()?.len() == 0;
    let mut writer = csv::WriterBuilder::new().has_headers(new).from_writer(file);
    writer.serialize(row)?;
    Ok(writer.flush()?)
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::XL330;
    use super::*;

    /// A row that is read back is the row that was written, with a note that holds commas and quotes.
    #[test]
    fn rows_come_back() {
        let said = Said {
            verdict: "partly_explained".into(),
            named: vec![
                Named { kind: Kind::Spring, tied: vec![Kind::GravityLoad] },
                Named { kind: Kind::LoadFriction, tied: Vec::new() },
            ],
            parameters: vec![("b".into(), 0.123_456_78), ("spring.k".into(), 5.7)],
            force: None,
            open_loop: Some([1.0, 0.5]),
            noise: Some(1e-3),
            seconds: 12.345,
            refusal: Some("a \"note\", with a comma".into()),
        };
        let row = Row::new(&XL330, Split::All, "abc", said).with(Some(0.1), "rad", &["a.csv is refused"]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.csv");
        append(&path, &row).unwrap();
        append(&path, &Row::no_drive(&XL330, "abc")).unwrap();
        let again: Vec<Row> = read(&path).unwrap();
        assert_eq!(again, [row.clone(), Row::no_drive(&XL330, "abc")]);
        assert_eq!(row.named, "spring~gravity_load+load_friction");
        assert_eq!(row.names().unwrap()[0].tied, [Kind::GravityLoad]);
        assert_eq!((row.parameter("b"), row.parameter("spring.k")), (Some(0.12346), Some(5.7)));
        assert_eq!(row.note, "a.csv is refused; a \"note\", with a comma");
        assert_eq!(row.score(&XL330), Ok(Score::Right));
        write(&path, &again[..1]).unwrap();
        assert_eq!(read::<Row>(&path).unwrap(), again[..1]);
        assert!(Row { named: "magic".into(), ..row }.names().is_err());
    }
}
