//! Whether the tests build the command as its user does. Cargo unites the features of all crates that it builds together, so
//! that code may compile in the tests alone.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, ensure};

use crate::run::{answer, cargo};

/// Features of what the command uses, by package.
type Features = BTreeMap<String, BTreeSet<String>>;

/// Features that the tests add, and of which the command can use nothing.
const ADDED: [(&str, &str); 4] = [
    // Of the firmware.
    ("breakaway-core", "micromath"),
    // By proptest. clippy.toml forbids the generator that they bring.
    ("rand", "alloc"),
    ("rand", "std"),
    ("rand", "sys_rng"),
];

/// Compares the features of the command's own dependencies, alone and in the build of the whole workspace.
///
/// # Errors
/// What the workspace adds, by package.
pub fn compare() -> Result<()> {
    let alone = features(&["--package", "breakaway", "--edges", "normal,build", "--depth", "1"])?;
    let united = features(&["--workspace", "--all-features"])?;
    let added = added(&alone, &united);
    ensure!(
        added.is_empty(),
        "the tests build the command's dependencies with features that it does not ask for: {}. Add them to \
         host/Cargo.toml, or take them from what brings them (`cargo tree --workspace --all-features --edges features \
         --invert <package>`)",
        added.join(", ")
    );
    Ok(())
}

/// What cargo says of the dependencies that `arguments` choose.
fn features(arguments: &[&str]) -> Result<Features> {
    let format = ["tree", "--prefix", "none", "--format", "{p}|{f}"];
    let lines = answer(cargo(format).args(arguments)).context("cargo tree fails")?;
    Ok(read(&lines))
}

/// Lines such as `rand v0.10.3|alloc,std (*)`. A package of two versions has the features of both.
fn read(lines: &str) -> Features {
    let mut all = Features::new();
    for (package, features) in lines.lines().filter_map(|line| line.split_once('|')) {
        let Some(name) = package.split(' ').next() else { continue };
        let features = features.trim_end_matches("(*)").trim().split(',').filter(|feature| !feature.is_empty());
        all.entry(name.to_owned()).or_default().extend(features.map(str::to_owned));
    }
    all
}

/// What `united` adds to `alone`. The feature `default` is left out, because it only brings others, which are listed.
fn added(alone: &Features, united: &Features) -> Vec<String> {
    let mut added = Vec::new();
    for (package, own) in alone {
        for feature in united.get(package).into_iter().flatten().filter(|feature| *feature != "default") {
            if !own.contains(feature) && !ADDED.contains(&(package, feature)) {
                added.push(format!("{package}/{feature}"));
            }
        }
    }
    added
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_tests_add_is_listed() {
        let alone = read("breakaway v0.1.0 (/a/host)|default\nserde v1.0.2|derive\nrand v0.10.3|\ncsv v1.3.0|");
        let united =
            read("serde v1.0.2|default,derive,rc\nrand v0.10.3|alloc,std (*)\ncsv v1.3.0| (*)\nzip v9.0.0|lzma");
        assert_eq!(added(&alone, &united), ["serde/rc"]);
        assert!(added(&alone, &alone).is_empty());
    }
}
