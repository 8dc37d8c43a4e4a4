//! The host side of Breakaway: recordings in, models out.
//!
//! What it computes is the crate `breakaway-analysis`, whose rooms are rooms of this library.
#![forbid(unsafe_code)]

pub mod command;
#[cfg(feature = "command")]
pub mod device;
pub mod export;
pub mod fleet;
pub mod look;
pub mod models;
pub mod report;

pub use breakaway_analysis::{
    control, discover, file, fit, identify, mistaken, model, nearest, recording, simulate, sine,
};
#[cfg(feature = "command")]
pub use breakaway_analysis::{interrupt, response};
