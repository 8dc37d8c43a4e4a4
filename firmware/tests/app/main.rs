//! The whole application against a simulated axis: commands, experiments, guards, faults.

mod bench;
mod faults;
mod identification;
mod runs;
mod track;
