//! What is in a stranger's log: its channels, which of them are time, drive and position, and what is wrong with it.

mod faults;
mod guess;
mod motion;
mod names;
mod summary;

pub use faults::{Fault, FaultKind};
pub use guess::{Guess, Guesses};
pub use summary::Summary;

use std::path::Path;

use crate::file::is_standard_input;
use crate::recording::formats::{Format, Log};
use crate::recording::{ClockError, ReadOptions, Recording, RecordingError, Wrap};

/// What was seen in one file.
#[derive(Clone, Debug)]
pub struct Look {
    /// The file, as it was given.
    pub file: String,
    /// What it is.
    pub format: Format,
    /// Its channels.
    pub channels: Vec<Summary>,
    /// Which of them are time, drive and position.
    pub guesses: Guesses,
    /// What is wrong, the gravest first.
    pub faults: Vec<Fault>,
    /// What was passed over in the file, and why.
    pub passed_over: Vec<String>,
    /// How it is read as a recording, with the guesses.
    pub options: ReadOptions,
    /// The recording, if there is one.
    pub recording: Option<Recording>,
    /// What a user may want to add, each with its reason.
    pub hints: Vec<String>,
}

/// Looks at a file. What `options` name is not guessed.
///
/// # Errors
/// [`RecordingError`] where the file cannot be read as a log at all.
pub fn look(path: &Path, file: &str, options: &ReadOptions) -> Result<Look, RecordingError> {
    options.check()?;
    let log = Log::read_described(path, options.dbc.as_deref())?;
    // CSV is read as `identify` reads it, field by field, unless it has gone by already.
    let again = log.format == Format::Csv && !is_standard_input(path);
    Ok(look_by(file, &log, options, |options| {
        if again { Recording::read(path, options) } else { Recording::from_log(file, &log, options) }
    }))
}

/// Looks at a log that was read already; `file` is its name in messages.
pub fn look_at(file: &str, log: &Log, options: &ReadOptions) -> Look {
    look_by(file, log, options, |options| Recording::from_log(file, log, options))
}

/// Looks at a log; `read` reads its recording.
fn look_by(
    file: &str,
    log: &Log,
    options: &ReadOptions,
    read: impl Fn(&ReadOptions) -> Result<Recording, RecordingError>,
) -> Look {
    let (guesses, mut options) = guess::guess(log, options);
    let mut look = Look {
        file: file.to_owned(),
        format: log.format,
        channels: summary::summaries(log, &guesses),
        faults: Vec::new(),
        passed_over: log.passed_over.clone(),
        options: options.clone(),
        recording: None,
        hints: Vec::new(),
        guesses,
    };
    if look.guesses.drive.is_none() || look.guesses.position.is_none() {
        look.faults.extend(faults::missing(&look.guesses, &options));
        return look;
    }
    let mut outcome = read(&options);
    // What a refusal proposes is tried, once each.
    for _ in 0..2 {
        match &outcome {
            Err(RecordingError::RollsOver { modulus, .. }) if options.wrap.is_none() => {
                options.wrap = Some(Wrap::Modulus(*modulus));
                look.hints
                    .push(format!("--wrap {modulus}: the position starts anew after {modulus}, as an encoder's does"));
            }
            Err(RecordingError::Clock(ClockError::Rate { likely: Some((unit, rate_hz)), .. }))
                if options.time_unit.is_none() =>
            {
                options.time_unit = Some(*unit);
                look.hints.push(format!("--time-unit {unit}: the rate is then {rate_hz:.0} Hz"));
            }
            _ => break,
        }
        outcome = read(&options);
    }
    match outcome {
        Ok(recording) => {
            look.faults = faults::of(&recording);
            look.hints.extend(guess::hints(&recording));
            look.recording = Some(recording);
        }
        Err(error) => look.faults.push(Fault { kind: FaultKind::Refused, share: None, text: error.to_string() }),
    }
    look.options = options;
    look
}
