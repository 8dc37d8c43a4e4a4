//! Debian's packages, for machines that reach no rustup server: a recent rustc with the sources of its own `core`.

use std::path::Path;
use std::process::Command;

use anyhow::{Result, bail};

use crate::cross;
use crate::run::{answer, root, run, succeeds};

/// What brings the toolchain.
pub const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "lld"];

const RUSTC: &str = "/usr/bin/rustc";
const CARGO: &str = "/usr/bin/cargo";
const CORE_SOURCES: &str = "/usr/lib/rustlib/src/rust/library/core/Cargo.toml";

/// Oldest 1.x rustc that builds the workspace (`rust-version` in Cargo.toml).
const MINOR: u32 = 89;

/// Whether the toolchain is there, with its sources, and recent enough.
pub fn installed() -> bool {
    Path::new(CARGO).is_file()
        && Path::new(CORE_SOURCES).is_file()
        && answer(Command::new(RUSTC).arg("--version"))
            .and_then(|version| minor(&version))
            .is_some_and(|minor| minor >= MINOR)
}

/// Installs the packages unless they are there. Removes nothing to make room for them.
pub fn install() -> Result<()> {
    if installed() {
        return Ok(());
    }
    install_packages(&PACKAGES)?;
    if !installed() {
        bail!("the installed packages hold no rustc 1.{MINOR} or later with its sources");
    }
    Ok(())
}

/// Installs packages by apt-get, without questions, removing nothing.
pub fn install_packages(packages: &[&str]) -> Result<()> {
    if !succeeds(Command::new("apt-get").arg("--version")) {
        bail!("no apt-get here");
    }
    if !is_root() && !succeeds(Command::new("sudo").args(["-n", "true"])) {
        bail!("neither root nor sudo without a password");
    }
    // One source out of order makes an update fail, and yet the packages may be there.
    if let Err(error) = run(&mut apt_get(&["update"])) {
        println!("{error:#}");
    }
    run(apt_get(&["install", "--yes", "--no-remove", "--no-install-recommends"]).args(packages))
}

/// `cargo build` by Debian's toolchain, building `core` and `alloc` on the way.
pub fn cargo_build(target: &str) -> Command {
    let mut command = Command::new(CARGO);
    let linker = target_variable(target, "LINKER");
    command
        .current_dir(root())
        // Without these, cargo would find rustup's rustc, and rustup this program's toolchain.
        .env("RUSTC", RUSTC)
        .env_remove("RUSTUP_TOOLCHAIN")
        // `-Z build-std` on a stable compiler.
        .env("RUSTC_BOOTSTRAP", "1")
        .env(linker, cross::linker())
        .args(["build", "-Z", "build-std=core,alloc"]);
    command
}

/// The variable that sets cargo's `target.TARGET.KEY`.
pub fn target_variable(target: &str, key: &str) -> String {
    format!("CARGO_TARGET_{}_{key}", target.to_uppercase().replace('-', "_"))
}

fn apt_get(args: &[&str]) -> Command {
    let mut command = if is_root() { Command::new("env") } else { Command::new("sudo") };
    if !is_root() {
        command.args(["-n", "env"]);
    }
    command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get", "--quiet"]);
    // Bounds on every way to hang: a silent server, another apt at work.
    for bound in ["Acquire::http::Timeout=30", "Acquire::https::Timeout=30", "DPkg::Lock::Timeout=300"] {
        command.args(["--option", bound]);
    }
    command.args(args);
    command
}

fn is_root() -> bool {
    answer(Command::new("id").arg("-u")).is_some_and(|id| id == "0")
}

/// The x of `rustc 1.x.y …`.
fn minor(version: &str) -> Option<u32> {
    version.strip_prefix("rustc 1.")?.split('.').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::minor;

    #[test]
    fn the_minor_version_is_read() {
        assert_eq!(minor("rustc 1.96.0 (ac68faa20 2026-05-25) (built from a source tarball)"), Some(96));
        assert_eq!(minor("rustc 1.63.0"), Some(63));
        assert_eq!(minor("gcc 12"), None);
    }
}
