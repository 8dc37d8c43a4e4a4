//! The clock of a session: several recordings share one if none begins before another has ended.

use super::Recording;

/// First and last instant, s; nothing of a recording without rows.
fn span(recording: &Recording) -> Option<(f64, f64)> {
    Some((*recording.t.first()?, *recording.t.last()?))
}

/// Whether the recordings, in any order, share a running clock.
pub fn share_a_clock<'a>(recordings: impl IntoIterator<Item = &'a Recording>) -> bool {
    let mut spans: Vec<(f64, f64)> = recordings.into_iter().filter_map(span).collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    spans.windows(2).all(|pair| pair[1].0 >= pair[0].1)
}

/// The recordings in the order in which they were made, where they share a clock; as they are otherwise.
pub fn in_session_order(recordings: &[Recording]) -> Vec<Recording> {
    let mut ordered = recordings.to_vec();
    if share_a_clock(recordings) {
        let start = |recording: &Recording| span(recording).map_or(f64::INFINITY, |(first, _)| first);
        ordered.sort_by(|a, b| start(a).total_cmp(&start(b)));
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(name: &str, t: [f64; 2]) -> Recording {
        Recording { name: name.to_owned(), t: t.to_vec(), ..Recording::default() }
    }

    /// A shell sorts files by name; files of one session are put in their order. Files that each begin at 0 stay as they are.
    #[test]
    fn files_of_one_session_in_any_order() {
        let session = [recording("b", [10.0, 19.9]), recording("c", [20.0, 30.0]), recording("a", [0.0, 9.9])];
        assert!(share_a_clock(&session));
        let names: Vec<String> = in_session_order(&session).into_iter().map(|own| own.name).collect();
        assert_eq!(names, ["a", "b", "c"]);
        let apart = [recording("b", [0.0, 5.0]), recording("a", [0.0, 9.9])];
        assert!(!share_a_clock(&apart));
        let names: Vec<String> = in_session_order(&apart).into_iter().map(|own| own.name).collect();
        assert_eq!(names, ["b", "a"]);
    }
}
