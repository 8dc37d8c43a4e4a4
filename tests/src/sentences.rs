//! Sentences of a Markdown page, or of the comments of a Rust source, that are longer than a person reads at once.

use std::iter;

use crate::markdown::{is_prose, marker};

/// Most words of a sentence. Numbers, formulas and code are no words.
pub const MOST_WORDS: usize = 25;

/// A sentence with too many words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Long {
    /// Line of the page on which its paragraph begins, from 1.
    pub line: usize,
    /// Its words.
    pub words: usize,
    /// The sentence, its code and the addresses of its links left out.
    pub text: String,
}

/// The text without code spans, addresses of links and emphasis.
fn bare(paragraph: &str) -> String {
    let text: String = paragraph.split('`').step_by(2).collect::<Vec<_>>().join("code");
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some(at) = rest.find("](") {
        out.push_str(&rest[..at]);
        let after = &rest[at + 2..];
        rest = after.find(')').map_or("", |end| &after[end + 1..]);
    }
    out.push_str(rest);
    out.replace(['*', '['], "")
}

/// Whether a token is a word: letters, with hyphens, apostrophes and dots inside.
fn is_word(token: &str) -> bool {
    let token = token.trim_matches(|c: char| !c.is_alphanumeric());
    !token.is_empty() && token.chars().all(|c| c.is_alphabetic() || "-'’.".contains(c))
}

/// The sentences of a paragraph: each ends in `.`, `!` or `?`, and `·` separates entries of a list of links.
fn sentences(paragraph: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    for token in bare(paragraph).split_whitespace() {
        if let Some(last) = all.last_mut() {
            last.push_str(token);
            last.push(' ');
        }
        if token == "·" || token.trim_end_matches([')', '"', '”']).ends_with(['.', '!', '?']) {
            all.push(String::new());
        }
    }
    all
}

/// Sentences of more than [`MOST_WORDS`] words, outside of tables, headings and blocks.
pub fn long(page: &str) -> Vec<Long> {
    let mut found = Vec::new();
    let mut paragraph = (0, String::new());
    let mut fenced = false;
    for (number, line) in page.lines().map(Some).chain(iter::once(None)).enumerate() {
        let fence = line.is_some_and(|line| line.trim_start().starts_with("```"));
        // A line indented by four goes on with the item above it, or is code.
        let prose = line.filter(|line| {
            let goes_on = !paragraph.1.is_empty() && line.starts_with("    ") && !line.trim().is_empty();
            !fence && !fenced && (is_prose(line) || goes_on)
        });
        fenced ^= fence;
        if prose.is_none_or(|line| marker(line).is_some()) {
            found.extend(sentences(&paragraph.1).into_iter().filter_map(|text| {
                let words = text.split([' ', '–', '—', '/']).filter(|token| is_word(token)).count();
                (words > MOST_WORDS).then(|| Long { line: paragraph.0, words, text: text.trim().to_owned() })
            }));
            paragraph.1.clear();
        }
        if let Some(line) = prose {
            if paragraph.1.is_empty() {
                paragraph.0 = number + 1;
            }
            let line = &line[marker(line).unwrap_or(0)..];
            paragraph.1.push_str(line.trim());
            paragraph.1.push(' ');
        }
    }
    found
}

/// The comments of a Rust source as a page with as many lines: a line of code is an empty one.
///
/// A comment after code is left out: its line has no room for so many words.
fn comments(source: &str) -> String {
    let comment = |line: &str| {
        let text = line.trim_start().strip_prefix("//")?;
        let text = text.strip_prefix(['/', '!']).unwrap_or(text);
        Some(text.strip_prefix(' ').unwrap_or(text).to_owned())
    };
    source.lines().map(|line| comment(line).unwrap_or_default() + "\n").collect()
}

/// Sentences of more than [`MOST_WORDS`] words in the comments and doc comments of a Rust source.
pub fn long_in_comments(source: &str) -> Vec<Long> {
    long(&comments(source))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_sentence_is_found_and_what_is_no_sentence_is_not() {
        let words = |count: usize| "word ".repeat(count).trim_end().to_owned();
        let fine = format!("{}. {}! {}?\n\n- {}\n- {}\n", words(25), words(25), words(25), words(20), words(20));
        assert_eq!(long(&fine), []);
        let table = format!("| {} |\n\n# {}\n\n    {}\n\n```\n{}\n```\n", words(40), words(40), words(40), words(40));
        assert_eq!(long(&table), []);
        // Code is one word, and numbers, formulas and addresses are none.
        let short = format!("{} `{}` 1 2 3 b·ẍ [one](docs/a_long_name.md) x.", words(22), words(30));
        assert_eq!(long(&short), []);

        let page = format!("Short.\n\nA first one. {}\n{}, and 0.5 V; more.\n", words(13), words(13));
        let found = long(&page);
        assert_eq!((found.len(), found[0].line, found[0].words), (1, 3, 29), "{found:?}");
        let item = format!("1. Short.\n2. {}\n   {}\n", words(13), words(13));
        assert_eq!(long(&item).iter().map(|long| (long.line, long.words)).collect::<Vec<_>>(), [(2, 26)]);
    }

    #[test]
    fn a_long_sentence_of_a_comment_is_found_and_code_is_no_comment() {
        let words = |count: usize| "word ".repeat(count).trim_end().to_owned();
        let fine = format!("//! {}.\n//! {}.\n\n/// {}\nlet a = \"{}\";\n", words(25), words(25), words(20), words(40));
        assert_eq!(long_in_comments(&fine), []);
        let apart = format!("/// {}\n///\n/// {}\n// {}\n\n    // {}\n", words(20), words(20), words(5), words(20));
        assert_eq!(long_in_comments(&apart), []);
        let block = format!("/// Short:\n///\n///     {}\n", words(40));
        assert_eq!(long_in_comments(&block), []);

        let places = |source: &str| -> Vec<(usize, usize)> {
            long_in_comments(source).iter().map(|long| (long.line, long.words)).collect()
        };
        for slashes in ["//", "///", "//!"] {
            let two = format!("fn f() {{\n    {slashes} {}\n    {slashes} {}.\n}}\n", words(13), words(13));
            assert_eq!(places(&two), [(2, 26)], "{two}");
        }
    }
}
