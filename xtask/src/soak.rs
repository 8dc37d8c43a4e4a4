//! `cargo xtask soak`: the virtual board under noise on its link.

use anyhow::Result;

use crate::cross::Toolchain;
use crate::image;
use crate::qemu;
use crate::run::{cargo, run};

/// Builds the image and runs it; what it prints is a table of docs/hard-to-break.md. A failure where anything is lost outside
/// the frames that were hit.
pub fn all(toolchain: Toolchain, minutes: f64, ppm: u32) -> Result<()> {
    qemu::program()?;
    image::build(toolchain)?;
    let mut command = cargo(["run", "--package", "breakaway-tests", "--example", "soak", "--"]);
    run(command.args([minutes.to_string(), ppm.to_string()]))
}
