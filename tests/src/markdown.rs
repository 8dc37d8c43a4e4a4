//! Lines of a Markdown page no longer than a person reads: the pages that are written by programs, and the test of all.

use std::iter;

/// Longest line of prose, characters.
pub const WIDTH: usize = 100;

/// Whether a line is prose: not of a table, a heading, a block, a figure or a comment.
pub(crate) fn is_prose(line: &str) -> bool {
    let start = line.trim_start();
    !(start.is_empty() || line.starts_with("    ") || start.starts_with(['|', '#', '<', '!']))
}

/// How far a line's own marker (`- `, `2. `) indents what follows; `None` for a line without one.
pub(crate) fn marker(line: &str) -> Option<usize> {
    let start = line.trim_start();
    let digits = start.chars().take_while(char::is_ascii_digit).count();
    let is_item = start.starts_with("- ") || start.starts_with("* ") || digits > 0 && start[digits..].starts_with(". ");
    is_item.then(|| line.len() - start.len() + start.find(' ').map_or(0, |at| at + 1))
}

/// Words that stay on one line. Those of a code span or of a link's text stick together. A word that would begin a
/// list or a table sticks to the one before it.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut open = false;
    for word in text.split_whitespace() {
        let digits = word.trim_end_matches(['.', ')']);
        let is_marker = word.starts_with(['-', '*', '+', '|', '#', '>', '='])
            || digits.len() < word.len() && digits.chars().all(|c| c.is_ascii_digit());
        match words.last_mut() {
            Some(last) if open || is_marker => *last = format!("{last} {word}"),
            _ => words.push(word.to_owned()),
        }
        let last = words.last().map_or("", String::as_str);
        let count = |c: char| last.matches(c).count();
        open = count('`') % 2 == 1 || count('[') > count(']');
    }
    words
}

/// One paragraph or item in lines of at most [`WIDTH`], where its words allow.
fn filled(lines: &[&str]) -> Vec<String> {
    let first = lines.first().copied().unwrap_or_default();
    let indent = first.len() - first.trim_start().len();
    let hang = marker(first).unwrap_or(indent);
    let text = lines.join(" ");
    let mut out: Vec<String> = Vec::new();
    for word in words(&text) {
        match out.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(&word);
            }
            Some(_) => out.push(format!("{}{word}", " ".repeat(hang))),
            None => out.push(format!("{}{word}", " ".repeat(indent))),
        }
    }
    out
}

/// The page with every paragraph that has too long a line in lines of at most [`WIDTH`]; all others as they are.
pub fn wrapped(page: &str) -> String {
    let mut out: Vec<String> = Vec::new();
    let mut paragraph: Vec<&str> = Vec::new();
    let mut fenced = false;
    for line in page.lines().map(Some).chain(iter::once(None)) {
        let fence = line.is_some_and(|line| line.trim_start().starts_with("```"));
        let goes_on = line.is_some_and(|line| !fence && !fenced && is_prose(line) && marker(line).is_none());
        if !goes_on || paragraph.is_empty() {
            if paragraph.iter().any(|line| line.chars().count() > WIDTH) {
                out.extend(filled(&paragraph));
            } else {
                out.extend(paragraph.iter().map(ToString::to_string));
            }
            paragraph.clear();
        }
        let Some(line) = line else { break };
        if !fence && !fenced && is_prose(line) {
            paragraph.push(line);
        } else {
            out.push(line.to_owned());
        }
        fenced ^= fence;
    }
    out.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_paragraphs_are_filled_and_nothing_else_is_touched() {
        let row = format!("| {} |", "cell ".repeat(40));
        let block = format!("    {}", "code ".repeat(40).trim_end());
        let short = "two short\nlines";
        let kept = format!("# A heading\n\n{row}\n\n{block}\n\n```\n{row}\n```\n\n{short}\n");
        assert_eq!(wrapped(&kept), kept);
        let long = format!("- {}`a code span of words` {}", "word ".repeat(18), "2. and - more ".repeat(12).trim_end());
        let made = wrapped(&format!("{long}\n- next\n"));
        assert!(made.lines().all(|line| line.chars().count() <= WIDTH), "{made}");
        assert!(made.contains("`a code span of words`") && made.ends_with("\n- next\n"), "{made}");
        assert!(
            made.lines().skip(1).take_while(|line| *line != "- next").all(|line| line.starts_with("  w")
                || line.starts_with("  `")
                || line.starts_with("  a")
                || line.starts_with("  m")),
            "{made}"
        );
        assert_eq!(
            made.split_whitespace().collect::<String>(),
            format!("{long}- next").split_whitespace().collect::<String>()
        );
        assert_eq!(wrapped(&made), made);
    }
}
