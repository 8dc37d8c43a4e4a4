//! The firmware's image under QEMU, with the simulated plant in lock-step, and the host's tools on its pseudo-terminal.

/// Ends a test where there is no QEMU, and says that it was not run; in CI it fails.
macro_rules! needs_qemu {
    () => {
        if !crate::bench::qemu() {
            return;
        }
    };
}

mod bench;
mod closing;
mod discover;
mod faults;
mod flash;
mod following;
mod identify;
mod loop_closed;
mod soak;
