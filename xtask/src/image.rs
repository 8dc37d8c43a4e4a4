//! `cargo xtask image`: the virtual board's image, and the QEMU that runs it.

use anyhow::{Context, Result};

use crate::cross::{self, Toolchain};
use crate::qemu;

/// Builds the image, and sees to it that there is a QEMU.
pub fn all() -> Result<()> {
    build(cross::install()?)?;
    println!("{}", qemu::program()?.display());
    Ok(())
}

/// Builds the image and puts it where the host's tools look for it: `images/` in the target folder.
pub fn build(toolchain: Toolchain) -> Result<()> {
    cross::build(toolchain, &cross::IMAGE)?;
    let folder = cross::target_folder().join("images");
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let (from, to) = (cross::binary(&cross::IMAGE, "mps2-an386"), folder.join("mps2-an386.elf"));
    // Beside, then renamed: a virtual board may be starting from it.
    let beside = to.with_extension("new");
    std::fs::copy(&from, &beside).with_context(|| from.display().to_string())?;
    std::fs::rename(&beside, &to).with_context(|| to.display().to_string())?;
    println!("{}", to.display());
    Ok(())
}
