//! `cargo xtask notices`: the licences of the third-party code in what is handed out, as a file beside each of it.
//!
//! The texts are those of the packages' own sources, and none of them is committed. Of the tools of the kind `cargo about`
//! 0.9.3 was tried: told to use no network, it had written nothing after ten minutes.

mod font;
mod musl;
mod package;
mod texts;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::cross::{WASM, target_folder};
use crate::run::{answer, cargo, root};
use package::Package;
use texts::Texts;

/// The name of the file, wherever it lies.
pub const FILE: &str = "THIRD-PARTY.txt";

/// What is handed out.
#[derive(Clone, Copy, Debug)]
pub enum Product {
    /// The program, in its archives and in the container.
    Command,
    /// The wheels.
    Python,
    /// The page for the browser.
    Page,
}

impl Product {
    /// Its crate, and the target whose dependencies count. Those of any system count where the product is made for several.
    const fn built(self) -> (&'static str, &'static str) {
        match self {
            Self::Command => ("breakaway", "all"),
            Self::Python => ("breakaway-python", "all"),
            Self::Page => ("breakaway-web", WASM),
        }
    }

    /// Where its file is written. maturin takes licences from the folder of the package alone.
    fn folder(self) -> PathBuf {
        match self {
            Self::Command => target_folder().join("notices"),
            Self::Python => root().join("python"),
            Self::Page => crate::web::folder(),
        }
    }
}

/// Writes the files of the products that are built from the sources as they are. The page has its own from [`crate::web`].
///
/// # Errors
/// As [`of`].
pub fn all() -> Result<()> {
    for product in [Product::Command, Product::Python] {
        println!("{}", write(product)?.display());
    }
    Ok(())
}

/// Writes the file of a product.
///
/// # Errors
/// As [`of`]; or the file cannot be written.
pub fn write(product: Product) -> Result<PathBuf> {
    let folder = product.folder();
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let path = folder.join(FILE);
    fs::write(&path, of(product)?).with_context(|| path.display().to_string())?;
    Ok(path)
}

/// The text of a product.
///
/// # Errors
/// A package has no licence text, or bundles code whose licence is not known here; with its name.
pub fn of(product: Product) -> Result<String> {
    let mut texts = Texts::default();
    let packages = shipped(product)?;
    for package in &packages {
        for text in package.texts()? {
            texts.add(&package.title(), &text);
        }
        for (title, text) in package.bundled()? {
            texts.add(&title, &text);
        }
    }
    if let Product::Command = product {
        let libm = packages.iter().find(|package| package.is_called("libm")).context("libm is no longer among them")?;
        texts.add(musl::TITLE, &musl::notice(&libm.texts()?.join("\n"))?);
    }
    texts.add("the Rust standard library (MIT OR Apache-2.0)", &standard_library()?);
    Ok(texts.to_string())
}

/// The packages that are compiled into a product, without our own. What only runs while it is built is left out.
fn shipped(product: Product) -> Result<Vec<Package>> {
    let (name, target) = product.built();
    let tree = ["tree", "--locked", "--package", name, "--target", target, "--edges", "normal,no-proc-macro"];
    let list = answer(cargo(tree).args(["--prefix", "none", "--format", "{p}"])).context("cargo tree failed")?;
    let wanted: BTreeSet<(String, String)> = list.lines().filter_map(named).collect();
    let metadata = answer(&mut cargo(["metadata", "--locked", "--format-version", "1"])).context("cargo metadata")?;
    let known = package::all(&metadata)?;
    let found: Vec<Package> = known.into_iter().filter(|package| wanted.contains(&package.version_of())).collect();
    ensure!(found.len() == wanted.len(), "{} packages of {} are known", found.len(), wanted.len());
    Ok(found.into_iter().filter(|package| !package.is_ours()).collect())
}

/// Name and version of a line such as `csv v1.4.0`.
fn named(line: &str) -> Option<(String, String)> {
    let mut words = line.split_whitespace();
    Some((words.next()?.to_owned(), words.next()?.strip_prefix('v')?.to_owned()))
}

/// What the standard library and the crates in it ask for: a page of the toolchain, as text.
fn standard_library() -> Result<String> {
    let sysroot = answer(Command::new("rustc").args(["--print", "sysroot"]).current_dir(root())).context("rustc")?;
    let path = Path::new(&sysroot).join("share/doc/rust/COPYRIGHT-library.html");
    if !path.exists() {
        bail!("{}: a toolchain of rustup has this file; set it up by `rustup default stable`", path.display());
    }
    Ok(texts::of_page(&fs::read_to_string(&path).with_context(|| path.display().to_string())?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every package has a text, or the function fails. Of those whose licence asks for its notice, words of it are there.
    #[test]
    fn whatever_is_handed_out_has_its_notices() {
        let command = of(Product::Command).unwrap();
        let asked = [
            "tiny-skia 0",
            "Copyright (c) 2011 Google Inc.",
            "zstd in zstd-sys",
            "Copyright (c) Meta Platforms, Inc.",
            "SQLite in libsqlite3-sys",
            "Bitstream Vera Fonts Copyright",
            "serialport 4",
            "Mozilla Public License",
            "the Rust standard library",
            "the C library musl",
            "Copyright © 2005-2020 Rich Felker, et al.\n\nPermission is hereby granted",
            "Sun Microsystems",
        ];
        for words in asked {
            assert!(command.contains(words), "{words}");
        }
        assert!(!command.contains("breakaway-core") && !command.contains("GNU GENERAL PUBLIC LICENSE"));
        let python = of(Product::Python).unwrap();
        assert!(python.contains("numpy 0") && python.contains("pyo3 0") && !python.contains(musl::TITLE));
        let page = of(Product::Page).unwrap();
        assert!(page.contains("wasm-bindgen 0") && page.contains("nalgebra 0") && !page.contains("zstd-sys"));
    }

    #[test]
    fn a_line_of_the_tree_has_a_name_and_a_version() {
        assert_eq!(named("csv v1.4.0"), Some(("csv".to_owned(), "1.4.0".to_owned())));
        assert_eq!(named(""), None);
    }
}
