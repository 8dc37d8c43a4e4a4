//! Discovery: where simulation and measurement disagree, what is missing, and whether adding it closes the gap.

mod by_force;
pub mod candidates;
mod chain;
pub mod data;
pub mod decide;
pub mod engine;
mod first_heat;
mod gap;
pub mod judge;
pub mod next_experiment;
pub mod outcome;
mod ranking;
pub mod refit;
pub mod screen;
mod small_effects;
mod spectrum;
pub mod where_map;
