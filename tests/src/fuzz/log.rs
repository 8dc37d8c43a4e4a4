//! Logs in every format: an error, or channels that keep their promises, and what `look` makes of them. Frames of CAN come
//! with their description.

use breakaway::file::FileError;
use breakaway::look::look_at;
use breakaway::recording::formats::Log;
use breakaway::recording::{ReadOptions, Recording, RecordingError};

/// Reads the bytes as a log.
pub fn run(bytes: &[u8]) -> bool {
    keeps_its_promises(Log::read_from("fuzz.log", bytes))
}

/// Reads the bytes up to the first zero as a description, and those behind it as frames of CAN.
pub fn can(bytes: &[u8]) -> bool {
    let mut parts = bytes.splitn(2, |byte| *byte == 0);
    let (description, frames) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    keeps_its_promises(Log::read_frames("fuzz.log", frames, description))
}

/// Guesses, and reads each pair of the first channels as a recording; false where the log was refused.
fn keeps_its_promises(read: Result<Log, RecordingError>) -> bool {
    let log = match read {
        Ok(log) => log,
        Err(RecordingError::File(FileError::Write { .. })) => panic!("an error of writing from bytes in memory"),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    for group in &log.groups {
        assert!(group.rows() > 0 && !group.channels.is_empty());
        assert!(group.channels.iter().all(|channel| channel.values.len() == group.rows()));
        assert!(group.stamps_s.as_ref().is_none_or(|stamps| stamps.len() == group.rows()));
    }
    let names: Vec<String> = log.channels().map(|(name, ..)| name).take(4).collect();
    for (drive, position) in names.iter().flat_map(|a| names.iter().map(move |b| (a, b))) {
        let options = ReadOptions {
            input: Some(drive.clone()),
            position: Some(position.clone()),
            max_rows: Some(1000),
            ..ReadOptions::default()
        };
        if let Ok(Recording { t, u, x, .. }) = Recording::from_log("fuzz.log", &log, &options) {
            assert!(t.len() >= 8 && t.len() == u.len() && t.len() == x.len());
            assert!(t.windows(2).all(|w| w[0] < w[1]));
            assert!([&t, &u, &x].into_iter().flatten().all(|value| value.is_finite()));
        }
    }
    let look = look_at("fuzz.log", &log, &ReadOptions::default());
    assert!(!breakaway::report::look::page(&look).is_empty());
    true
}
