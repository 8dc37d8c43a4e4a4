//! From recordings to a base model: the estimators, and the choice between them.

pub mod cycles;
pub mod estimate;
pub mod relay;
mod slow_log;
mod swapped;
pub mod weak;
