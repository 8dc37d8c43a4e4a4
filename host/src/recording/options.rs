//! How a file's columns are read as a recording.

use std::fmt;
use std::str::FromStr;

use super::RecordingError;

/// Which columns, which rows, and what the file does not say itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Column of time; `t` if not given. A name that ends in `_ms` or `_us` is read in that unit.
    pub time: Option<String>,
    /// Column of the applied drive; `u` if not given.
    pub input: Option<String>,
    /// Column of the position; `x` if not given.
    pub position: Option<String>,
    /// Sampling rate, Hz: time is then made from the row number, whatever the file says.
    pub fs_hz: Option<f64>,
    /// Encoder step in position units; else the file's header, else inferred.
    pub encoder_step: Option<f64>,
    /// Conditions a row must meet, all of them.
    pub select: Vec<Selection>,
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

    pub(super) fn check(&self) -> Result<(), RecordingError> {
        for (option, value) in [("--fs", self.fs_hz), ("--encoder-step", self.encoder_step)] {
            if let Some(value) = value
                && !(value.is_finite() && value > 0.0)
            {
                return Err(RecordingError::Option { option, value });
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
