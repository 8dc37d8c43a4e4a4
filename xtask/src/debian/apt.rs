//! apt-get with a state of its own: it reads the system's sources and keys, and writes below one folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::run::{run, succeeds};

/// What is installed here.
const STATUS: &str = "/var/lib/dpkg/status";

/// apt-get on its own folder.
pub struct Apt {
    folder: PathBuf,
}

impl Apt {
    /// With its lists up to date, as far as the servers answer.
    ///
    /// # Errors
    /// There is no apt-get or no dpkg-deb here; the folder cannot be written.
    pub fn new(folder: &Path) -> Result<Self> {
        for program in ["apt-get", "dpkg-deb"] {
            ensure!(succeeds(Command::new(program).arg("--version")), "no {program} here");
        }
        let apt = Self { folder: folder.to_path_buf() };
        fs::create_dir_all(apt.folder.join("lists/partial"))?;
        fs::write(apt.nothing(), "")?;
        fs::write(apt.configuration(), configuration(&apt.folder)).context("apt.conf")?;
        // One source out of order makes an update fail, and yet the packages may be there.
        if let Err(error) = run(apt.get(STATUS.as_ref()).arg("update")) {
            println!("{error:#}");
        }
        Ok(apt)
    }

    /// Downloads packages with what they need and the system does not have; their files.
    ///
    /// They may not fit beside the installed packages, because another version of a dependency is there. Then all
    /// dependencies are downloaded, as by [`Apt::download_whole`].
    ///
    /// # Errors
    /// They are in none of the sources, or no server answers.
    pub fn download(&self, packages: &[&str]) -> Result<Vec<PathBuf>> {
        self.beside(STATUS.as_ref(), packages).or_else(|error| {
            println!("{error:#}: once more, with all that they need");
            self.download_whole(packages)
        })
    }

    /// Downloads packages with all that they need, as for an empty system; their files.
    ///
    /// # Errors
    /// As [`Apt::download`].
    pub fn download_whole(&self, packages: &[&str]) -> Result<Vec<PathBuf>> {
        self.beside(&self.nothing(), packages)
    }

    /// Downloads what is to be installed beside that which a status file names.
    fn beside(&self, status: &Path, packages: &[&str]) -> Result<Vec<PathBuf>> {
        let archives = self.folder.join("cache/archives");
        if archives.exists() {
            fs::remove_dir_all(&archives)?;
        }
        fs::create_dir_all(archives.join("partial"))?;
        run(self.get(status).args(["install", "--download-only", "--no-remove"]).args(packages))?;
        let files = fs::read_dir(&archives)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
        let mut files: Vec<PathBuf> =
            files.into_iter().filter(|file| file.extension().is_some_and(|kind| kind == "deb")).collect();
        files.sort();
        Ok(files)
    }

    fn configuration(&self) -> PathBuf {
        self.folder.join("apt.conf")
    }

    /// The status file of a system without packages.
    fn nothing(&self) -> PathBuf {
        self.folder.join("nothing-installed")
    }

    fn get(&self, status: &Path) -> Command {
        let mut command = Command::new("apt-get");
        command.env("LC_ALL", "C").args(["--quiet", "--yes", "--config-file"]).arg(self.configuration());
        command.arg("--option").arg(format!("Dir::State::status={}", status.display()));
        command
    }
}

/// What differs from the system's configuration.
fn configuration(folder: &Path) -> String {
    let folder = folder.display();
    format!(
        r#"// Written by `cargo xtask`.
Dir::State "{folder}";
Dir::State::lists "{folder}/lists";
Dir::Cache "{folder}/cache";
Dir::Log "{folder}/log";
// Downloads as whoever runs this, not as a user who cannot write here.
APT::Sandbox::User "root";
// Nothing of the system's is written.
Debug::NoLocking "true";
APT::Install-Recommends "false";
APT::Install-Suggests "false";
Acquire::Languages "none";
// A silent server ends.
Acquire::http::Timeout "30";
Acquire::https::Timeout "30";
// What the system does after its own updates.
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
#clear DPkg::Pre-Invoke;
#clear DPkg::Post-Invoke;
#clear DPkg::Pre-Install-Pkgs;
"#
    )
}
