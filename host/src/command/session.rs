//! Recordings of one session, as every command that takes several of them reads them.

#[cfg(feature = "command")]
use std::path::Path;

#[cfg(feature = "command")]
use super::recording_args::RecordingArgs;
#[cfg(feature = "command")]
use crate::file::shown;
use crate::recording::{Recording, RecordingError, SessionError, Units, Warning};

/// Recordings that all move, with a remark for each that does not and was left out.
#[derive(Debug, Default)]
pub struct Session {
    /// The recordings that move, in the order in which they were given; at least one.
    pub recordings: Vec<Recording>,
    /// The files of `recordings`, as they were given.
    pub files: Vec<String>,
    /// Every file that was read, as it was given, and the SHA-256 of its bytes.
    pub hashes: Vec<(String, String)>,
    /// One remark for each recording that was left out because it does not move.
    pub remarks: Vec<String>,
}

/// A recording that was read, before it is known to belong to a session.
#[derive(Clone, Debug)]
pub struct Read {
    /// What messages call it: its file as it was given.
    pub file: String,
    /// What was read.
    pub recording: Recording,
    /// SHA-256 of the bytes that it was read from, in hex.
    pub sha256: String,
}

#[cfg(feature = "command")]
impl RecordingArgs {
    /// Reads recordings of one session. A recording that does not move is left out with a remark while others move.
    ///
    /// # Errors
    /// [`RecordingError`]; [`SessionError::NoMotion`] if none of several recordings, or the only one, moves;
    /// [`SessionError::Units`] and [`SessionError::GivenTwice`].
    pub fn read_session<P: AsRef<Path>>(&self, paths: &[P]) -> Result<Session, RecordingError> {
        let all = paths.iter().map(|path| {
            let (recording, sha256) = self.read_hashed(path.as_ref())?;
            Ok(Read { file: shown(path.as_ref()), recording, sha256 })
        });
        Session::of(all, self.options().position_column())
    }
}

/// Units in words.
fn named(units: &Units) -> String {
    format!("{} and {}", units.u, units.x)
}

impl Session {
    /// Makes a session of recordings, each of which is read when the ones before it are in. A recording that does not move
    /// is left out with a remark while others move; `column` is the position's name in the refusal.
    ///
    /// # Errors
    /// As of [`RecordingArgs::read_session`].
    pub fn of(
        all: impl IntoIterator<Item = Result<Read, RecordingError>>,
        column: &str,
    ) -> Result<Self, RecordingError> {
        let mut session = Self::default();
        let mut still: Option<SessionError> = None;
        for read in all {
            let Read { file, recording, sha256 } = read?;
            session.hashes.push((file.clone(), sha256));
            if recording.moves() {
                session.add(file, recording)?;
                continue;
            }
            let warnings = recording.warnings();
            let Some(found) = warnings.iter().find(|warning| matches!(warning, Warning::NoMotion { .. })) else {
                continue;
            };
            session.remarks.push(format!("{file} is left out: {found}"));
            if let Warning::NoMotion { range, rows } = *found {
                still.get_or_insert(SessionError::NoMotion { file, column: column.to_owned(), range, rows });
            }
        }
        match still {
            Some(refusal) if session.recordings.is_empty() => Err(refusal.into()),
            _ => Ok(session),
        }
    }

    /// The file that was given first.
    pub fn first_file(&self) -> String {
        self.hashes.first().map(|(file, _)| file.clone()).unwrap_or_default()
    }

    /// Adds a recording of the same units that is not there yet.
    fn add(&mut self, file: String, recording: Recording) -> Result<(), RecordingError> {
        if let (Some(first), Some(name)) = (self.recordings.first(), self.files.first())
            && first.units != recording.units
        {
            return Err(SessionError::Units {
                first: name.clone(),
                first_units: named(&first.units),
                second: file,
                second_units: named(&recording.units),
            }
            .into());
        }
        if let Some(first) = self.file_of(&recording) {
            return Err(SessionError::GivenTwice { first, second: file, held_out: false }.into());
        }
        self.recordings.push(recording);
        self.files.push(file);
        Ok(())
    }

    /// The file that holds the same samples as `recording`, whatever its name.
    fn file_of(&self, recording: &Recording) -> Option<String> {
        let same = |other: &Recording| other.t == recording.t && other.u == recording.u && other.x == recording.x;
        let mut all = self.recordings.iter().zip(&self.files);
        all.find(|(other, _)| same(other)).map(|(_, file)| file.clone())
    }

    /// Converts every position that is an angle to rad. Returns the unit that it had, if it had another.
    pub fn in_radians(&mut self) -> Option<String> {
        self.recordings.iter_mut().filter_map(Recording::in_radians).last()
    }

    /// Checks that nothing of this session is held out as well.
    ///
    /// # Errors
    /// [`SessionError::GivenTwice`], with both files.
    pub fn is_apart_from(&self, holdout: &Self) -> Result<(), SessionError> {
        for (recording, second) in holdout.recordings.iter().zip(&holdout.files) {
            if let Some(first) = self.file_of(recording) {
                return Err(SessionError::GivenTwice { first, second: second.clone(), held_out: true });
            }
        }
        Ok(())
    }
}
