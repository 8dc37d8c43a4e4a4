//! `cargo xtask web` and `web-test`: the page that identifies and discovers in a browser, `web` in the target folder.

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};

use crate::chromium;
use crate::cross::{self, target_folder};
use crate::notices::{self, Product};
use crate::report::Report;
use crate::run::{cargo, root, run};

/// Its profile in Cargo.toml.
const PROFILE: &str = "wasm";
/// What is not made, but written by hand.
const WRITTEN: [&str; 4] = ["index.html", "page.js", "style.css", "worker.js"];

/// Compiles what the browser runs; its file.
fn compile() -> Result<PathBuf> {
    cross::install_wasm()?;
    run(&mut cargo(["build", "--package", "breakaway-web", "--target", cross::WASM, "--profile", PROFILE]))?;
    Ok(target_folder().join(cross::WASM).join(PROFILE).join("breakaway_web.wasm"))
}

/// Builds the page, and says where it is.
pub fn build() -> Result<()> {
    println!("{}", page()?.display());
    Ok(())
}

/// Builds the page; its file.
pub fn page() -> Result<PathBuf> {
    let wasm = compile()?;
    let folder = folder();
    if folder.exists() {
        // What is left of an earlier build would be handed out with it.
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let mut bind = cargo(["run", "--quiet", "--locked", "--manifest-path", "web/bind/Cargo.toml", "--target-dir"]);
    // A workspace of its own, so that nothing else waits for it to be built.
    run(bind.arg(target_folder().join("bind")).arg("--").arg(&wasm).arg(&folder))?;
    for name in WRITTEN {
        let from = root().join("web/page").join(name);
        fs::copy(&from, folder.join(name)).with_context(|| from.display().to_string())?;
    }
    notices::write(Product::Page)?;
    Ok(folder.join("index.html"))
}

/// Builds the page and finds a Chromium for its tests. Without the target or a browser the tests are not run, but in CI that
/// is an error.
///
/// # Errors
/// The page does not build; in CI, what is missing.
pub fn prepare(report: &mut Report) -> Result<bool> {
    let needed = std::env::var_os("CI").is_some();
    match cross::install_wasm() {
        Err(error) if !needed => {
            report.not_run(format!("page for the browser: {error:#}"));
            return Ok(false);
        }
        // In CI this says what is missing.
        _ => report.check("page for the browser", build)?,
    }
    let mut found = None;
    report.check("Chromium", || {
        found = Some(chromium::program());
        match &found {
            Some(Err(error)) if needed => bail!("{error:#}"),
            _ => Ok(()),
        }
    })?;
    if let Some(Err(error)) = &found {
        report.not_run(format!("the page in a browser: {error:#}"));
    }
    Ok(matches!(found, Some(Ok(_))))
}

/// Builds the page, and tries it in a headless Chromium.
pub fn test() -> Result<()> {
    build()?;
    chromium::program()?;
    run(&mut cargo(["test", "--package", "breakaway-web", "--test", "browser"]))
}

/// Where the page is.
pub fn folder() -> PathBuf {
    target_folder().join("web")
}
