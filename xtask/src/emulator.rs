//! `cargo xtask emulator`: the NUCLEO-G474RE's image on models of its registers, and the processor that executes it.

use std::env::consts::DLL_SUFFIX;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::cross::{self, Toolchain, target_folder};
use crate::environment::environment;
use crate::run::{cargo, root, run};

/// Names another library; the tests read it too.
const VARIABLE: &str = "BREAKAWAY_UNICORN";
/// The package's folder of libraries, below the environment.
const LIBRARIES: &str = "site-packages/unicorn/lib";
/// The board's image, as the tests look for it.
const IMAGE: &str = "nucleo-g474re.elf";

/// Builds the image, fetches Unicorn, and runs the tests.
pub fn all() -> Result<()> {
    library()?;
    image(cross::install()?)?;
    run(&mut cargo(["test", "--package", "breakaway-tests", "--test", "emulator"]))
}

/// Builds the image that is flashed and puts it where the tests look for it.
pub fn image(toolchain: Toolchain) -> Result<()> {
    cross::build(toolchain, &cross::NUCLEO)?;
    put(&cross::binary(&cross::NUCLEO, "nucleo-g474re"), IMAGE)
}

/// Sees to it that there is a Unicorn: the library that `BREAKAWAY_UNICORN` names, else the one of the package from PyPI.
///
/// # Errors
/// There is none; with what to install.
pub fn library() -> Result<()> {
    if let Some(named) = std::env::var_os(VARIABLE).map(PathBuf::from) {
        if !named.is_file() {
            bail!("{VARIABLE} names {}, which is no file", named.display());
        }
        return Ok(());
    }
    let folder = target_folder().join("unicorn-venv");
    environment(&folder, &root().join("xtask/emulator-requirements.txt"))
        .with_context(|| format!("no Unicorn: `pip download unicorn`, and name its library by {VARIABLE}"))?;
    let found = find(&folder.join("lib")).with_context(|| format!("{}: no Unicorn in it", folder.display()))?;
    put(&found, &format!("libunicorn{DLL_SUFFIX}"))
}

/// The library below `lib/pythonX.Y/` of the environment.
fn find(folder: &Path) -> Option<PathBuf> {
    let pythons = fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let libraries = pythons.filter_map(|python| fs::read_dir(python.path().join(LIBRARIES)).ok());
    let files = libraries.flatten().filter_map(Result::ok).map(|file| file.path());
    let mut files = files.filter(|file| file.extension().is_none_or(|extension| extension != "a"));
    files.find(|file| file.file_name().is_some_and(|name| name.to_string_lossy().contains(DLL_SUFFIX)))
}

/// Copies a file to `images/` of the target folder: beside, then renamed, as a test may be starting from it.
fn put(from: &Path, name: &str) -> Result<()> {
    let to = target_folder().join("images").join(name);
    let beside = to.with_extension("new");
    fs::create_dir_all(to.parent().unwrap_or(&to)).with_context(|| to.display().to_string())?;
    fs::copy(from, &beside).with_context(|| from.display().to_string())?;
    fs::rename(&beside, &to).with_context(|| to.display().to_string())?;
    println!("{}", to.display());
    Ok(())
}
