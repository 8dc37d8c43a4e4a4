//! What Breakaway computes on a host: recordings in, models out.
//!
//! A crate of its own, because this code alone is optimised while it is developed. The command around it, its
//! formats, figures and boards are the crate `breakaway`, by which everything here is reached.
#![forbid(unsafe_code)]

pub mod control;
pub mod discover;
pub mod file;
pub mod fit;
pub mod identify;
#[cfg(feature = "command")]
pub mod interrupt;
pub mod mistaken;
pub mod model;
pub mod nearest;
pub mod recording;
#[cfg(feature = "command")]
pub mod response;
pub mod simulate;
pub mod sine;
