//! The memory layout of each image, and the build hash.

use std::path::Path;
use std::process::Command;

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let bare = std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if bare && std::env::var_os("CARGO_FEATURE_BOARD_MPS2_AN386").is_some() {
        for bin in ["mps2-an386", "budget", "peers"] {
            println!("cargo:rustc-link-arg-bin={bin}=-T{folder}/src/board/mps2_an386/link.x");
        }
        println!("cargo:rerun-if-changed=src/board/mps2_an386/link.x");
    }
    if bare && std::env::var_os("CARGO_FEATURE_BOARD_NUCLEO_G474RE").is_some() {
        // cortex-m-rt's script, which includes memory.x of the root.
        println!("cargo:rustc-link-search={folder}/..");
        for script in ["link.x", "defmt.x"] {
            println!("cargo:rustc-link-arg-bin=nucleo-g474re=-T{script}");
        }
        println!("cargo:rustc-link-arg-bin=nucleo-g474re-tick=--entry=nucleo_tick");
        println!("cargo:rerun-if-changed=../memory.x");
    }
    if bare && std::env::var_os("CARGO_FEATURE_BOARD_PICO2").is_some() {
        println!("cargo:rustc-link-arg-bin=pico2=-T{folder}/src/board/pico2/link.x");
        println!("cargo:rustc-link-arg-bin=pico2-tick=--entry=pico2_tick");
        println!("cargo:rerun-if-changed=src/board/pico2/link.x");
    }
    if bare && std::env::var_os("CARGO_FEATURE_INTEGER_TICK").is_some() {
        println!("cargo:rustc-link-arg-bin=integer-tick=--entry=integer_tick");
    }
    let hash = Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).current_dir(&folder).output();
    let hash = hash.ok().filter(|output| output.status.success());
    let hash = hash.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    println!("cargo:rustc-env=BREAKAWAY_BUILD={}", hash.unwrap_or_else(|| "unknown".into()));
    // A linked worktree's HEAD is elsewhere; there the hash is that of the last build that had another reason.
    let head = Path::new(&folder).join("../.git/HEAD");
    if head.is_file() {
        println!("cargo:rerun-if-changed={}", head.display());
    }
    println!("cargo:rerun-if-changed=build.rs");
}
