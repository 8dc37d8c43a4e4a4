//! From recordings to a base model: the estimators, and the choice between them.

mod choice;
pub mod cycles;
mod determined;
mod equation_error;
mod error;
pub mod estimate;
mod gravity;
mod held_out;
mod output_error;
pub mod relay;
mod remark;
mod result;
mod slow_log;
mod swapped;
pub mod typical;
pub mod weak;
mod winding;
