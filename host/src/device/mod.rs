//! The board, from the host: the port, its messages, recordings of its samples, experiments run on it, the live monitor.
//!
//! [`Client`] speaks the link of [`breakaway_core::link`] over a serial port or a pseudo-terminal; nothing here knows
//! whether hardware or the virtual board is behind it.

pub mod capture;
mod client;
mod error;
pub mod experiment;
pub mod list;
pub mod model;
pub mod monitor;
mod port;
pub mod scale;
pub mod set_points;
pub mod settings;
pub mod share;
pub mod stop;
pub mod stream;
pub mod text;
pub mod virtual_board;

pub use client::{Client, Counters};
pub use error::DeviceError;
pub use port::wait_for;
