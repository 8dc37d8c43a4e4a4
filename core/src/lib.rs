//! The part of Breakaway that runs on both sides: on the microcontroller and on the host.
//!
//! `no_std`, no allocation, no `unsafe`, and no panic on any input. The numbers are in [`scalar`]: f32, f64 and fixed
//! point. The model is in [`plant`]: the base equation and the named effects. [`excite`] drives an experiment,
//! [`estimate`] identifies the axis from it, and [`control`] drives the axis along a reference. [`link`] holds messages
//! and frames.
#![no_std]
#![forbid(unsafe_code)]

pub mod control;
pub mod estimate;
pub mod excite;
mod fnv;
pub mod link;
pub mod plant;
mod says;
pub mod scalar;
