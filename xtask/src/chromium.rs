//! The Chromium that tries the page: installed, or unpacked from Debian's packages.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, Result, bail};

use crate::cross::target_folder;
use crate::debian::Tree;
use crate::run::run_within;

/// Names another program; the tests read it too.
const VARIABLE: &str = "BREAKAWAY_CHROMIUM";
/// What it is called where it is installed. The test looks for the same names.
const INSTALLED: [&str; 4] = ["chromium", "google-chrome", "chromium-browser", "chromium-headless-shell"];
/// Debian's package without a window: it needs no desktop's libraries.
const PACKAGE: &str = "chromium-headless-shell";
/// A browser starts in a second; one that takes a minute has hung.
const START: Duration = Duration::from_secs(60);

/// The Chromium to use: the one that `BREAKAWAY_CHROMIUM` names, else an installed one, else one unpacked from Debian's
/// packages.
///
/// # Errors
/// There is none; with what to install.
pub fn program() -> Result<PathBuf> {
    if let Some(named) = std::env::var_os(VARIABLE) {
        if !starts(&named) {
            bail!("{VARIABLE} names {}, which does not start", Path::new(&named).display());
        }
        return Ok(named.into());
    }
    if let Some(installed) = INSTALLED.into_iter().find(|name| starts(name)) {
        return Ok(installed.into());
    }
    // Where the test looks for it.
    let script = target_folder().join("images").join(PACKAGE);
    if !starts(&script) {
        unpack(&script).context("no Chromium: install chromium (apt-get, dnf or pacman) or Google Chrome")?;
    }
    Ok(script)
}

/// Makes the script; the tree may be there, from before the rest of the target folder was emptied.
fn unpack(script: &Path) -> Result<()> {
    let tree = Tree::named("chromium");
    let write = || tree.script(&format!("usr/lib/chromium/{PACKAGE}"), &[], script);
    if tree.is_there() {
        write()?;
    }
    if !starts(script) {
        tree.unpack(&[PACKAGE])?;
        write()?;
    }
    if !starts(script) {
        bail!("the {PACKAGE} of Debian's packages does not start");
    }
    Ok(())
}

/// Whether a program starts and shows an empty page. Its version alone would not tell that its libraries are there.
fn starts(program: impl AsRef<OsStr>) -> bool {
    let flags = ["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom", "about:blank"];
    let mut command = Command::new(program);
    command.args(flags).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    run_within(&mut command, START).is_ok()
}
