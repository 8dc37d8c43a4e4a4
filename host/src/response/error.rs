//! Why there is no frequency response.

/// Why there is no frequency response.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum ResponseError {
    /// Recordings with other intervals between their rows.
    #[error(
        "recordings with other sampling rates ({first_hz:.4} and {second_hz:.4} Hz) cannot be averaged; give those of one \
         rate"
    )]
    Rates {
        /// Rate of the first recording, Hz.
        first_hz: f64,
        /// The other rate, Hz.
        second_hz: f64,
    },
    /// No stretch without a gap is long enough.
    #[error(
        "the longest stretch without a gap has {samples} samples, and {needed} are needed; record for longer, without losing \
         samples"
    )]
    TooShort {
        /// Samples of the longest stretch.
        samples: usize,
        /// Samples that are needed.
        needed: usize,
    },
    /// A segment as long as was asked cannot be.
    #[error("a segment of {segment_s} s cannot be used; give --segment from {least_s:.4} to {most_s:.4} s")]
    Segment {
        /// What was asked, s.
        segment_s: f64,
        /// The shortest, s.
        least_s: f64,
        /// The longest, s: the longest stretch without a gap.
        most_s: f64,
    },
    /// The position follows the drive at no frequency.
    #[error(
        "the position follows the drive at no frequency ({segments} segments were averaged); drive the axis with a sweep or a \
         multisine, or record for longer"
    )]
    Incoherent {
        /// Segments that were averaged.
        segments: usize,
    },
}
