//! Discovery: where simulation and measurement disagree, what is missing, and whether adding it closes the gap.

mod by_force;
mod candidate_rows;
mod clock;
mod corroboration;
pub mod data;
pub mod decide;
pub mod drive_free;
pub mod engine;
mod following;
mod force_residual;
mod gap;
mod inertia;
pub mod judge;
mod known;
mod model;
pub mod next_experiment;
pub mod outcome;
pub mod progress;
mod replication;
pub mod ruled;
pub mod screen;
mod search;
mod small_effects;
mod spectrum;
mod thinned;
mod unweighed;
pub mod where_map;
