//! How a file's columns are read as a recording.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use super::RecordingError;
use super::clock::{POSSIBLE_HZ, TimeUnit};
use super::wrap::Wrap;

/// Lengths in position units that can be squared.
const POSITIONS: (f64, f64) = (1e-100, 1e100);

/// Which columns, which rows, and what the file does not say itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Column of time; `t` if not given.
    pub time: Option<String>,
    /// Unit of the time column; else the header's `units` line, else what the column's name ends in, else s.
    pub time_unit: Option<TimeUnit>,
    /// Column of the applied drive; `u` if not given.
    pub input: Option<String>,
    /// Column of the position; `x` if not given.
    pub position: Option<String>,
    /// Column of the motor's current, in A, or in mA where its name or the header says so. If not given, it is
    /// [`CURRENT`](super::CURRENT), where the header says that it is in A.
    pub current: Option<String>,
    /// Sampling rate, Hz: time is then made from the row number, whatever the file says.
    pub fs_hz: Option<f64>,
    /// Encoder step in position units; else the file's header, else inferred.
    pub encoder_step: Option<f64>,
    /// Position units per turn of the axis, if the position is in counts; else the file's header.
    pub counts_per_turn: Option<f64>,
    /// First and last time of the rows that are kept, s by the file's clock; all rows if not given.
    pub window_s: Option<(f64, f64)>,
    /// Most rows that are kept; [`MAX_ROWS`](super::MAX_ROWS) if not given.
    pub max_rows: Option<usize>,
    /// After how many position units the position starts anew; if not given, a position that does is refused.
    pub wrap: Option<Wrap>,
    /// Conditions a row must meet, all of them.
    pub select: Vec<Selection>,
    /// The file in DBC that describes the frames of a CAN log.
    pub dbc: Option<PathBuf>,
}

impl ReadOptions {
    /// Name of the time column.
    pub fn time_column(&self) -> &str {
        self.time.as_deref().unwrap_or("t")
    }

    /// Name of the position column.
    pub fn position_column(&self) -> &str {
        self.position.as_deref().unwrap_or("x")
    }

    /// Name of the drive column.
    pub fn input_column(&self) -> &str {
        self.input.as_deref().unwrap_or("u")
    }

    /// Checks the options by themselves, without a file. Reading does so too.
    ///
    /// # Errors
    /// [`RecordingError::Option`] and [`RecordingError::WindowReversed`].
    pub fn check(&self) -> Result<(), RecordingError> {
        if let Some((from_s, to_s)) = self.window_s
            && from_s >= to_s
        {
            return Err(RecordingError::WindowReversed { from_s, to_s });
        }
        for (option, value, range) in [
            ("--fs", self.fs_hz, POSSIBLE_HZ),
            ("--encoder-step", self.encoder_step, POSITIONS),
            ("--counts-per-turn", self.counts_per_turn, POSITIONS),
        ] {
            if let Some(value) = value
                && !(range.0 <= value && value <= range.1)
            {
                return Err(RecordingError::Option { option, value, range });
            }
        }
        Ok(())
    }
}

/// A condition `column=value` on a row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection {
    /// The column.
    pub column: String,
    /// Its value: the same text, or the same number differently written.
    pub value: String,
}

impl Selection {
    pub(super) fn matches(&self, field: &[u8]) -> bool {
        let field = field.trim_ascii();
        if field == self.value.as_bytes() {
            return true;
        }
        let number = |text: &str| text.parse::<f64>().ok();
        let found = std::str::from_utf8(field).ok().and_then(number);
        found.is_some() && found == number(&self.value)
    }
}

impl fmt::Display for Selection {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}={}", self.column, self.value)
    }
}

impl FromStr for Selection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((column, value)) if !column.trim().is_empty() => {
                Ok(Self { column: column.trim().to_owned(), value: value.trim().to_owned() })
            }
            _ => Err("expected `column=value`, such as `anticog_on=0`".to_owned()),
        }
    }
}
