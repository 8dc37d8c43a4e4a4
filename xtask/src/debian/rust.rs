//! Debian's toolchain, for machines that reach no rustup server: a recent rustc with the sources of its own `core`.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, ensure};

use super::tree::{Tree, folder};
use crate::cross;
use crate::run::{answer, root};

/// What brings the toolchain.
pub const PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
/// What brings a linker, where the active toolchain has none.
const LINKER: &str = "lld";
const SOURCES: &str = "usr/lib/rustlib/src/rust/library/core/Cargo.toml";
/// Oldest 1.x rustc that builds the workspace (`rust-version` in Cargo.toml).
const MINOR: u32 = 89;

/// The programs of one toolchain.
struct Programs {
    rustc: PathBuf,
    cargo: PathBuf,
    linker: PathBuf,
}

impl Programs {
    /// Those in a folder of programs.
    fn below(folder: &Path) -> Self {
        Self { rustc: folder.join("rustc"), cargo: folder.join("cargo"), linker: folder.join("ld.lld") }
    }

    fn is_recent(&self) -> bool {
        let version = answer(Command::new(&self.rustc).arg("--version"));
        version.and_then(|version| minor(&version)).is_some_and(|minor| minor >= MINOR)
    }
}

/// Those that are installed, else those that were unpacked; both with the sources of `core`, and recent enough.
fn programs() -> Option<Programs> {
    let installed = Programs::below(Path::new("/usr/bin"));
    if installed.cargo.is_file() && Path::new("/").join(SOURCES).is_file() && installed.is_recent() {
        return Some(installed);
    }
    let unpacked = Programs::below(&scripts());
    (tree().path(SOURCES).is_file() && unpacked.is_recent()).then_some(unpacked)
}

fn tree() -> Tree {
    Tree::named("rust")
}

fn scripts() -> PathBuf {
    folder().join("rust-bin")
}

/// Whether the toolchain is there.
pub fn is_there() -> bool {
    programs().is_some()
}

/// Unpacks the toolchain, unless it is there.
///
/// # Errors
/// See [`Tree::unpack`]; the packages are too old.
pub fn unpack() -> Result<()> {
    if is_there() {
        return Ok(());
    }
    let linker = if cross::bundled_linker().is_none() { Some(LINKER) } else { None };
    let packages: Vec<&str> = PACKAGES.into_iter().chain(linker).collect();
    let tree = tree();
    tree.unpack(&packages)?;
    for program in ["rustc", "cargo"].into_iter().chain(linker.map(|_| "ld.lld")) {
        tree.script(&format!("usr/bin/{program}"), &[], &scripts().join(program))?;
    }
    ensure!(is_there(), "the unpacked packages hold no rustc 1.{MINOR} or later with its sources");
    Ok(())
}

/// `cargo build` by Debian's toolchain, building `core` and `alloc` on the way.
pub fn cargo_build(target: &str) -> Command {
    let programs = programs().unwrap_or_else(|| Programs::below(&scripts()));
    let mut command = Command::new(&programs.cargo);
    let linker = cross::bundled_linker().unwrap_or(programs.linker);
    command
        .current_dir(root())
        // Without these, cargo would find rustup's rustc, and rustup this program's toolchain.
        .env("RUSTC", &programs.rustc)
        .env_remove("RUSTUP_TOOLCHAIN")
        // `-Z build-std` on a stable compiler.
        .env("RUSTC_BOOTSTRAP", "1")
        .env(target_variable(target, "LINKER"), linker)
        .args(["build", "-Z", "build-std=core,alloc"]);
    command
}

/// The variable that sets cargo's `target.TARGET.KEY`.
fn target_variable(target: &str, key: &str) -> String {
    format!("CARGO_TARGET_{}_{key}", target.to_uppercase().replace('-', "_"))
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
