//! The commands that use a port, against scripted bytes on a pseudo-terminal: what happens when things go wrong.
//!
//! What the firmware itself does is tested with the firmware (virtual board), not here.
#![cfg(unix)]

mod capture;
mod documents;
mod peer;
mod port;
mod run;
mod share;
