//! docs/faults.md names every fault and limit, and tests that exist.

use std::path::{Path, PathBuf};

use breakaway_core::link::FaultCause;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All Rust sources below a folder.
fn sources(folder: &Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            text.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}

/// `EncoderFrozen` as `encoder_frozen`.
fn snake(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.extend(letter.to_lowercase());
    }
    text
}

/// The words in back quotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

#[test]
fn the_table_names_every_fault_and_tests_that_exist() {
    let page = std::fs::read_to_string(root().join("docs/faults.md")).unwrap();
    let mut code = String::new();
    for folder in ["firmware/src", "firmware/tests", "tests/tests/virtual_board", "tests/tests/emulator"] {
        sources(&root().join(folder), &mut code);
    }
    let rows: Vec<Vec<&str>> = page
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    for row in &rows {
        let [_, _, _, _, tests] = row[..] else { panic!("five columns: {row:?}") };
        assert!(quoted(tests).next().is_some() || tests.starts_with("none"), "{row:?}");
        for test in quoted(tests) {
            let is_test = ["#[test]\nfn ", "    #[test]\n    fn "].map(|head| code.contains(&format!("{head}{test}(")));
            assert!(is_test.contains(&true), "docs/faults.md: there is no test `{test}`");
        }
    }
    let named: Vec<&str> = rows.iter().flat_map(|row| quoted(row[0])).collect();
    for cause in FaultCause::ALL {
        let name = snake(&format!("{cause:?}"));
        assert!(named.contains(&name.as_str()), "docs/faults.md has no row for `{name}`");
    }
}
