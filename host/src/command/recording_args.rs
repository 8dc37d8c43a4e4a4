//! The arguments of every command that reads recordings.

use std::io::Read;
use std::mem::discriminant;
#[cfg(feature = "command")]
use std::path::Path;
use std::path::PathBuf;

use clap::Args;

use super::console;
#[cfg(feature = "command")]
use super::progress;
use crate::file::FileError;
#[cfg(feature = "command")]
use crate::file::shown;
use crate::fleet::hash::Hashing;
use crate::recording::{ReadOptions, Recording, RecordingError, Selection, TimeUnit, Wrap};
#[cfg(feature = "command")]
use crate::recording::{Signal, Source, Warning};

/// Columns and rows of a recording; flatten it into a command's arguments.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Recording")]
pub struct RecordingArgs {
    /// Column of time [default: t]
    #[arg(long, value_name = "COL")]
    pub time: Option<String>,
    /// Unit of time: s, ms, us, ns, min or h [default: what the column's name ends in, as in `t_ms` or `time (us)`, else s]
    #[arg(long, value_name = "UNIT")]
    pub time_unit: Option<TimeUnit>,
    /// Column of the applied drive [default: u]
    #[arg(long, value_name = "COL")]
    pub input: Option<String>,
    /// Column of the position [default: x]
    #[arg(long, value_name = "COL")]
    pub position: Option<String>,
    /// Column of the motor's current, A (or mA, if its name ends so) [default: i_A, if the file's header has its unit]
    #[arg(long, value_name = "COL")]
    pub current: Option<String>,
    /// Sampling rate; time is then counted from the rows, whatever the file says
    #[arg(long, value_name = "HZ", value_parser = positive, allow_negative_numbers = true)]
    pub fs: Option<f64>,
    /// Encoder step in position units [default: the file's, or inferred]
    #[arg(long, value_name = "STEP", value_parser = positive, allow_negative_numbers = true)]
    pub encoder_step: Option<f64>,
    /// Position units after which the position starts anew, such as 4096 counts; `none` if it does not
    #[arg(long, value_name = "N")]
    pub wrap: Option<Wrap>,
    /// Position units per turn of the axis, if the position is in counts [default: the file's]
    #[arg(long, value_name = "N", value_parser = positive, allow_negative_numbers = true)]
    pub counts_per_turn: Option<f64>,
    /// Only rows whose column has this value; may be repeated. Where rows fall out, the recording is cut
    #[arg(long = "where", value_name = "COL=VALUE")]
    pub select: Vec<Selection>,
    /// Description of the frames of a CAN log (candump, SavvyCAN), in DBC
    #[arg(long, value_name = "F.dbc")]
    pub dbc: Option<PathBuf>,
    /// Only rows from this time on, s by the file's clock
    #[arg(long, value_name = "S", value_parser = finite, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Only rows up to this time
    #[arg(long, value_name = "S", value_parser = finite, allow_negative_numbers = true)]
    pub to: Option<f64>,
}

impl RecordingArgs {
    /// The same as options of the reader.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            time: self.time.clone(),
            time_unit: self.time_unit,
            input: self.input.clone(),
            position: self.position.clone(),
            current: self.current.clone(),
            fs_hz: self.fs,
            encoder_step: self.encoder_step,
            wrap: self.wrap,
            counts_per_turn: self.counts_per_turn,
            window_s: (self.from.is_some() || self.to.is_some())
                .then(|| (self.from.unwrap_or(f64::NEG_INFINITY), self.to.unwrap_or(f64::INFINITY))),
            max_rows: None,
            select: self.select.clone(),
            dbc: self.dbc.clone(),
        }
    }

    /// Reads a recording, with progress; what is doubtful about it goes to standard error.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column.
    #[cfg(feature = "command")]
    pub fn read(&self, path: &Path) -> Result<Recording, RecordingError> {
        Ok(self.read_hashed(path)?.0)
    }

    /// Reads a recording as [`read`](Self::read) does. With it comes the SHA-256 of its bytes, in hex.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column.
    #[cfg(feature = "command")]
    pub fn read_hashed(&self, path: &Path) -> Result<(Recording, String), RecordingError> {
        // A contradiction among the arguments comes before what is wrong with the file.
        self.options().check()?;
        self.read_input(&shown(path), progress::reading(Source::open(path)?))
    }

    /// Reads a recording from `input`; `file` is its name in messages. With it comes the SHA-256 of its bytes, in hex.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column.
    pub fn read_input(&self, file: &str, input: impl Read) -> Result<(Recording, String), RecordingError> {
        self.options().check()?;
        let mut input = Hashing::new(input);
        let recording = Recording::read_from(file, &mut input, &self.options())?;
        let hash = input.finish().map_err(|error| FileError::reading(file, &error))?;
        let (rows, first, last) = (recording.t.len(), recording.t[0], recording.t[recording.t.len() - 1]);
        console::detail(format_args!(
            "{file}: {rows} rows, {first:.3} s to {last:.3} s, {} gap(s)",
            recording.gaps.len()
        ));
        for warning in recording.warnings() {
            console::warn_of(discriminant(&warning), format_args!("{file}: {warning}"));
        }
        Ok((recording, hash))
    }

    /// Reads one column of a recording (the position if `None`), with progress. Where the clock starts anew, the longest part.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line and column.
    #[cfg(feature = "command")]
    pub fn read_signal(&self, path: &Path, column: Option<&str>) -> Result<Signal, RecordingError> {
        self.options().check()?;
        let file = shown(path);
        let input = progress::reading(Source::open(path)?);
        let (signal, found) = Signal::read_mended(&file, input, column, &self.options())?;
        for warning in found {
            console::warn(format_args!("{file}: {warning}"));
            if let Warning::ClockRestarts { .. } = warning {
                console::warn(format_args!("{file}: the longest part, of {} rows, is used", signal.t.len()));
            }
        }
        Ok(signal)
    }
}

/// A positive, finite number, for clap.
///
/// # Errors
/// A message for the user.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("expected a positive number".to_owned()),
    }
}

/// A finite number, for clap.
///
/// # Errors
/// A message for the user.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("expected a number".to_owned()),
    }
}

/// A finite number that is not negative, for clap.
///
/// # Errors
/// A message for the user.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err("expected a number, 0 or more".to_owned()),
    }
}
