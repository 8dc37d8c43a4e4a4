//! The pages and figures of `docs/` that are written from simulations: what is committed is what the code gives.

use std::path::{Path, PathBuf};

use breakaway::control::design::Design;
use breakaway_tests::adaptive_page;

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

/// The text without its numbers, and the numbers.
fn apart(text: &str) -> (String, Vec<f64>) {
    let (mut words, mut numbers, mut number) = (String::new(), Vec::new(), String::new());
    for c in text.chars().chain(['\0']) {
        if c.is_ascii_digit() || c == '.' || (c == '-' && number.is_empty()) {
            number.push(c);
            continue;
        }
        match number.parse() {
            Ok(value) => {
                numbers.push(value);
                words.push('#');
            }
            Err(_) => words.push_str(&number),
        }
        number.clear();
        words.push(c);
    }
    (words, numbers)
}

/// Equal but for the last digit of the numbers (pixels have one decimal, the tables two). The mathematics library of
/// another system may round an exponential the other way.
fn same(found: &str, made: &str) -> bool {
    let ((a, p), (b, q)) = (apart(found), apart(made));
    a == b && p.len() == q.len() && p.iter().zip(&q).all(|(x, y)| (x - y).abs() <= 0.2 + 0.01 * y.abs())
}

/// `BREAKAWAY_BLESS=1 cargo test -p breakaway-tests --test all pages::` writes the files anew.
fn check(files: Vec<adaptive_page::File>) {
    for (name, text) in files {
        let path = docs().join(&name);
        if std::env::var_os("BREAKAWAY_BLESS").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(same(&found, &text), "docs/{name} is not what the code gives; run BREAKAWAY_BLESS=1 cargo test");
    }
}

#[test]
fn the_adaptive_page_is_what_the_law_does() {
    check(adaptive_page::files());
}

#[test]
fn a_changed_number_or_word_is_seen() {
    assert!(same("a 1.0 b 20.5", "a 1.1 b 20.4"));
    assert!(!same("a 1.0 b", "a 1.5 b") && !same("a 1.0 b", "a 1.0 c") && !same("a 1.0", "a 1.0 2.0"));
}

/// The example of docs/control.md is a controller, and its file written again is the same controller.
#[test]
fn the_controllers_example_is_read() {
    let page = std::fs::read_to_string(docs().join("control.md")).unwrap();
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let design = Design::parse("docs/control.md", example).unwrap();
    assert_eq!(design.model.effects.len(), 1);
    let mut again = Design::parse("again", &design.to_toml()).unwrap();
    again.model.provenance.clone_from(&design.model.provenance);
    assert_eq!(again, design);
}
