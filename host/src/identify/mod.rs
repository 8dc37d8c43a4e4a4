//! From recordings to a model: weak-form equation error, and output error by multiple shooting.

pub mod candidate;
pub mod cycles;
pub mod dual;
pub mod estimate;
pub mod relay;
pub mod shooting;
mod slow_log;
mod swapped;
pub mod track;
pub mod weak;
