//! Recordings, as text of columns: an error, or a recording that keeps its promises.

use breakaway::file::FileError;
use breakaway::recording::{ReadOptions, Recording, RecordingError, Signal};

/// Reads the bytes as a recording and as a signal, with three sets of options.
pub fn run(bytes: &[u8]) -> bool {
    let options = [
        ReadOptions::default(),
        ReadOptions { fs_hz: Some(1e3), ..ReadOptions::default() },
        ReadOptions { select: vec!["on=1".parse().unwrap()], ..ReadOptions::default() },
    ];
    let mut accepted = false;
    for options in &options {
        match Recording::read_from("fuzz.csv", bytes, options) {
            Ok(recording) => {
                check(&recording);
                accepted = true;
            }
            Err(RecordingError::File(FileError::Read { .. } | FileError::Write { .. })) => {
                panic!("an error of the system from bytes in memory")
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
        if let Ok(signal) = Signal::read_from("fuzz.csv", bytes, Some("u"), options) {
            // An answer or a refusal; what the fit says of a few damaged rows does not matter.
            let _ = breakaway::sine::fit(&signal, f64::NEG_INFINITY..=f64::INFINITY, None);
        }
    }
    accepted
}

/// What every reader of a [`Recording`] may rely on.
fn check(recording: &Recording) {
    let Recording { t, u, x, gaps, .. } = recording;
    assert!(t.len() >= 8 && t.len() == u.len() && t.len() == x.len());
    assert!(t.windows(2).all(|w| w[0] < w[1]));
    assert!([t, u, x].into_iter().flatten().all(|v| v.is_finite()));
    assert!(gaps.windows(2).all(|w| w[0] < w[1]) && gaps.iter().all(|&k| 0 < k && k < t.len()));
    assert!(recording.encoder_step.is_none_or(|step| step.is_finite() && step > 0.0));
    let _ = (recording.timing(), recording.warnings());
    assert!(recording.segments().iter().all(|s| s.t.len() >= 2 && s.t.len() == s.x.len()));
    let mut bytes = Vec::new();
    recording.write_to(&mut bytes).unwrap();
    Recording::read_from("again.csv", bytes.as_slice(), &ReadOptions::default()).unwrap();
}
