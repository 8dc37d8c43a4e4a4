//! `cargo xtask export-test`: exported models, run by MuJoCo and read by parsers from PyPI.

use std::path::PathBuf;

use anyhow::Result;

use crate::cross::target_folder;
use crate::environment::environment;
use crate::run::{cargo, root, run};

/// The Python that has them, in the target folder, where the tests look for it.
///
/// # Errors
/// No Python, or no PyPI; with what to install.
pub fn python() -> Result<PathBuf> {
    environment(&target_folder().join("mujoco-venv"), &root().join("tests/mujoco/requirements.txt"))
}

/// Sees to it that there is one, and runs the tests.
pub fn test() -> Result<()> {
    python()?;
    run(&mut cargo(["test", "--package", "breakaway-tests", "--test", "export"]))
}
