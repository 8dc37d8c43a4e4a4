//! Texts of licences, each once, with all that it is the text of.

use std::collections::BTreeMap;
use std::fmt;

/// A line between two texts.
const RULE: &str = "--------------------------------------------------------------------------------";

/// The texts, in the order in which they were first seen.
#[derive(Debug, Default)]
pub struct Texts {
    /// By its words, as line ends and blanks differ from package to package.
    by_words: BTreeMap<String, usize>,
    /// What it is the text of, and the text.
    all: Vec<(Vec<String>, String)>,
}

impl Texts {
    /// Adds a text of what has that title.
    pub fn add(&mut self, title: &str, text: &str) {
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let next = self.all.len();
        let at = *self.by_words.entry(words).or_insert(next);
        if at == next {
            self.all.push((Vec::new(), text.trim_end().to_owned()));
        }
        let titles = &mut self.all[at].0;
        if !titles.iter().any(|own| own == title) {
            titles.push(title.to_owned());
        }
    }
}

impl fmt::Display for Texts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "Third-party code in Breakaway. Each text below is that of what is listed above it.")?;
        for (titles, text) in &self.all {
            write!(f, "\n{RULE}\n")?;
            titles.iter().try_for_each(|title| writeln!(f, "{title}"))?;
            write!(f, "{RULE}\n\n{text}\n")?;
        }
        Ok(())
    }
}

/// The text of a page in HTML: without what is between `<` and `>`, and with the signs that it has names for.
pub fn of_page(html: &str) -> String {
    let mut text = String::new();
    for part in html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)) {
        text.push_str(part);
    }
    for (name, sign) in
        [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&#x27;", "'"), ("&amp;", "&")]
    {
        text = text.replace(name, sign);
    }
    let mut lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    // Where a page has a list of headings, its text has lines without a word.
    lines.dedup_by(|a, b| a.trim().is_empty() && b.trim().is_empty());
    lines.join("\n").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_given_once_whatever_its_line_ends() {
        let mut texts = Texts::default();
        texts.add("a 1", "Do as\nyou like.\n");
        texts.add("b 1", "Do as you\r\nlike.");
        texts.add("c 1", "Do not.");
        texts.add("a 1", "Do as you like.");
        let all = texts.to_string();
        assert!(all.contains("a 1\nb 1\n") && all.matches("like.").count() == 1 && all.contains("c 1\n"), "{all}");
    }

    #[test]
    fn a_page_becomes_text() {
        let html = "<html>\n<h2 id=\"a\">The &amp; library</h2>\n\n\n<p>John &lt;j@x&gt;</p>\n";
        assert_eq!(of_page(html), "The & library\n\nJohn <j@x>");
    }
}
