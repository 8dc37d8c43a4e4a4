//! Pages are read once: no sentence is longer than a person follows.

use breakaway_tests::sentences::{self, MOST_WORDS};

use super::commands::pages;

/// Pages with longer sentences: their text is that of the measurements that they report.
const LONGER: [&str; 4] = ["docs/benchmarks.md", "docs/blind.md", "docs/discovery.md", "docs/machines.md"];

/// A longer sentence has two things to say: make it two.
#[test]
fn sentences_have_at_most_25_words() {
    let pages: Vec<_> = pages().into_iter().filter(|(page, _)| !LONGER.contains(&page.as_str())).collect();
    assert!(pages.len() >= 20, "only {} pages were found", pages.len());
    let found = |(page, text): &(String, String)| -> Vec<String> {
        let long = sentences::long(text);
        long.iter().map(|long| format!("{page}:{}: {} words: {}", long.line, long.words, long.text)).collect()
    };
    let long: Vec<String> = pages.iter().flat_map(found).collect();
    assert!(long.is_empty(), "more than {MOST_WORDS} words:\n{}", long.join("\n"));
}
