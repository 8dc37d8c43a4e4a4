//! The columns that the page's user chooses, as the arguments of the command.

use std::str::FromStr;

use breakaway::command::recording_args::RecordingArgs;
use serde::Deserialize;

/// Names and settings as the page has them; an empty text is none.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Columns {
    /// Column of time.
    pub time: String,
    /// Unit of time: s, ms, us, ns, min or h.
    pub time_unit: String,
    /// Column of the drive.
    pub input: String,
    /// Column of the position.
    pub position: String,
    /// Position units after which the position starts anew, or `none`.
    pub wrap: String,
}

impl Columns {
    /// As arguments of the command.
    ///
    /// # Errors
    /// The words of the command for a unit or a wrap that it does not know.
    pub fn arguments(&self) -> Result<RecordingArgs, String> {
        Ok(RecordingArgs {
            time: given(&self.time),
            time_unit: parsed(&self.time_unit)?,
            input: given(&self.input),
            position: given(&self.position),
            wrap: parsed(&self.wrap)?,
            ..RecordingArgs::default()
        })
    }
}

fn given(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

fn parsed<T: FromStr<Err: ToString>>(text: &str) -> Result<Option<T>, String> {
    given(text).map(|text| text.parse().map_err(|error: T::Err| error.to_string())).transpose()
}
