//! Why no model can be given.

/// Why no model can be given.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum IdentifyError {
    /// No recording.
    #[error("no recording to identify from")]
    Nothing,
    /// The axis does not move, or too briefly.
    #[error(
        "the recordings hold too little motion to identify from ({windows} windows in motion, at least 12 are \
         needed). Drive the axis harder or record for longer; a relay experiment with h2 above the break-away force \
         is enough. If the axis did move, check that --input and --position are not swapped"
    )]
    TooLittleMotion {
        /// Windows in motion.
        windows: usize,
    },
    /// A parameter cannot be told from others.
    #[error("the recordings cannot determine {parameter}: {advice}")]
    Undetermined {
        /// Which.
        parameter: &'static str,
        /// What would.
        advice: &'static str,
    },
    /// Inertia comes out negative.
    #[error(
        "the inertia comes out negative (b = {b:.3e}): a positive drive accelerates the axis backwards. Reverse the sign of \
         the drive or of the position, and check that --input and --position are not swapped"
    )]
    NegativeInertia {
        /// The estimate.
        b: f64,
    },
    /// An axis with drive and position in each other's place, and none as they are.
    #[error(
        "--input and --position seem to be swapped: as given, {percent:.1} % of the drive stay unexplained. The \
         other way round {other_percent:.1} % do, with a positive inertia and no negative friction"
    )]
    Swapped {
        /// Root mean square of the drive that is not explained, % of the drive's.
        percent: f64,
        /// The same with the columns in each other's place.
        other_percent: f64,
    },
    /// Friction comes out negative, and the equation of motion explains little of the drive.
    #[error(
        "this drive does not make this motion: {parameter} comes out negative ({value:.3e}) and {percent:.0} % of \
         the drive \
         stay unexplained. Check that --input and --position are not swapped, and that both columns are of one recording"
    )]
    NegativeFriction {
        /// `c` or `f1`.
        parameter: &'static str,
        /// The estimate.
        value: f64,
        /// Root mean square of the drive that is not explained, % of the drive's.
        percent: f64,
    },
}
