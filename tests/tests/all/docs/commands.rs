//! The command lines of README.md and docs/*.md, and the files that those pages show. The tests that parse the lines
//! (tests/tests/all/docs.rs, xtask) and those that run them (host/tests/all/walk.rs) share this file.

use std::fs;
use std::path::{Path, PathBuf};

/// How the pages start a command of this project.
const STARTS: [(&str, Program); 3] = [
    ("breakaway ", Program::Breakaway),
    ("cargo run --release -- ", Program::Breakaway),
    ("cargo xtask ", Program::Xtask),
];

/// Whose command line it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// `breakaway`.
    Breakaway,
    /// `cargo xtask`.
    Xtask,
}

/// A command line of a page.
#[derive(Clone, Debug)]
pub struct Line {
    /// Page and line, for messages.
    pub place: String,
    /// Index of the page's line, from 0.
    #[allow(dead_code, reason = "not every user of this file looks at what stands before a line")]
    pub index: usize,
    /// Whose it is.
    pub program: Program,
    /// What follows the program's name, without the comment.
    pub arguments: String,
}

impl Line {
    /// The arguments as a shell splits them, up to a pipe or a redirection.
    pub fn words(&self) -> Vec<String> {
        let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
        for c in self.arguments.chars() {
            match (quote, c) {
                (Some(q), c) if c == q => quote = None,
                (None, '\'' | '"') => {
                    quote = Some(c);
                    word.get_or_insert_default();
                }
                (None, '|' | '>') => break,
                (None, ' ') => words.extend(word.take()),
                _ => word.get_or_insert_default().push(c),
            }
        }
        words.extend(word);
        words
    }
}

/// The root of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// README.md and docs/*.md: name and text.
#[allow(dead_code, reason = "not every user of this file looks at all pages")]
pub fn pages() -> Vec<(String, String)> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = docs.map(|name| format!("docs/{}", name.to_string_lossy())).collect();
    names.retain(|name| Path::new(name).extension().is_some_and(|ext| ext == "md"));
    names.push("README.md".to_owned());
    names.sort();
    names.into_iter().map(|name| (name.clone(), fs::read_to_string(root().join(&name)).unwrap())).collect()
}

/// Whether each line of a page is in a block: indented by four, or fenced.
fn blocks(text: &str) -> Vec<bool> {
    let mut fenced = false;
    text.lines()
        .map(|line| {
            let fence = line.trim_start().starts_with("```");
            fenced ^= fence;
            !fence && (fenced || line.starts_with("    "))
        })
        .collect()
}

/// The command lines of a page: lines of its blocks that start with a program's name, after `$ ` or not.
pub fn lines(page: &str, text: &str) -> Vec<Line> {
    let rows = text.lines().zip(blocks(text)).enumerate().filter(|(_, (_, block))| *block);
    rows.filter_map(|(index, (line, _))| {
        let line = line.trim_start();
        let line = line.strip_prefix("$ ").unwrap_or(line);
        let (rest, program) = STARTS.iter().find_map(|(start, program)| Some((line.strip_prefix(start)?, *program)))?;
        let arguments = rest.split(" #").next().unwrap_or(rest).trim().to_owned();
        Some(Line { place: format!("{page}:{}", index + 1), index, program, arguments })
    })
    .collect()
}

/// The files a page shows: a line that ends in `` `NAME`: `` and the block after it. Index of the line, name, content.
#[allow(dead_code, reason = "xtask's lines read no such files")]
pub fn shown(text: &str) -> Vec<(usize, String, String)> {
    let rows: Vec<&str> = text.lines().collect();
    let block = blocks(text);
    let mut found = Vec::new();
    for (index, row) in rows.iter().enumerate().filter(|(index, _)| !block[*index]) {
        let Some(name) = row.trim_end().strip_suffix("`:").and_then(|row| row.rsplit('`').next()) else { continue };
        let first = rows.iter().skip(index + 1).position(|row| !row.trim().is_empty() && !row.starts_with("```"));
        let Some(first) = first.map(|offset| index + 1 + offset).filter(|first| block[*first]) else { continue };
        // Indented command lines may follow after a blank one; Markdown takes them for the same block.
        let command = |row: &str| STARTS.iter().any(|(start, _)| row.trim_start().starts_with(start));
        let content = rows[first..]
            .iter()
            .zip(&block[first..])
            .take_while(|(row, block)| (**block || row.is_empty()) && !command(row));
        let content: Vec<&str> = content.map(|(row, _)| row.strip_prefix("    ").unwrap_or(row)).collect();
        found.push((index, name.to_owned(), content.join("\n").trim_end().to_owned() + "\n"));
    }
    found
}
