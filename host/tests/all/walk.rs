//! The README's walk and the tutorial, as their reader does them. A shell runs every line in order, in one folder,
//! with the files that the page shows. What the tutorial says a command prints is what it prints.
#![cfg(unix)]

#[path = "../../../tests/tests/all/docs/commands.rs"]
pub mod commands;

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use commands::{Program, lines, root, shown};

/// Commands that need a board, or wait for Ctrl-C.
pub const BOARD: [&str; 5] = ["--port", "virtual-board", "capture", "monitor", "device"];
/// Added to lines of the README: 250 samples per second instead of 1000, and the demo beside the rest.
const SMALLER: [(&str, &str); 2] = [("run suite", "--tick 0.004"), ("demo", "-o demo")];

/// A line of a shell, with `breakaway` first in its path.
pub fn shell(folder: &Path, line: &str) -> Output {
    let own = Path::new(env!("CARGO_BIN_EXE_breakaway")).parent().unwrap();
    let path = format!("{}:{}", own.display(), env::var("PATH").unwrap_or_default());
    // The order of `*.csv` must not depend on the language.
    Command::new("sh").args(["-c", line]).current_dir(folder).env("PATH", path).env("LC_ALL", "C").output().unwrap()
}

pub fn done(folder: &Path, line: &str) {
    let output = shell(folder, line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(!printed.contains("NaN"), "{line}: what has no error is said in words:\n{printed}");
}

/// Files that a command is told to write, found without its definition: `-o` and `--report`.
fn written(words: &[String]) -> Vec<&str> {
    let pairs = words.windows(2).filter(|pair| ["-o", "--report"].contains(&pair[0].as_str()));
    pairs.map(|pair| pair[1].as_str()).collect()
}

#[test]
fn the_readmes_walk() {
    let text = fs::read_to_string(root().join("README.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let files = shown(&text);
    for (_, name, content) in &files {
        fs::write(place.join(name), content).unwrap();
    }
    // The reader's own recording.
    done(place, "breakaway run suite --model axis.toml --tick 0.004 -o own");
    done(place, "sed -e '/^#/d' -e 's/^t,u,x$/t_s,u_V,x_m/' own/fit/relay_high.csv > rec.csv");
    let mut commands = Vec::new();
    for line in lines("README.md", &text).iter().filter(|line| line.program == Program::Breakaway) {
        let words = line.words();
        if words.iter().any(|word| BOARD.contains(&word.as_str())) {
            continue;
        }
        let smaller = SMALLER.iter().find(|(command, _)| line.arguments.starts_with(command)).map_or("", |row| row.1);
        done(place, &format!("breakaway {} {smaller}", line.arguments));
        for file in written(&words) {
            assert!(place.join(file).exists(), "{}: {file} was not written", line.place);
        }
        commands.push(words[0].clone());
    }
    for command in ["demo", "run", "identify", "sinefit", "bode", "discover", "effects", "tune", "track", "simulate"] {
        assert!(commands.iter().any(|done| done == command), "the README no longer shows {command}");
    }
    // What is hidden in the axis that the README shows is what it finds.
    let (_, _, axis) = files.iter().find(|file| file.1 == "axis.toml").unwrap();
    let improved = fs::read_to_string(place.join("improved.toml")).unwrap();
    assert!(axis.contains("name = \"cogging\"") && improved.contains("name = \"cogging\""), "{improved}");
    // What the base model missed is named, so no remark says any more that something is missing.
    let report = fs::read_to_string(place.join("demo/discovery.html")).unwrap();
    assert!(report.contains("The model missed cogging") && !report.contains("misses something"), "{report}");
}

/// Numbers agree within 5 % (another mathematics library, another order of threads), words exactly, spaces not at all.
fn same(written: &str, printed: &str) -> bool {
    let bare = |word: &str| word.trim_matches(['(', ')', ',', ';', ':']).parse::<f64>();
    let agree = |(a, b): (&str, &str)| match (bare(a), bare(b)) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.05 * a.abs().max(b.abs()),
        _ => a == b,
    };
    let (a, b) = (written.split_whitespace(), printed.split_whitespace());
    a.clone().count() == b.clone().count() && a.zip(b).all(agree)
}

/// Every written line is a printed one, in order, without a gap but where `…` stands.
fn check_printed(place: &str, written: &[&str], printed: &str) {
    let mut rest = printed.lines();
    let mut gap = false;
    for line in written.iter().filter(|line| !line.is_empty()) {
        if *line == "…" {
            gap = true;
            continue;
        }
        let mut next = || rest.by_ref().find(|line| !line.is_empty());
        let found = if gap { rest.any(|printed| same(line, printed)) } else { next().is_some_and(|p| same(line, p)) };
        assert!(found, "{place}: this is not printed (any more):\n{line}\nbut:\n{printed}");
        gap = false;
    }
    let left = rest.find(|line| !line.is_empty());
    assert!(gap || written.is_empty() || left.is_none(), "{place}: more is printed: {left:?}; end it with …");
}

#[test]
fn the_tutorial_prints_what_it_says() {
    let text = fs::read_to_string(root().join("docs/tutorial.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (_, name, content) in shown(&text) {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let rows: Vec<&str> = text.lines().collect();
    let mut commands = 0;
    for (index, row) in rows.iter().enumerate() {
        let Some(line) = row.strip_prefix("$ ") else { continue };
        let after = &rows[index + 1..];
        let end = after.iter().position(|row| row.starts_with("$ ") || row.starts_with("```")).unwrap_or(after.len());
        let output = shell(folder.path(), line);
        let place = format!("docs/tutorial.md:{}", index + 1);
        let refused = after[..end].iter().any(|row| row.starts_with("error: "));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(i32::from(refused)), "{place}: {errors}");
        check_printed(&place, &after[..end], &format!("{}{errors}", String::from_utf8_lossy(&output.stdout)));
        commands += 1;
    }
    assert!(commands >= 10, "only {commands} lines start with `$ `");
}

#[test]
fn a_line_that_is_not_printed_is_seen() {
    assert!(same("f1  0.5000  ± 9e-3 V", "f1 0.5100 ± 9.1e-3 V"));
    assert!(!same("f1 0.50 V", "f1 0.60 V") && !same("f1 0.5 V", "c 0.5 V") && !same("f1 0.5", "f1 0.5 V"));
    check_printed("a", &["x 1", "…", "z 3"], "x 1\ny 2\nz 3\n");
    for wrong in [&["x 1", "z 3"][..], &["x 1"], &["…", "w"]] {
        assert!(std::panic::catch_unwind(|| check_printed("a", wrong, "x 1\ny 2\nz 3\n")).is_err(), "{wrong:?}");
    }
}
