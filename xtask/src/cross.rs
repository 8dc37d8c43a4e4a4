//! Building for the microcontrollers. The toolchain is the first of these: the target installed in the active
//! toolchain, the target from rustup, Debian's rustc that builds its own `core`.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result, bail};

use crate::debian::rust;
use crate::run::{answer, cargo, root, run, run_within, succeeds};

/// Cortex-M4F: the board.
const M4F: &str = "thumbv7em-none-eabihf";
/// Cortex-M0+: no FPU, no hardware division.
const M0: &str = "thumbv6m-none-eabi";
/// Cortex-M33 with its FPU: the Pico 2.
const M33: &str = "thumbv8m.main-none-eabihf";
const TARGETS: [&str; 3] = [M4F, M0, M33];

/// What is built for a target.
pub struct Build {
    target: &'static str,
    packages: &'static [&'static str],
    arguments: &'static [&'static str],
    profile: &'static str,
}

/// What is flashed.
const FLASH: &str = "flash";
/// Optimised for speed.
const RELEASE: &str = "release";

/// What must build, with the title of its step. In the images' profile, so that what they need is built once.
pub const BUILDS: [(&str, &Build); 2] = [
    (
        "build for Cortex-M4F (core, firmware)",
        &Build { target: M4F, packages: &["breakaway-core", "breakaway-firmware"], arguments: &[], profile: FLASH },
    ),
    (
        "build for Cortex-M0+ (core, firmware)",
        &Build { target: M0, packages: &["breakaway-core", "breakaway-firmware"], arguments: &[], profile: FLASH },
    ),
];

/// The virtual board's image. In the profile of the images that are flashed, so that what they need is built once.
pub const IMAGE: Build = Build {
    target: M4F,
    packages: &["breakaway-firmware"],
    arguments: &["--bin", "mps2-an386", "--features", "board-mps2-an386"],
    profile: FLASH,
};
/// The images that measure, built in the profile that is flashed. One is the tick on the virtual board, the other the
/// tick alone on a core without an FPU.
pub const BUDGET: Build = Build {
    target: M4F,
    packages: &["breakaway-firmware"],
    arguments: &["--bin", "budget", "--features", "board-mps2-an386"],
    profile: FLASH,
};
/// The tick's parts beside another library's.
pub const PEERS: Build = Build {
    target: M4F,
    packages: &["breakaway-firmware"],
    arguments: &["--bin", "peers", "--features", "peers"],
    profile: RELEASE,
};
/// See [`BUDGET`].
pub const INTEGER_TICK: Build = Build {
    target: M0,
    packages: &["breakaway-firmware"],
    arguments: &["--bin", "integer-tick", "--features", "integer-tick"],
    profile: FLASH,
};

/// The flashable board's image, and its tick alone, which links only if it cannot panic.
pub const NUCLEO: Build = Build {
    target: M4F,
    packages: &["breakaway-firmware"],
    arguments: &["--bin", "nucleo-g474re", "--bin", "nucleo-g474re-tick", "--features", "board-nucleo-g474re"],
    profile: FLASH,
};

/// The Pico 2's image, and its tick alone, which links only if it cannot panic.
pub const PICO2: Build = Build {
    target: M33,
    packages: &["breakaway-firmware"],
    arguments: &["--bin", "pico2", "--bin", "pico2-tick", "--features", "board-pico2"],
    profile: FLASH,
};

/// Builds with a toolchain that [`install`] has found.
pub fn build(toolchain: Toolchain, build: &Build) -> Result<()> {
    let mut command = match toolchain {
        Toolchain::Active => cargo(["build"]),
        Toolchain::Debian => rust::cargo_build(build.target),
    };
    command.args(["--target", build.target]);
    for package in build.packages {
        command.args(["--package", package]);
    }
    command.args(["--profile", build.profile]);
    run(command.args(build.arguments))
}

/// Where a [`Build`] of a binary puts it.
pub fn binary(build: &Build, name: &str) -> PathBuf {
    target_folder().join(build.target).join(build.profile).join(name)
}

/// Cargo's target folder.
pub fn target_folder() -> PathBuf {
    // Relative to where cargo is started, which is the root here.
    root().join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// Which toolchain builds for the targets.
#[derive(Clone, Copy)]
pub enum Toolchain {
    /// The one that runs this program; it has the targets.
    Active,
    /// Debian's, with `-Z build-std`.
    Debian,
}

/// Sees to it that a toolchain for all targets is there.
pub fn install() -> Result<Toolchain> {
    if TARGETS.into_iter().all(installed) {
        return Ok(Toolchain::Active);
    }
    let by_rustup = rustup_add(&TARGETS);
    match by_rustup {
        Ok(()) if TARGETS.into_iter().all(installed) => return Ok(Toolchain::Active),
        Ok(()) => println!("rustup has another toolchain than {}", rustc().get_program().display()),
        Err(error) => println!("{error:#}"),
    }
    rust::unpack().with_context(|| {
        let packages = rust::PACKAGES.join(" ");
        format!("install the targets by `rustup target add {}`, or on Debian {packages}", TARGETS.join(" "))
    })?;
    Ok(Toolchain::Debian)
}

/// What a browser runs.
pub const WASM: &str = "wasm32-unknown-unknown";

/// Sees to it that the active toolchain builds for a browser.
pub fn install_wasm() -> Result<()> {
    if !installed(WASM) {
        rustup_add(&[WASM])?;
    }
    if installed(WASM) { Ok(()) } else { bail!("install the target by `rustup target add {WASM}`") }
}

fn rustup_add(targets: &[&str]) -> Result<()> {
    if !succeeds(Command::new("rustup").arg("--version")) {
        bail!("no rustup here");
    }
    // rustup fails at once where it is refused; where packets are merely lost it would wait long. The packages
    // being there already says that this machine has been refused before.
    let limit = if rust::is_there() { 20 } else { 180 };
    let mut command = Command::new("rustup");
    run_within(command.args(["target", "add"]).args(targets), Duration::from_secs(limit))
}

fn rustc() -> Command {
    Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()))
}

/// Whether the active toolchain has the standard library of a target.
fn installed(target: &str) -> bool {
    answer(rustc().args(["--print", "target-libdir", "--target", target]))
        .is_some_and(|folder| Path::new(&folder).is_dir())
}

/// The linker that rustup's toolchain brings.
pub fn bundled_linker() -> Option<PathBuf> {
    let libraries = answer(rustc().args(["--print", "target-libdir"]))?;
    let linker = Path::new(&libraries).with_file_name("bin").join("rust-lld");
    linker.is_file().then_some(linker)
}
