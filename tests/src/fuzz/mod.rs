//! The promises about every input, whatever its bytes. There is one function for each. libFuzzer runs them
//! (`cargo xtask fuzz`, the crate in fuzz/). tests/tests/all/fuzz.rs runs them on the committed corpus, and on some
//! thousand damaged copies of it.
//!
//! Each panics where a promise is broken, and says whether the input was accepted. A test in which nothing is
//! accepted, or nothing refused, tests nothing.

mod command;
pub mod damage;
mod experiment;
pub mod flash;
mod frame;
mod log;
mod mass;
mod model;
mod recording;

use std::fs;
use std::path::{Path, PathBuf};

/// An input of Breakaway.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name: of its corpus' folder and of its program in fuzz/.
    pub name: &'static str,
    /// Takes an input; true if it was accepted.
    pub run: fn(&[u8]) -> bool,
    /// Longest input, bytes.
    pub most_bytes: usize,
    /// Copies that the test damages: a few seconds of them.
    pub copies: u64,
}

impl Target {
    /// As [`Target::run`], of no more than the longest input.
    pub fn take(&self, bytes: &[u8]) -> bool {
        (self.run)(bytes.get(..self.most_bytes).unwrap_or(bytes))
    }
}

/// Every input.
pub const TARGETS: [Target; 9] = [
    Target { name: "recording", run: recording::run, most_bytes: 4096, copies: 20_000 },
    Target { name: "log", run: log::run, most_bytes: 32_768, copies: 10_000 },
    Target { name: "can", run: log::can, most_bytes: 4096, copies: 10_000 },
    Target { name: "model", run: model::model, most_bytes: 2048, copies: 4_000 },
    Target { name: "controller", run: model::controller, most_bytes: 4096, copies: 4_000 },
    Target { name: "experiment", run: experiment::run, most_bytes: 1024, copies: 4_000 },
    Target { name: "frame", run: frame::run, most_bytes: 2048, copies: 20_000 },
    Target { name: "command", run: command::run, most_bytes: 2048, copies: 2_000 },
    Target { name: "flash", run: flash::run, most_bytes: 4 * flash::PAGE, copies: 4_000 },
];

/// The committed inputs of a target: name and bytes, in the order of their names.
///
/// # Panics
/// Where the folder cannot be read.
pub fn corpus(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.display().to_string(), fs::read(&path).unwrap())).collect()
}

/// The target of a name.
///
/// # Panics
/// Where there is none.
pub fn target(name: &str) -> Target {
    TARGETS.into_iter().find(|target| target.name == name).unwrap_or_else(|| panic!("no target {name}"))
}
