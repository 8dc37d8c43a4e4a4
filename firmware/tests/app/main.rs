//! The whole application against a simulated axis: commands, experiments, guards, faults.

mod bench;
mod drift;
mod faults;
mod identification;
mod runs;
mod track;
mod zero;
