//! `cargo xtask fuzz`: every input under libFuzzer, from the seeds of fuzz/corpus.
//!
//! The targets are in tests/src/fuzz; their bounded test in the suite is tests/tests/all/fuzz.rs. Runs on the active toolchain:
//! there is no sanitizer, because the project's own code has no `unsafe` that runs on the host.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::processor;
use crate::run::{cargo, root, run, succeeds};

/// One input may take this long, s, and this much memory, MiB.
const TIMEOUT_S: u64 = 20;
const MEMORY_MIB: u64 = 1024;
/// A run takes a second to start, s.
const SHORTEST_S: f64 = 10.0;

/// libFuzzer's report of a run.
#[derive(Clone, Debug, Default, PartialEq)]
struct Outcome {
    executions: u64,
    /// Processor time of libFuzzer's program, s.
    time_s: f64,
    /// Edges of the program that were reached.
    edges: u64,
    /// Inputs that each reach something of their own.
    corpus: u64,
    /// File with the input that broke a promise.
    found: Option<String>,
}

impl Outcome {
    /// Takes a line of libFuzzer's: `#123 REDUCE cov: 10 ft: 20 corp: 3/45b …`, `stat::number_of_executed_units: 5` or
    /// `Test unit written to FILE`.
    fn read(&mut self, line: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let after = |name: &str| words.iter().position(|word| *word == name).and_then(|at| words.get(at + 1).copied());
        let number = |text: Option<&str>| text.and_then(|text| text.split('/').next()?.parse().ok());
        self.edges = number(after("cov:")).unwrap_or(self.edges);
        self.corpus = number(after("corp:")).unwrap_or(self.corpus);
        self.executions = number(after("stat::number_of_executed_units:")).unwrap_or(self.executions);
        if let Some((_, file)) = line.split_once("Test unit written to ") {
            self.found = Some(file.trim().to_owned());
        }
    }
}

/// Runs `targets` (all, where none is named) for `seconds` of processor time each.
pub fn all(targets: &[String], seconds: u64) -> Result<()> {
    let known = known()?;
    if let Some(other) = targets.iter().find(|target| !known.contains(target)) {
        bail!("there is no target {other}; there are {}", known.join(", "));
    }
    if !succeeds(&mut cargo(["fuzz", "--version"])) {
        bail!("cargo-fuzz is missing: `cargo install cargo-fuzz --locked` installs it; it needs a C++ compiler");
    }
    let chosen = if targets.is_empty() { &known } else { targets };
    let mut rows = Vec::new();
    for target in chosen {
        println!("\n==> fuzz {target}");
        rows.push((target, one(target, seconds)?));
    }
    println!(
        "\n| input | executions | processor time | edges reached | inputs kept | found |\n|---|---|---|---|---|---|"
    );
    for (target, outcome) in &rows {
        let Outcome { executions, time_s, edges, corpus, found } = outcome;
        let found = found.as_deref().unwrap_or("nothing");
        println!("| {target} | {executions} | {time_s:.0} s | {edges} | {corpus} | {found} |");
    }
    let found = rows.iter().filter(|(_, outcome)| outcome.found.is_some()).count();
    ensure!(
        found == 0,
        "{found} of the inputs broke a promise: mend it, and keep the file in fuzz/corpus/TARGET/ as its test"
    );
    Ok(())
}

/// The names of the targets: those of their programs.
fn known() -> Result<Vec<String>> {
    let programs = fs::read_dir(root().join("fuzz/fuzz_targets"))?;
    let names = programs.map(|entry| Ok(entry?.path().file_stem().unwrap_or_default().to_string_lossy().into_owned()));
    let mut names = names.collect::<Result<Vec<String>>>()?;
    names.sort();
    Ok(names)
}

/// What is found along the way is kept between runs, outside of the tree that is committed.
fn grown(target: &str, kind: &str) -> Result<PathBuf> {
    let folder = root().join("target/fuzz").join(kind).join(target);
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// Runs libFuzzer until the processor worked `seconds` for it. It counts time by the clock, and a busy machine gives it
/// only a part of that. So it runs again for the rest.
fn one(target: &str, seconds: u64) -> Result<Outcome> {
    let mut all = Outcome::default();
    while all.found.is_none() && all.time_s.round() < seconds as f64 {
        // What was changed meanwhile is built before the time is taken, not by the run.
        run(&mut fuzz("build", target))?;
        let rest = (seconds as f64 - all.time_s).ceil().max(SHORTEST_S);
        let before = all.clone();
        let begin = processor::time_s()?;
        all = round(target, rest)?;
        all.time_s = before.time_s + processor::time_s()? - begin;
        all.executions += before.executions;
    }
    Ok(all)
}

fn fuzz(action: &str, target: &str) -> Command {
    cargo(["fuzz", action, "--fuzz-dir", "fuzz", "--sanitizer", "none", target])
}

/// Goes on from what is kept, for `seconds` by the clock.
fn round(target: &str, seconds: f64) -> Result<Outcome> {
    let found = grown(target, "found")?;
    let mut command = fuzz("run", target);
    command.arg(grown(target, "corpus")?).arg(root().join("fuzz/corpus").join(target)).arg("--");
    command.args([
        format!("-max_total_time={seconds}"),
        format!("-timeout={TIMEOUT_S}"),
        format!("-rss_limit_mb={MEMORY_MIB}"),
        format!("-artifact_prefix={}/", found.display()),
        "-print_final_stats=1".to_owned(),
    ]);
    watch(&mut command)
}

/// Runs to the end, shows all but the lines of progress.
fn watch(command: &mut Command) -> Result<Outcome> {
    // A promise that is broken in a caught panic would print its trace each time.
    command.env("RUST_BACKTRACE", "0").stdin(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().context("cargo fuzz")?;
    let mut outcome = Outcome::default();
    for line in BufReader::new(child.stderr.take().context("no output")?).split(b'\n') {
        let line = String::from_utf8_lossy(&line?).into_owned();
        outcome.read(&line);
        if !line.starts_with('#') || line.contains("DONE") {
            eprintln!("{line}");
        }
    }
    let status = child.wait()?;
    ensure!(status.success() || outcome.found.is_some(), "cargo fuzz: {status}");
    if let Some(file) = &mut outcome.found {
        *file = Path::new(file).strip_prefix(root()).map_or(file.clone(), |short| short.display().to_string());
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libfuzzers_lines_are_read() {
        let mut outcome = Outcome::default();
        for line in [
            "INFO: seed corpus: files: 5 min: 160b max: 420b total: 1432b rss: 42Mb",
            "#6\tINITED cov: 2187 ft: 4000 corp: 5/1432b exec/s: 0 rss: 50Mb",
            "#1024\tREDUCE cov: 2301 ft: 5003 corp: 77/12Kb lim: 420 exec/s: 512 rss: 61Mb L: 100/420 MS: 1 EraseBytes-",
            "stat::number_of_executed_units: 2048",
        ] {
            outcome.read(line);
        }
        assert_eq!(outcome, Outcome { executions: 2048, time_s: 0.0, edges: 2301, corpus: 77, found: None });
        outcome.read("artifact_prefix='found/'; Test unit written to found/crash-12ab");
        assert_eq!(outcome.found.as_deref(), Some("found/crash-12ab"));
    }

    /// Every program has its seeds; that it has its target is seen by tests/tests/all/fuzz.rs, which names them all.
    #[test]
    fn every_target_has_seeds() {
        let known = known().unwrap();
        assert_eq!(known.len(), 9);
        for target in known {
            assert!(root().join("fuzz/corpus").join(&target).read_dir().unwrap().next().is_some(), "{target}");
        }
    }
}
