//! Breakaway on a microcontroller: what runs there is generic over the traits of [`board`].
//!
//! Builds for the host as well, where the same code runs in unit tests.
#![no_std]
#![deny(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod app;
pub mod board;
pub mod storage;
