//! Scripts that start the programs of a tree where they are.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::tree::Tree;

impl Tree {
    /// Writes a script that starts a program of the tree with its libraries.
    ///
    /// # Errors
    /// The script cannot be written.
    pub fn script(&self, program: &str, arguments: &[&str], at: &Path) -> Result<()> {
        let libraries = joined(&self.libraries());
        let start = if let Some(loader) = self.loader() {
            // The C library of the tree goes with the loader of the tree alone.
            format!("exec {} --library-path {libraries}", path(&loader))
        } else {
            format!("export LD_LIBRARY_PATH={libraries}${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}\nexec")
        };
        self.write(program, &start, arguments, at)
    }

    /// As [`Tree::script`], of a [whole](Tree::whole) tree. The program is told the name by which the script is called.
    ///
    /// # Errors
    /// The tree has no loader; the script cannot be written.
    pub fn script_as_called(&self, program: &str, at: &Path) -> Result<()> {
        let loader = self.loader().context("no loader among the packages")?;
        let start = format!("exec {} --argv0 \"$0\" --library-path {}", path(&loader), joined(&self.libraries()));
        self.write(program, &start, &[], at)
    }

    fn write(&self, program: &str, start: &str, arguments: &[&str], at: &Path) -> Result<()> {
        let mut text =
            format!("#!/bin/sh\n# Written by `cargo xtask`: {program} of Debian's packages, not installed.\n");
        write!(text, "{start} {}", path(&self.path(program)))?;
        for word in arguments {
            write!(text, " {}", quoted(word))?;
        }
        writeln!(text, " \"$@\"")?;
        if let Some(folder) = at.parent() {
            fs::create_dir_all(folder)?;
        }
        // Beside, then renamed: it may be running.
        let beside = at.with_extension("new");
        fs::write(&beside, text).with_context(|| beside.display().to_string())?;
        executable(&beside)?;
        fs::rename(&beside, at).with_context(|| at.display().to_string())
    }
}

/// Folders as one word of a shell.
fn joined(folders: &[PathBuf]) -> String {
    let folders: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
    quoted(&folders.join(":"))
}

/// A file as one word of a shell.
fn path(file: &Path) -> String {
    quoted(&file.display().to_string())
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

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::symlink;
    use std::process::Command;

    use super::*;

    /// The loader is a program that prints its words, in a folder whose name a shell would take apart. A link calls the
    /// script, as an environment calls its Python.
    #[test]
    fn a_program_is_told_the_name_by_which_it_is_called() {
        let root = std::env::temp_dir().join(format!("breakaway it's a tree-{}", std::process::id()));
        let libraries = root.join("usr/lib/own");
        let tree = Tree { root: root.clone(), whole: true };
        let (script, link) = (tree.path("usr/bin/python"), root.join("venv-python"));
        fs::create_dir_all(&libraries).unwrap();
        fs::write(libraries.join("libc.so.6"), "").unwrap();
        assert!(tree.script_as_called("usr/bin/python3", &script).is_err(), "there is no loader");
        symlink("/bin/echo", libraries.join("ld-linux.so.2")).unwrap();
        tree.script_as_called("usr/bin/python3", &script).unwrap();
        symlink(&script, &link).unwrap();
        let said = Command::new("sh").arg(&link).args(["-c", "a  b"]).output().unwrap();
        let [link, libraries, program] =
            [link, libraries, tree.path("usr/bin/python3")].map(|p| p.display().to_string());
        fs::remove_dir_all(root).unwrap();
        let wanted = format!("--argv0 {link} --library-path {libraries} {program} -c a  b\n");
        assert_eq!(String::from_utf8(said.stdout).unwrap(), wanted);
    }
}
