//! The whole application against a simulated axis: commands, experiments, guards, faults.

mod bench;
mod current;
mod drift;
mod faults;
mod faults_page;
mod fixed_point;
mod follow;
mod identification;
mod runs;
mod track;
mod zero;
