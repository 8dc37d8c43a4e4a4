//! What is released: the workflows, the container and the crates' metadata agree with the tree (docs/releases.md).

use std::fs;
use std::path::Path;

use super::commands::root;

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn toml(file: &str) -> toml::Table {
    read(file).parse().unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The crates of the workspace: folder and manifest.
fn crates() -> Vec<(String, toml::Table)> {
    let members = toml("Cargo.toml")["workspace"]["members"].as_array().unwrap().clone();
    let folder = |member: &toml::Value| member.as_str().unwrap().to_owned();
    members.iter().map(|member| (folder(member), toml(&format!("{}/Cargo.toml", folder(member))))).collect()
}

/// A crate says what it is, and takes version, licence and oldest Rust from the workspace.
#[test]
fn every_crate_has_its_metadata() {
    let crates = crates();
    assert!(crates.len() >= 9, "{} crates", crates.len());
    for (folder, manifest) in crates {
        let package = &manifest["package"];
        let text = package.get("description").and_then(toml::Value::as_str).unwrap_or_default();
        assert!((20..=120).contains(&text.len()) && !text.ends_with('.'), "{folder}: description `{text}`");
        for key in ["version", "license", "rust-version", "publish"] {
            assert_eq!(package[key]["workspace"].as_bool(), Some(true), "{folder}: {key}");
        }
    }
}

/// What docs/releases.md and the workflow say is the oldest Rust is that of the workspace.
#[test]
fn the_oldest_rust_is_one() {
    let oldest = toml("Cargo.toml")["workspace"]["package"]["rust-version"].as_str().unwrap().to_owned();
    assert!(read("docs/releases.md").contains(&format!("`rust-version` is {oldest}")));
    assert!(read("README.md").contains(&format!("stable, {oldest} or later")));
    let ci = read(".github/workflows/ci.yml");
    assert!(ci.contains(&format!("toolchain install {oldest}")) && ci.contains(&format!("cargo +{oldest} check")));
}

/// Files and packages that the workflows name are there. Wheels and archives are built for the same systems.
#[test]
fn workflows_name_what_is_there() {
    let ci = read(".github/workflows/ci.yml");
    assert!(ci.contains("cargo xtask test") && root().join(".ci/run").exists());
    let names: Vec<String> =
        crates().iter().map(|(_, manifest)| manifest["package"]["name"].as_str().unwrap().to_owned()).collect();
    let mut seen = 0;
    for (_, rest) in ci.match_indices("--package ").map(|(at, found)| ci.split_at(at + found.len())) {
        let name = rest.split_whitespace().next().unwrap();
        assert!(names.iter().any(|known| known == name), "ci.yml: no package {name}");
        seen += 1;
    }
    assert!(seen >= 3, "{seen}");
    let wheels = read(".github/workflows/wheels.yml");
    let dist = toml("dist-workspace.toml");
    let targets: Vec<&str> =
        dist["dist"]["targets"].as_array().unwrap().iter().filter_map(toml::Value::as_str).collect();
    for (system, runner) in [("linux", "ubuntu"), ("darwin", "macos"), ("windows", "windows")] {
        assert!(targets.iter().any(|target| target.contains(system)), "dist: {system}");
        assert!(wheels.contains(runner) && ci.contains(runner), "{runner}");
    }
    // The workflow of a release fetches the version of dist by which it was made.
    let version = dist["dist"]["cargo-dist-version"].as_str().unwrap().to_owned();
    assert!(read(".github/workflows/release.yml").contains(&format!("/v{version}/")), "dist {version}");
    assert!(read("docs/releases.md").contains(&format!("version {version}")), "dist {version}");
    // Every job has the least rights: what it may write, it says itself.
    for file in ["ci.yml", "wheels.yml"] {
        assert!(read(&format!(".github/workflows/{file}")).contains("permissions:\n  contents: read"), "{file}");
    }
}

/// The program in the container is not root's, and nothing is copied that is not there.
#[test]
fn the_container_is_not_roots() {
    let text = read("Containerfile");
    let users: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("USER ")).collect();
    assert!(users.len() == 1 && users[0] != "0" && users[0] != "root", "{users:?}");
    assert_eq!(text.lines().filter(|line| line.starts_with("FROM ")).count(), 2, "built in one stage, run in another");
    for line in text.lines().filter_map(|line| line.strip_prefix("COPY ")).filter(|line| !line.starts_with("--from")) {
        let files: Vec<&str> = line.split_whitespace().collect();
        for file in &files[..files.len() - 1] {
            assert!(root().join(file).exists(), "{file}");
        }
    }
    let oldest = toml("Cargo.toml")["workspace"]["package"]["rust-version"].as_str().unwrap().to_owned();
    let image = text.split("rust:1.").nth(1).and_then(|rest| rest.split('-').next()).unwrap();
    let least = oldest.trim_start_matches("1.");
    assert!(image.parse::<u32>().unwrap() >= least.parse::<u32>().unwrap(), "rust:1.{image}");
    assert!(Path::new(&root().join(".containerignore")).exists());
}
