//! What is begun beside the build of the host's programs: images, the page, QEMU, Unicorn, Chromium, and the Pythons. An image is
//! linked on one core, and a download uses none.
//!
//! Each has a step of its own later, which finds it done, or does it again and says why it fails. Output and errors are
//! therefore dropped here.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::Result;

use crate::cross::{self, Toolchain};
use crate::run::beside;
use crate::{chromium, emulator, export, processor, python, qemu, rp2350, web};

/// What it took.
pub struct Taken {
    pub time: Duration,
    /// Processor time, s; known on Linux.
    pub processor_s: Option<f64>,
}

/// Does all that can be done without the host's programs, until `stopped`. Images are built in other folders of the target
/// folder than the host's programs, so that neither build waits for the lock of the other.
pub fn all(toolchain: Toolchain, stopped: &AtomicBool) -> Taken {
    // The downloads first, as the host's build has the processor meanwhile. Of the images the slowest comes first.
    let fetched: [&dyn Fn() -> Result<PathBuf>; 6] = [
        &qemu::program,
        &|| emulator::library().map(|()| PathBuf::new()),
        &rp2350::emulator,
        &export::python,
        &|| python::environments().map(|_| PathBuf::new()),
        &chromium::program,
    ];
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
        if go_on() {
            let _ = web::page();
        }
    });
    Taken { time: start.elapsed(), processor_s: processor::time_beside_s() }
}
