//! The firmware's image under QEMU, with the simulated plant in lock-step, and the host's tools on its pseudo-terminal.

mod bench;
mod closing;
mod discover;
mod faults;
mod flash;
mod identify;
mod loop_closed;
mod soak;
