//! What is begun beside clippy and the build of the host's programs: images, QEMU, Unicorn, and the Pythons. They link on one
//! core and wait for the network.
//!
//! Each has a step of its own later, which finds it done, or does it again and says why it fails. What is printed and what
//! fails here is therefore dropped.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::cross::{self, Toolchain};
use crate::run::beside;
use crate::{emulator, export, processor, qemu, rp2350};

/// What it took.
pub struct Taken {
    pub time: Duration,
    /// Processor time, s; known on Linux.
    pub processor_s: Option<f64>,
}

/// Does all that can be done without the host's programs, until `stopped`. They are built in other folders of the target
/// folder, so that cargo locks neither out.
pub fn all(toolchain: Toolchain, stopped: &AtomicBool) -> Taken {
    // The downloads first: who waits for them needs no processor. Then what takes longest.
    let fetched: [&dyn Fn() -> Result<PathBuf>; 4] =
        [&qemu::program, &|| emulator::library().map(|()| PathBuf::new()), &rp2350::emulator, &export::python];
    let images = [&cross::NUCLEO, &cross::PICO2, &cross::IMAGE, &cross::INTEGER_TICK, &cross::BUDGET];
    let builds = images.into_iter().chain(cross::BUILDS.map(|(_, build)| build));
    let start = Instant::now();
    beside(|| {
        let go_on = || !stopped.load(Ordering::Relaxed);
        for fetch in fetched.into_iter().take_while(|_| go_on()) {
            let _ = fetch();
        }
        for build in builds.take_while(|_| go_on()) {
            let _ = cross::build(toolchain, build);
        }
    });
    Taken { time: start.elapsed(), processor_s: processor::time_beside_s() }
}
