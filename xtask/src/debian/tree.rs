//! Packages that are unpacked beside each other.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result, ensure};

use super::apt::Apt;
use crate::cross::target_folder;

/// Levels of folders in which libraries are sought. PulseAudio keeps a private one in a folder of its own, below that of
/// the machine's kind.
const LEVELS: u32 = 2;
/// Held by whoever uses apt-get's one folder: two threads may unpack at once.
static APT: Mutex<()> = Mutex::new(());

/// A tree of unpacked packages, `debian/NAME` in the target folder.
pub struct Tree {
    pub(super) root: PathBuf,
    /// Whether it needs nothing of the system.
    pub(super) whole: bool,
}

impl Tree {
    /// The tree of this name, whether it is there or not.
    pub fn named(name: &str) -> Self {
        Self { root: folder().join(name), whole: false }
    }

    /// As [`Tree::named`], but with all that its packages need, the C library too.
    pub fn whole(name: &str) -> Self {
        Self { whole: true, ..Self::named(name) }
    }

    /// Whether it has been unpacked.
    pub fn is_there(&self) -> bool {
        self.root.is_dir()
    }

    /// Downloads the packages with what they need and, unless the tree is [whole](Tree::whole), the system lacks. They
    /// are unpacked in place of what was there.
    ///
    /// # Errors
    /// See [`Apt::new`] and [`Apt::download`]; a package that dpkg-deb cannot read.
    pub fn unpack(&self, packages: &[&str]) -> Result<()> {
        let _held = APT.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = folder().join("apt");
        let apt = Apt::new(&folder)?;
        let files = if self.whole { apt.download_whole(packages)? } else { apt.download(packages)? };
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
        remove(&folder)
    }

    /// A file or folder of the tree.
    pub fn path(&self, inside: &str) -> PathBuf {
        self.root.join(inside)
    }

    /// The folders with shared libraries: `lib` and `usr/lib`, and [`LEVELS`] below.
    pub(super) fn libraries(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        for folder in ["usr/lib", "lib"] {
            with_libraries(&self.path(folder), LEVELS, &mut found);
        }
        found
    }

    /// The loader of the C library, if that is in the tree. In lib64 there may be a link that leads to the system's.
    pub(super) fn loader(&self) -> Option<PathBuf> {
        let mut files = self.libraries().into_iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
        let found = files.find(|file| file.file_name().to_string_lossy().starts_with("ld-linux"))?;
        Some(found.path())
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
        let found = Tree { root: root.clone(), whole: false }.libraries();
        fs::remove_dir_all(root).unwrap();
        assert_eq!(found, folders);
    }

    /// The link in lib64 leads out of the tree, to the system's loader.
    #[cfg(unix)]
    #[test]
    fn the_loader_is_that_of_the_tree() {
        let root = std::env::temp_dir().join(format!("breakaway-loader-{}", std::process::id()));
        let loader = root.join("lib/x86_64-linux-gnu/ld-linux-x86-64.so.2");
        fs::create_dir_all(loader.parent().unwrap()).unwrap();
        fs::create_dir_all(root.join("lib64")).unwrap();
        let link = root.join("lib64/ld-linux-x86-64.so.2");
        std::os::unix::fs::symlink("/lib/x86_64-linux-gnu/ld-linux-x86-64.so.2", link).unwrap();
        let tree = Tree { root: root.clone(), whole: true };
        fs::write(loader.with_file_name("libc.so.6"), "").unwrap();
        let without = tree.loader();
        fs::write(&loader, "").unwrap();
        let found = tree.loader();
        fs::remove_dir_all(root).unwrap();
        assert_eq!((without, found), (None, Some(loader)));
    }
}
