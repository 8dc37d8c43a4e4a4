//! `cargo xtask site`: the documentation as a site, by mdBook. The order of the pages is that of docs/SUMMARY.md.

use anyhow::Result;

use crate::cross::target_folder;
use crate::run::{cargo, root, run};

/// Builds it into the target folder. mdBook is a library of a program of its own, which is compiled when it is asked for.
pub fn build() -> Result<()> {
    let manifest = root().join("xtask/site/Cargo.toml");
    let mut command = cargo(["run", "--quiet", "--locked", "--manifest-path"]);
    let site = target_folder().join("site");
    command.arg(manifest).arg("--target-dir").arg(target_folder().join("site-tool"));
    run(command.arg("--").arg(root()).arg(&site))?;
    println!("{}", site.join("index.html").display());
    Ok(())
}
