//! Recordings of one session, as every command that takes several of them reads them.

use std::path::Path;

use super::recording_args::RecordingArgs;
use crate::recording::{Recording, RecordingError, Warning};

/// Recordings of which each moves, and what is to be said of the others.
#[derive(Debug, Default)]
pub struct Session {
    /// The recordings that move, in the order in which they were given; at least one.
    pub recordings: Vec<Recording>,
    /// One remark for each recording that was left out because it does not move.
    pub remarks: Vec<String>,
}

impl RecordingArgs {
    /// Reads recordings of one session. A recording that does not move is left out with a remark while others move.
    ///
    /// # Errors
    /// [`RecordingError`]; [`RecordingError::NoMotion`] if none of several recordings, or the only one, moves.
    pub fn read_session<P: AsRef<Path>>(&self, paths: &[P]) -> Result<Session, RecordingError> {
        let mut session = Session::default();
        let mut still: Option<RecordingError> = None;
        for path in paths {
            let file = path.as_ref().display().to_string();
            let recording = self.read(path.as_ref())?;
            if recording.moves() {
                session.recordings.push(recording);
                continue;
            }
            let warnings = recording.warnings();
            let Some(found) = warnings.iter().find(|warning| matches!(warning, Warning::NoMotion { .. })) else {
                continue;
            };
            session.remarks.push(format!("{file} is left out: {found}"));
            if let Warning::NoMotion { range, rows } = *found {
                let column = self.options().position_column().to_owned();
                still.get_or_insert(RecordingError::NoMotion { file, column, range, rows });
            }
        }
        match still {
            Some(refusal) if session.recordings.is_empty() => Err(refusal),
            _ => Ok(session),
        }
    }
}
