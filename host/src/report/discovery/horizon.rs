//! How far ahead the simulation is judged: the same in the headline, the tiles and the ladder.

use crate::discover::outcome::{Discovery, Rung};

/// A horizon of the held-out simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Horizon {
    /// Windows of 1 s, each from a start fitted to its beginning.
    OpenLoop,
    /// Segments of 0.4 s, for recordings that hold no window of 1 s.
    Segment,
}

impl Horizon {
    /// The longest one over which every model of the ladder could be judged.
    pub fn of(found: &Discovery) -> Self {
        let judged = found.ladder.iter().all(|rung| rung.holdout_open_loop_rmse.is_finite());
        if judged { Self::OpenLoop } else { Self::Segment }
    }

    /// The held-out error over it, position units.
    pub const fn error(self, rung: &Rung) -> f64 {
        match self {
            Self::OpenLoop => rung.holdout_open_loop_rmse,
            Self::Segment => rung.holdout_rmse,
        }
    }

    /// The horizon in words, after "error".
    pub const fn words(self) -> &'static str {
        match self {
            Self::OpenLoop => "over 1 s",
            Self::Segment => "over 0.4 s",
        }
    }
}
