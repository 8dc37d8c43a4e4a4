//! `cargo xtask loops`: the closed loop on the virtual board, of all effects, those included that the tests leave out.

use anyhow::Result;

use crate::cross::Toolchain;
use crate::image;
use crate::qemu;
use crate::run::{cargo, run};

/// Builds the image and runs them one after the other; what they print is the table of docs/control.md.
pub fn all(toolchain: Toolchain) -> Result<()> {
    qemu::program()?;
    image::build(toolchain)?;
    run(&mut cargo(["build", "--package", "breakaway"]))?;
    run(&mut cargo([
        "test",
        "--package",
        "breakaway-tests",
        "--test",
        "virtual_board",
        "--",
        "--include-ignored",
        "--nocapture",
        "--test-threads=1",
        "discovered_is_compensated",
        "a_constant_load_is_no_worse",
    ]))
}
