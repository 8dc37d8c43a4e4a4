//! Which experiments there are.

/// Which recordings a session holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Experiment {
    /// The standard suite: 40 s to fit, 20 s to score.
    Suite,
    /// Two relay levels to fit (12 s), a third to score (5 s).
    Relay,
    /// One multisine to fit (8 s), another to score (7 s).
    Multisine,
    /// Closed-loop PD tracking of a smooth trajectory: 12 s to fit, another of 6 s to score.
    Track,
    /// One slow sine to fit (10 s), another to score (8 s).
    SlowSine,
    /// The suite's counterpart in closed loop: tracking, moves with dwells, slow moves and a multisine, 40 s to fit and 20 s
    /// to score.
    Closed,
}

impl Experiment {
    /// The experiment of that name: suite, relay, multisine, track, slow_sine, closed.
    pub fn named(name: &str) -> Option<Self> {
        Some(match name {
            "suite" => Self::Suite,
            "relay" => Self::Relay,
            "multisine" => Self::Multisine,
            "track" => Self::Track,
            "slow_sine" => Self::SlowSine,
            "closed" => Self::Closed,
            _ => return None,
        })
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Suite => "suite",
            Self::Relay => "relay",
            Self::Multisine => "multisine",
            Self::Track => "track",
            Self::SlowSine => "slow_sine",
            Self::Closed => "closed",
        }
    }
}

/// Whether a recording is to be fitted or is held out to score.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// May be used to fit.
    Fit,
    /// Only for the score.
    Score,
}
