//! Debian's Python, for machines that have none, or one without venv or pip. It needs nothing of the system.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::tree::Tree;
use crate::run::run;

/// What brings the interpreter with its library, and pip as the wheel that venv would install.
const PACKAGES: [&str; 2] = ["python3", "python3-pip-whl"];
/// Where the packages have the interpreter.
const INTERPRETER: &str = "usr/bin/python3";
/// The script that starts it. Beside the interpreter it finds its library, and no package has a file of this name.
const SCRIPT: &str = "usr/bin/python";
/// Where the packages have wheels.
const WHEELS: &str = "usr/share/python-wheels";

/// A Python that makes environments, but does not find its pip.
#[derive(Debug)]
pub struct Unpacked {
    /// The script that starts it.
    pub program: PathBuf,
    /// The wheel of pip, which runs from where it is: `python WHEEL/pip`.
    pub pip: PathBuf,
}

/// Unpacks it, unless it is there. `usable` says whether a program is a Python that will do.
///
/// # Errors
/// See [`Tree::unpack`]; the packages hold no such Python.
pub fn unpack(usable: impl Fn(&Path) -> bool) -> Result<Unpacked> {
    let tree = Tree::whole("python");
    let program = tree.path(SCRIPT);
    // The script may be of another place, as the target folder may have been moved.
    let write = || tree.script_as_called(INTERPRETER, &program);
    if tree.is_there() {
        write()?;
    }
    if !usable(&program) {
        tree.unpack(&PACKAGES)?;
        write()?;
    }
    if !usable(&program) {
        bail!("the Python of Debian's packages does not start, or is too old");
    }
    let pip = wheel(&tree.path(WHEELS)).context("no wheel of pip among Debian's packages")?;
    Ok(Unpacked { program, pip })
}

/// Gives pip to an environment that was made without it.
///
/// # Errors
/// What pip reports.
pub fn install_pip(python: &Path, wheel: &Path) -> Result<()> {
    let mut install = Command::new(python);
    install.arg(wheel.join("pip")).args(["install", "--quiet", "--no-index"]).arg(wheel);
    run(&mut install)
}

/// The wheel of pip in a folder.
fn wheel(folder: &Path) -> Option<PathBuf> {
    let files = fs::read_dir(folder).ok()?.filter_map(Result::ok);
    files.map(|file| file.path()).find(|file| is_pip(file))
}

fn is_pip(file: &Path) -> bool {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    name.starts_with("pip-") && name.ends_with(".whl")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside pip the folder may have other wheels, and one whose name begins alike.
    #[test]
    fn the_wheel_of_pip_is_found() {
        let folder = std::env::temp_dir().join(format!("breakaway-wheels-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        for name in ["pipx-1.0-py3-none-any.whl", "setuptools-66.1.1-py3-none-any.whl", "pip-23.0.1.txt"] {
            fs::write(folder.join(name), "").unwrap();
        }
        let without = wheel(&folder);
        let pip = folder.join("pip-23.0.1-py3-none-any.whl");
        fs::write(&pip, "").unwrap();
        let found = wheel(&folder);
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!((without, found), (None, Some(pip)));
    }
}
