//! The model: the base equation `b·ẍ + c·ẋ + f1·sgn(ẋ) = u` and named physical effects on top of it.
//!
//! One definition, three users: the simulator, the discovery workflow and the compensator on the board.

mod base;
pub mod effect;
mod motion;

pub use base::{Base, PlantError};
pub use effect::{Effect, Kind};
pub use motion::{Drive, MAX_EFFECTS, MAX_SUB_STEPS, Plant, State};
