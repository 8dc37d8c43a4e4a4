//! The part of Breakaway that runs on both sides: on the microcontroller and on the host.
//!
//! `no_std`, no allocation, no `unsafe`, and no panic on any input. The rooms:
//! [`scalar`] (f32, f64, fixed point), [`plant`] (the model: base equation and named effects),
//! [`excite`] (what is applied), [`estimate`] (what is learnt), [`control`] (what drives the axis along a reference),
//! [`link`] (messages and frames).
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
