//! The `# key: value` lines before the header row.

use std::collections::BTreeMap;

use super::RecordingError;

/// What the comment lines say.
#[derive(Debug, Default)]
pub(super) struct Header {
    /// Time between rows, s.
    pub tick_s: Option<f64>,
    /// Encoder step, position units.
    pub encoder_step: Option<f64>,
    /// Position units per turn of the axis.
    pub counts_per_turn: Option<f64>,
    /// Unit of each column named in `units: u=V, x=rad`.
    pub units: BTreeMap<String, String>,
    /// Rows (from 0) at which a new piece begins because samples before it were dropped.
    pub gaps: Vec<usize>,
    /// Everything else.
    pub meta: BTreeMap<String, String>,
}

impl Header {
    /// Takes one comment line, without its `#`. A line without a colon is a remark and is passed over. Control characters
    /// are blanks, as in what is written: else a key would be another one after writing.
    pub(super) fn take(&mut self, file: &str, line: u64, text: &str) -> Result<(), RecordingError> {
        let Some((key, value)) = text.split_once(':') else {
            return Ok(());
        };
        let (key, value) = (one_line(key), one_line(value));
        let (key, value) = (key.trim(), value.trim());
        let wrong = |expected| RecordingError::HeaderValue {
            file: file.to_owned(),
            line,
            key: key.to_owned(),
            text: super::field::shown(value),
            expected,
        };
        match key {
            "tick" => {
                let number = positive(value).ok_or_else(|| wrong("a time in seconds such as `0.001 s`"))?;
                self.tick_s = Some(number);
            }
            "encoder step" => {
                let number = positive(value).ok_or_else(|| wrong("a positive step such as `3.14e-4 rad`"))?;
                self.encoder_step = Some(number);
            }
            "counts per turn" => {
                let number = positive(value).ok_or_else(|| wrong("a positive number such as `4096`"))?;
                self.counts_per_turn = Some(number);
            }
            "units" => {
                for pair in value.split(',') {
                    let (column, unit) = pair.split_once('=').ok_or_else(|| wrong("a list such as `u=V, x=rad`"))?;
                    self.units.insert(column.trim().to_owned(), unit.trim().to_owned());
                }
            }
            "gaps" => {
                for row in value.split(',') {
                    let row = row.trim().parse().map_err(|_| wrong("a list of row numbers such as `120, 450`"))?;
                    self.gaps.push(row);
                }
                self.gaps.sort_unstable();
            }
            _ => {
                self.meta.insert(key.to_owned(), value.to_owned());
            }
        }
        Ok(())
    }
}

/// Text that can stand in one comment line.
pub(super) fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// The number in `0.001 s`: positive and finite, its unit ignored.
fn positive(text: &str) -> Option<f64> {
    let number: f64 = text.split_whitespace().next()?.parse().ok()?;
    (number.is_finite() && number > 0.0).then_some(number)
}
