//! The program from outside.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Runs `breakaway` in a folder.
pub fn breakaway(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_breakaway")).current_dir(folder).args(arguments).output().unwrap()
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// The JSON document of a run that must succeed.
pub fn json(folder: &Path, arguments: &[&str]) -> Value {
    let run = breakaway(folder, &[arguments, &["--json"]].concat());
    assert_eq!(run.status.code(), Some(0), "{arguments:?}: {}", text(&run.stderr));
    serde_json::from_slice(&run.stdout).unwrap()
}

/// The names in a JSON object, sorted.
pub fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}
