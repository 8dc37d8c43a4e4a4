//! Guards: what ends a run or latches a fault before the mode is asked for a drive. Integers only.

mod direction;
mod settings;
mod watch;

pub use settings::Guards;
pub(super) use watch::{GuardOutcome, Held, Observation, Watch};
