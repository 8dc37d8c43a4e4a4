//! The Python package: its wheel is built, installed in an environment of its own, and tested there by pytest.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, anyhow, ensure};

use crate::cross::target_folder;
use crate::environment::environment;
use crate::lint::linted;
use crate::report::Tests;
use crate::run::{cargo, once, root, run, run_counting, run_within};

/// A wheel that is here takes a second to install; what takes five minutes has hung.
const INSTALL: Duration = Duration::from_secs(300);

/// The two Pythons.
pub struct Pythons {
    /// Has maturin, which builds the wheel.
    builder: PathBuf,
    /// Has numpy and pytest, and the wheel once it is installed.
    tester: PathBuf,
}

/// Makes them in the target folder.
///
/// # Errors
/// No Python, or no PyPI; with what to install.
pub fn environments() -> Result<Pythons> {
    let of =
        |name: &str, packages: &str| environment(&target_folder().join(name), &root().join("python").join(packages));
    Ok(Pythons {
        builder: of("maturin-venv", "requirements.txt")?,
        tester: of("python-venv", "tests/requirements.txt")?,
    })
}

/// Builds the wheel in the profile of the tests, whose crates it shares.
///
/// # Errors
/// It does not compile, or there is not one wheel.
pub fn wheel(pythons: &Pythons) -> Result<PathBuf> {
    let folder = target_folder().join("wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    let mut build = Command::new(pythons.builder.with_file_name("maturin"));
    build.args(["build", "--profile", "dev", "--manifest-path"]).arg(root().join("python/Cargo.toml"));
    build.arg("--out").arg(&folder).arg("--interpreter").arg(&pythons.tester).current_dir(root());
    build.env("CARGO", root().join("xtask/src/python/cargo.sh"));
    build.env("BREAKAWAY_CARGO", cargo([""; 0]).get_program());
    linted(&mut build);
    if env::var_os("CI").is_some() {
        once(&mut build);
    }
    run(&mut build)?;
    let mut wheels: Vec<PathBuf> = fs::read_dir(&folder)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    ensure!(wheels.len() == 1, "{}: one wheel was expected, and there are {}", folder.display(), wheels.len());
    Ok(wheels.remove(0))
}

/// Installs a wheel, without what it depends on: that is there, and pinned.
///
/// # Errors
/// What pip reports.
pub fn install(python: &Path, wheel: &Path) -> Result<()> {
    let mut install = Command::new(python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--force-reinstall", "--no-deps"]);
    run_within(install.arg(wheel), INSTALL)
}

/// Checks the installed package's types, and its stubs against the extension module.
///
/// # Errors
/// What mypy finds.
fn types(python: &Path, folder: &Path) -> Result<()> {
    for arguments in [&["mypy", "--strict", "--package", "breakaway"][..], &["mypy.stubtest", "breakaway._native"]] {
        run(Command::new(python).arg("-m").args(arguments).current_dir(folder))?;
    }
    Ok(())
}

/// Runs the tests of the installed wheel, apart from the package's sources.
pub fn test(pythons: &Pythons) -> (Tests, Result<()>) {
    let ready = || {
        install(&pythons.tester, &wheel(pythons)?)?;
        let folder = target_folder().join("python-tests");
        fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        Ok(folder)
    };
    let folder = match ready() {
        Ok(folder) => folder,
        Err(error) => return (Tests::default(), Err(error)),
    };
    let mut tests = Command::new(&pythons.tester);
    tests.args(["-m", "pytest", "-p", "no:cacheprovider", "--color", "no"]);
    tests.arg(root().join("python/tests")).current_dir(&folder).env("PYTHONDONTWRITEBYTECODE", "1");
    tests.env("BREAKAWAY_COMMAND", target_folder().join("debug").join(format!("breakaway{}", env::consts::EXE_SUFFIX)));
    thread::scope(|scope| {
        // mypy uses one processor, and pytest the other.
        let types = scope.spawn(|| types(&pythons.tester, &folder));
        let (counted, result) = run_counting(&mut tests);
        let types = types.join().unwrap_or_else(|_| Err(anyhow!("who waits for mypy has panicked")));
        (counted, result.and(types))
    })
}

/// `cargo xtask python-test`.
///
/// # Errors
/// No Python, a wheel that does not build, or a test that fails.
pub fn all() -> Result<()> {
    let (tests, result) = test(&environments()?);
    println!("{} passed, {} failed", tests.counts.passed, tests.counts.failed);
    result
}
