//! The QEMU that runs the virtual board: installed, or unpacked from Debian's packages.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::cross::target_folder;
use crate::debian::Tree;
use crate::run::answer;

const PROGRAM: &str = "qemu-system-arm";
/// The board that the image is built for; it is what a QEMU must have, and versions before 5.1 do not have it.
const MACHINE: &str = "mps2-an386";
/// Names another program; the host's tools read it too.
const VARIABLE: &str = "BREAKAWAY_QEMU";
/// What to do where there is neither a QEMU nor apt-get.
const INSTALL: &str = "install QEMU 5.1 or later: the package is qemu-system-arm on Debian, Ubuntu, Fedora and Arch \
    (apt-get, dnf or pacman), qemu on macOS (brew) and SoftwareFreedomConservancy.QEMU on Windows (winget)";

/// The QEMU to use: the one that `BREAKAWAY_QEMU` names, else the one installed if it has the board, else one unpacked from
/// Debian's packages.
///
/// # Errors
/// There is none; with what to install.
pub fn program() -> Result<PathBuf> {
    if let Some(named) = std::env::var_os(VARIABLE) {
        if !has_machine(&named) {
            bail!("{VARIABLE} names {}, which is no QEMU with the board {MACHINE}", Path::new(&named).display());
        }
        return Ok(named.into());
    }
    let script = script();
    if has_machine(PROGRAM) {
        // The host's tools would go on using it.
        if script.exists() {
            fs::remove_file(&script).with_context(|| script.display().to_string())?;
        }
        return Ok(PROGRAM.into());
    }
    if !has_machine(&script) {
        unpack(&script).with_context(|| format!("no {PROGRAM} with the board {MACHINE}: {INSTALL}"))?;
    }
    Ok(script)
}

/// Beside the image, where the host's tools look for it.
fn script() -> PathBuf {
    target_folder().join("images").join(PROGRAM)
}

/// Makes the script; the tree may be there, from before the rest of the target folder was emptied.
fn unpack(script: &Path) -> Result<()> {
    let tree = Tree::named("qemu");
    let write = || {
        let data = tree.path("usr/share/qemu").display().to_string();
        tree.script(&format!("usr/bin/{PROGRAM}"), &["-L", &data], script)
    };
    if tree.is_there() {
        write()?;
    }
    if !has_machine(script) {
        tree.unpack(&[PROGRAM])?;
        write()?;
    }
    if !has_machine(script) {
        bail!("the {PROGRAM} of Debian's packages does not start, or is too old");
    }
    Ok(())
}

/// Whether a program starts and lists the board.
fn has_machine(program: impl AsRef<OsStr>) -> bool {
    let machines = answer(Command::new(program).args(["-machine", "help"]));
    machines.is_some_and(|list| list.lines().any(|line| line.split_whitespace().next() == Some(MACHINE)))
}
