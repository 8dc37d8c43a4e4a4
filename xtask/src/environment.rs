//! Environments of Python in the target folder, and which Python makes them: the installed one, else Debian's.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Duration;

use anyhow::{Context, Result, anyhow};

use crate::debian::python::{self, Unpacked};
use crate::run::{run, run_within, succeeds};

const PROGRAM: &str = "python3";
/// Succeeds in a Python that makes environments, and reaches PyPI.
const MAKES_ENVIRONMENTS: &str = "import ssl, sys, venv; sys.exit(sys.version_info < (3, 10))";
/// Succeeds in a Python that finds its pip. Debian's does with the package python3-venv.
const HAS_PIP: &str = "import ensurepip";
/// What to do where there is neither such a Python nor apt-get.
const INSTALL: &str = "install Python 3.10 or later with venv and pip: the package is python3-venv on Debian and Ubuntu \
    (apt-get), python3 on Fedora (dnf), and python on Arch (pacman) and macOS (brew)";
/// The largest packages take a minute to fetch; what takes ten has hung.
const LIMIT: Duration = Duration::from_secs(600);

/// The Python that makes environments.
enum Python {
    /// It has a pip for them.
    Installed,
    /// It gets the pip of its packages.
    Unpacked(Unpacked),
}

/// A Python with what the file of requirements pins.
///
/// # Errors
/// No Python, or no PyPI; with what to install.
pub fn environment(folder: &Path, requirements: &Path) -> Result<PathBuf> {
    let wanted = fs::read_to_string(requirements).with_context(|| requirements.display().to_string())?;
    let (python, installed) = (folder.join("bin/python"), folder.join("installed.txt"));
    let is_there = fs::read_to_string(&installed).is_ok_and(|installed| installed == wanted);
    // The Python that made it may be gone.
    if is_there && succeeds(Command::new(&python).arg("--version")) {
        return Ok(python);
    }
    make(folder, &python)?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"]).arg(requirements);
    run_within(&mut install, LIMIT).context("this needs PyPI")?;
    fs::write(&installed, wanted)?;
    Ok(python)
}

/// Makes an environment with nothing but pip, in place of what was there.
fn make(folder: &Path, python: &Path) -> Result<()> {
    match found()? {
        Python::Installed => run(Command::new(PROGRAM).args(["-m", "venv", "--clear"]).arg(folder)),
        Python::Unpacked(unpacked) => {
            run(Command::new(&unpacked.program).args(["-m", "venv", "--clear", "--without-pip"]).arg(folder))?;
            python::install_pip(python, &unpacked.pip)
        }
    }
}

/// The Python to use. It is sought once: who asks meanwhile waits for it, and who asks later hears the same.
fn found() -> Result<&'static Python> {
    static FOUND: OnceLock<Result<Python, String>> = OnceLock::new();
    let found = FOUND.get_or_init(|| find().map_err(|error| format!("{error:#}")));
    found.as_ref().map_err(|said| anyhow!("{said}"))
}

/// The installed one if it will do, else one unpacked from Debian's packages.
fn find() -> Result<Python> {
    let installed = Path::new(PROGRAM);
    if makes_environments(installed) && succeeds(Command::new(installed).args(["-c", HAS_PIP])) {
        return Ok(Python::Installed);
    }
    let unpacked = python::unpack(makes_environments);
    unpacked.map(Python::Unpacked).with_context(|| format!("no Python that will do: {INSTALL}"))
}

fn makes_environments(program: &Path) -> bool {
    succeeds(Command::new(program).args(["-c", MAKES_ENVIRONMENTS]))
}
