//! A run: from its order to its ending.

use breakaway_core::link::{Bounds, Mode};

use super::excite::{Excitation, Exciter};
use super::guard::{Guards, Watch};

/// What a run does.
#[derive(Clone, Debug, PartialEq)]
pub enum RunOrder<P> {
    /// An experiment.
    Excite(Excitation),
    /// Follow the plan's trajectory.
    Track(P),
    /// Stay at the start, under the plan's controller.
    Hold(P),
}

/// The limits of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunLimits {
    /// Largest drive either way, drive codes.
    pub drive_code: i16,
    /// Largest distance from the start, counts.
    pub travel_counts: u32,
    /// Lowest and highest position, counts.
    pub travel: (i32, i32),
}

impl RunLimits {
    /// Those of the settings, tightened by a run's bounds where it has some.
    pub(super) fn new(guards: &Guards, bounds: Bounds, travel: (i32, i32)) -> Self {
        let drive_code = match bounds.drive_max_code {
            1.. => guards.drive_code.min(bounds.drive_max_code),
            _ => guards.drive_code,
        };
        let travel_counts = if bounds.travel_counts == 0 { u32::MAX } else { bounds.travel_counts };
        Self { drive_code, travel_counts, travel }
    }
}

/// What drives.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    Exciter(Exciter),
    Control,
}

/// A run under way. Everything a run changes is in here, so that dropping it restores what was before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub source: Source,
    pub watch: Watch,
    pub start: i32,
    pub ticks: u32,
    /// 0: until stopped.
    pub max_ticks: u32,
    pub mode: Mode,
    /// The drive is a current: the current loop drives.
    pub regulated: bool,
    /// Ticks in a row above the limit of the current.
    pub over_current_ticks: u32,
}
