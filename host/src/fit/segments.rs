//! Segments: samples of a track that are simulated in one go.

use super::prepare::MeasuredMotion;

/// Samples of a track that are simulated in one go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Index of the track.
    pub track: usize,
    /// First sample.
    pub start: usize,
    /// Number of samples, ≥ 2.
    pub len: usize,
}

/// Cuts the pieces of the tracks into segments of `length_s`, 8 samples at least. A remnant of less than half is
/// dropped.
pub fn segments(tracks: &[MeasuredMotion], length_s: f64) -> Vec<Segment> {
    let mut segments = Vec::new();
    for (track, prepared) in tracks.iter().enumerate() {
        let len = ((length_s / prepared.ts).round() as usize).max(8);
        for piece in prepared.pieces.windows(2) {
            let mut start = piece[0];
            while start + len / 2 < piece[1] {
                let len = len.min(piece[1] - start);
                if len >= 8 {
                    segments.push(Segment { track, start, len });
                }
                start += len;
            }
        }
    }
    segments
}

/// At most `most` of the segments, evenly spaced.
pub fn sampled(segments: Vec<Segment>, most: usize) -> Vec<Segment> {
    if segments.len() <= most {
        return segments;
    }
    (0..most).map(|i| segments[i * segments.len() / most]).collect()
}
