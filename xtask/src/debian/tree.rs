//! Packages that are unpacked beside each other, and scripts that start their programs where they are.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use super::apt::Apt;
use crate::cross::target_folder;

/// Levels of folders in which libraries are sought. PulseAudio keeps a private one in a folder of its own, below that of
/// the machine's kind.
const LEVELS: u32 = 2;

/// A tree of unpacked packages, `debian/NAME` in the target folder.
pub struct Tree {
    root: PathBuf,
}

impl Tree {
    /// The tree of this name, whether it is there or not.
    pub fn named(name: &str) -> Self {
        Self { root: folder().join(name) }
    }

    /// Whether it has been unpacked.
    pub fn is_there(&self) -> bool {
        self.root.is_dir()
    }

    /// Downloads the packages with what they need and the system lacks, and unpacks them in place of what was there.
    ///
    /// # Errors
    /// See [`Apt::new`] and [`Apt::download`]; a package that dpkg-deb cannot read.
    pub fn unpack(&self, packages: &[&str]) -> Result<()> {
        let apt = folder().join("apt");
        let files = Apt::new(&apt)?.download(packages)?;
        // Beside, then renamed: a tree that is there is whole.
        let beside = self.root.with_extension("new");
        remove(&beside)?;
        fs::create_dir_all(&beside)?;
        println!("unpacking {} packages into {}", files.len(), self.root.display());
        for file in files {
            let output = Command::new("dpkg-deb").arg("--extract").arg(&file).arg(&beside).output()?;
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            ensure!(output.status.success(), "dpkg-deb --extract {}: {}", file.display(), said.trim());
        }
        remove(&self.root)?;
        fs::rename(&beside, &self.root)?;
        remove(&apt)
    }

    /// Writes a script that starts a program of the tree with its libraries.
    ///
    /// # Errors
    /// The script cannot be written.
    pub fn script(&self, program: &str, arguments: &[&str], at: &Path) -> Result<()> {
        let mut text =
            format!("#!/bin/sh\n# Written by `cargo xtask`: {program} of Debian's packages, not installed.\n");
        let libraries: Vec<String> = self.libraries().iter().map(|folder| folder.display().to_string()).collect();
        let libraries = quoted(&libraries.join(":"));
        let mut line = if let Some(loader) = self.loader() {
            // The C library of the tree goes with the loader of the tree alone.
            format!("exec {} --library-path {libraries}", quoted(&loader.display().to_string()))
        } else {
            writeln!(text, "export LD_LIBRARY_PATH={libraries}${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}")?;
            "exec".to_owned()
        };
        for word in [self.path(program).display().to_string().as_str()].iter().chain(arguments) {
            write!(line, " {}", quoted(word))?;
        }
        writeln!(text, "{line} \"$@\"")?;
        if let Some(folder) = at.parent() {
            fs::create_dir_all(folder)?;
        }
        // Beside, then renamed: it may be running.
        let beside = at.with_extension("new");
        fs::write(&beside, text).with_context(|| beside.display().to_string())?;
        executable(&beside)?;
        fs::rename(&beside, at).with_context(|| at.display().to_string())
    }

    /// A file or folder of the tree.
    pub fn path(&self, inside: &str) -> PathBuf {
        self.root.join(inside)
    }

    /// The folders with shared libraries: `lib` and `usr/lib`, and [`LEVELS`] below.
    fn libraries(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        for folder in ["usr/lib", "lib"] {
            with_libraries(&self.path(folder), LEVELS, &mut found);
        }
        found
    }

    /// The loader of the C library, if that is in the tree.
    fn loader(&self) -> Option<PathBuf> {
        let folders = ["lib64", "lib", "usr/lib64", "usr/lib"].map(|folder| self.path(folder));
        let mut files = folders.into_iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
        files.find(|file| file.file_name().to_string_lossy().starts_with("ld-linux")).map(|file| file.path())
    }
}

/// Where the trees are.
pub fn folder() -> PathBuf {
    target_folder().join("debian")
}

fn with_libraries(folder: &Path, levels: u32, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let mut entries: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    entries.sort();
    let is_library = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("lib") && name.contains(".so") && !path.is_dir()
    };
    if entries.iter().any(is_library) {
        found.push(folder.to_path_buf());
    }
    for below in entries.iter().filter(|path| levels > 0 && path.is_dir() && !path.is_symlink()) {
        with_libraries(below, levels - 1, found);
    }
}

fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    Ok(())
}

/// As one word of a shell.
fn quoted(word: &str) -> String {
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(unix)]
fn executable(file: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    Ok(fs::set_permissions(file, fs::Permissions::from_mode(0o755))?)
}

#[cfg(not(unix))]
fn executable(_: &Path) -> Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Libraries of the machine's kind, and PulseAudio's private one a folder below. A third folder holds none.
    #[test]
    fn private_libraries_are_found() {
        let root = std::env::temp_dir().join(format!("breakaway-tree-{}", std::process::id()));
        let folders = ["usr/lib/x86_64-linux-gnu", "usr/lib/x86_64-linux-gnu/pulseaudio"].map(|own| root.join(own));
        for folder in &folders {
            fs::create_dir_all(folder).unwrap();
            fs::write(folder.join("libpulse.so.0"), "").unwrap();
        }
        fs::create_dir_all(root.join("usr/lib/empty")).unwrap();
        let found = Tree { root: root.clone() }.libraries();
        fs::remove_dir_all(root).unwrap();
        assert_eq!(found, folders);
    }
}
