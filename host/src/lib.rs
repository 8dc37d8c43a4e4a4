//! The host side of Breakaway: recordings in, models out.
#![forbid(unsafe_code)]

pub mod command;
pub mod control;
#[cfg(feature = "command")]
pub mod device;
pub mod discover;
pub mod export;
pub mod file;
pub mod fit;
pub mod fleet;
pub mod identify;
#[cfg(feature = "command")]
pub mod interrupt;
pub mod look;
pub mod mistaken;
pub mod model;
pub mod models;
pub mod nearest;
pub mod recording;
pub mod report;
#[cfg(feature = "command")]
pub mod response;
pub mod simulate;
pub mod sine;
