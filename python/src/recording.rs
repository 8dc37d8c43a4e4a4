//! A recording that Python holds: its columns are arrays, and the rest is the library's.

use std::io::{Cursor, Read as _};
use std::path::PathBuf;

use anyhow::Context as _;
use breakaway::command::session::{Read, Session};
use breakaway::file::{FileKind, Target, may_write, shown};
use breakaway::fleet::hash::Hashing;
use breakaway::recording::formats::{Channel, Format, Group, Log, Values};
use breakaway::recording::{CURRENT, ReadOptions, Recording as Rows, Source};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{array, column, numbers};
use crate::error::exception;
use crate::options::Options;
use crate::work::away;

/// One recording of an axis.
#[pyclass(frozen, module = "breakaway")]
pub struct Recording {
    /// Everything but the columns.
    rest: Rows,
    /// Time, s.
    #[pyo3(get)]
    t: Py<PyArray1<f64>>,
    /// Applied drive.
    #[pyo3(get)]
    u: Py<PyArray1<f64>>,
    /// Position.
    #[pyo3(get)]
    x: Py<PyArray1<f64>>,
    /// Current, A, where it was measured.
    #[pyo3(get)]
    current: Option<Py<PyArray1<f64>>>,
    /// What messages call it.
    file: String,
    /// Of what it was made of, in hex.
    #[pyo3(get)]
    sha256: String,
    /// Name of the position's column, for messages.
    position: String,
    /// What is doubtful about it.
    #[pyo3(get)]
    warnings: Vec<String>,
    rows: usize,
}

impl Recording {
    /// Gives a recording to Python: its columns become arrays without a copy.
    ///
    /// # Errors
    /// Those of numpy.
    pub fn new(py: Python<'_>, mut rows: Rows, file: String, sha256: String, position: &str) -> PyResult<Self> {
        let warnings = py.detach(|| rows.warnings()).iter().map(ToString::to_string).collect();
        let taken = |numbers: &mut Vec<f64>| array(py, std::mem::take(numbers));
        let current = (!rows.current.is_empty()).then(|| taken(&mut rows.current)).transpose()?;
        let count = rows.t.len();
        let (t, u, x) = (taken(&mut rows.t)?, taken(&mut rows.u)?, taken(&mut rows.x)?);
        Ok(Self { rest: rows, t, u, x, current, file, sha256, position: position.to_owned(), warnings, rows: count })
    }

    /// The library's recording, with copies of the columns.
    fn rows(&self, py: Python<'_>) -> PyResult<Rows> {
        Ok(Rows {
            t: numbers(py, &self.t)?,
            u: numbers(py, &self.u)?,
            x: numbers(py, &self.x)?,
            current: self.current.as_ref().map(|current| numbers(py, current)).transpose()?.unwrap_or_default(),
            ..self.rest.clone()
        })
    }
}

/// Recordings of one session as the library has them, before they are checked.
pub struct Taken {
    reads: Vec<Read>,
    position: String,
    /// Their warnings, as the command prints them.
    pub warnings: Vec<String>,
}

impl Taken {
    /// Copies the recordings that Python holds.
    ///
    /// # Errors
    /// Those of numpy.
    pub fn of(py: Python<'_>, recordings: &[Py<Recording>]) -> PyResult<Self> {
        let mut taken = Self { reads: Vec::new(), position: "x".to_owned(), warnings: Vec::new() };
        for recording in recordings {
            let own = recording.get();
            taken.position.clone_from(&own.position);
            taken.warnings.extend(own.warnings.iter().map(|warning| format!("{}: {warning}", own.file)));
            let sha256 = own.sha256.clone();
            taken.reads.push(Read { file: own.file.clone(), recording: own.rows(py)?, sha256 });
        }
        Ok(taken)
    }

    /// The session that they make.
    ///
    /// # Errors
    /// As the command's.
    pub fn session(self) -> anyhow::Result<Session> {
        Ok(Session::of(self.reads.into_iter().map(Ok), &self.position)?)
    }
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (t, u, x, *, current, units, name, options))]
    #[allow(clippy::too_many_arguments, reason = "the package's own call, all by name")]
    fn of_arrays(
        py: Python<'_>,
        t: &Bound<'_, PyAny>,
        u: &Bound<'_, PyAny>,
        x: &Bound<'_, PyAny>,
        current: Option<&Bound<'_, PyAny>>,
        units: (Option<String>, Option<String>),
        name: String,
        options: Options,
    ) -> PyResult<Self> {
        let mut channels = vec![
            ("t", Some("s".to_owned()), column("t", t)?),
            ("u", units.0, column("u", u)?),
            ("x", units.1, column("x", x)?),
        ];
        if let Some(current) = current {
            channels.push((CURRENT, Some("A".to_owned()), column("current", current)?));
        }
        let made = py.detach(|| {
            let options = ReadOptions { current: current_of(&channels), ..options.read()? };
            let sha256 = hash(channels.iter().map(|(.., numbers)| numbers))?;
            let log = log(channels);
            let mut rows = Rows::from_log(&name, &log, &options)?;
            rows.name.clone_from(&name);
            anyhow::Ok((rows, sha256))
        });
        let (rows, sha256) = made.map_err(|error| exception(py, &error))?;
        Self::new(py, rows, name, sha256, "x")
    }

    fn __len__(&self) -> usize {
        self.rows
    }

    fn __repr__(&self) -> String {
        let units = &self.rest.units;
        format!("Recording({:?}, {} samples, drive in {}, position in {})", self.rest.name, self.rows, units.u, units.x)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.rest.name
    }

    #[getter]
    fn units(&self) -> (&str, &str) {
        (&self.rest.units.u, &self.rest.units.x)
    }

    #[getter]
    fn encoder_step(&self) -> Option<f64> {
        self.rest.encoder_step
    }

    #[getter]
    fn counts_per_turn(&self) -> Option<f64> {
        self.rest.counts_per_turn
    }

    #[getter]
    fn gaps(&self) -> Vec<usize> {
        self.rest.gaps.clone()
    }

    #[getter]
    fn meta(&self) -> std::collections::BTreeMap<String, String> {
        self.rest.meta.clone()
    }

    #[pyo3(signature = (path, force = false))]
    fn write(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let rows = self.rows(py)?;
        let written = py.detach(|| {
            may_write(&path, FileKind::Recording, &[], force)?;
            Target::File(path).write(|mut out| rows.write_to(&mut out))
        });
        written.map_err(|error| exception(py, &error.into()))
    }
}

/// The option that names the current, where there is one.
fn current_of(channels: &[(&str, Option<String>, Vec<f64>)]) -> Option<String> {
    channels.iter().any(|(name, ..)| *name == CURRENT).then(|| CURRENT.to_owned())
}

/// The arrays as a log whose channels share their rows.
pub fn log(channels: Vec<(&'static str, Option<String>, Vec<f64>)>) -> Log {
    let channels = channels.into_iter().map(|(name, unit, numbers)| Channel {
        name: name.to_owned(),
        unit,
        values: Values::Numbers(numbers),
    });
    let group = Group { channels: channels.collect(), ..Group::default() };
    Log { format: Format::Npz, groups: vec![group], torn_at: None, passed_over: Vec::new() }
}

/// SHA-256 of the columns, one after the other, as 64-bit floats with the low byte first.
fn hash<'a>(columns: impl Iterator<Item = &'a Vec<f64>>) -> anyhow::Result<String> {
    let empty: Box<dyn std::io::Read> = Box::new(std::io::empty());
    let all = columns.fold(empty, |all, column| {
        let bytes: Vec<u8> = column.iter().flat_map(|number| number.to_le_bytes()).collect();
        Box::new(all.chain(Cursor::new(bytes)))
    });
    Hashing::new(all).finish().context("the arrays cannot be hashed")
}

/// Reads a file, CSV or a log in another format.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf, options: Options) -> PyResult<Recording> {
    let options = options.read().map_err(|error| exception(py, &error))?;
    let position = options.position_column().to_owned();
    let (rows, file, sha256) = away(py, None, move |_| {
        options.check()?;
        let file = shown(&path);
        let mut input = Hashing::new(Source::open(&path)?);
        let rows = Rows::read_from(&file, &mut input, &options)?;
        let sha256 = input.finish().with_context(|| file.clone())?;
        Ok((rows, file, sha256))
    })?;
    Recording::new(py, rows, file, sha256, &position)
}
