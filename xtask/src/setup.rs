//! `cargo xtask setup`: what `cargo xtask test` would fetch on its way, fetched now.

use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result};

use crate::chromium;
use crate::cross::{self, Toolchain};
use crate::emulator;
use crate::qemu;
use crate::run::{cargo, run_within, succeeds};

/// Fetches everything.
pub fn all() -> Result<()> {
    components()?;
    let qemu = qemu::program()?;
    emulator::library()?;
    cross::install_wasm()?;
    chromium::program()?;
    let whose = match cross::install()? {
        Toolchain::Active => "the active",
        Toolchain::Debian => "Debian's",
    };
    println!("ready: {whose} toolchain builds for the microcontrollers, {} runs the virtual board", qemu.display());
    Ok(())
}

/// rustfmt and clippy, which rustup's minimal profile leaves out.
pub fn components() -> Result<()> {
    for component in ["fmt", "clippy"] {
        if !succeeds(&mut cargo([component, "--version"])) {
            let mut add = Command::new("rustup");
            add.args(["component", "add", "rustfmt", "clippy"]);
            return run_within(&mut add, Duration::from_secs(180))
                .context("rustfmt or clippy is missing; install both by `rustup component add rustfmt clippy`");
        }
    }
    Ok(())
}
