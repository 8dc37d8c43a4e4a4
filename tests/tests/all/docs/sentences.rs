//! Pages and comments are read once: no sentence is longer than a person follows.

use std::fs;

use breakaway::command::Cli;
use breakaway_tests::sentences::{self, MOST_WORDS};
use clap::CommandFactory as _;

use super::citations::sources;
use super::commands::{pages, root};

/// A longer sentence has two things to say: make it two.
#[test]
fn sentences_have_at_most_25_words() {
    let pages = pages();
    assert!(pages.len() >= 20, "only {} pages were found", pages.len());
    let found = |(page, text): &(String, String)| -> Vec<String> {
        let long = sentences::long(text);
        long.iter().map(|long| format!("{page}:{}: {} words: {}", long.line, long.words, long.text)).collect()
    };
    let long: Vec<String> = pages.iter().flat_map(found).collect();
    assert!(long.is_empty(), "more than {MOST_WORDS} words:\n{}", long.join("\n"));
}

/// The README is read before anything is tried.
#[test]
fn the_readme_is_short() {
    const MOST_LINES: usize = 110;
    let pages = pages();
    let readme = pages.iter().find(|(page, _)| page == "README.md").map(|(_, text)| text.lines().count());
    assert!(readme.is_some_and(|lines| (60..=MOST_LINES).contains(&lines)), "{readme:?} lines");
}

/// The help texts of a command, of its options and of the commands below it. Examples and the keys of JSON are no prose.
fn help(command: &clap::Command, texts: &mut Vec<(String, String)>) {
    let styled = [command.get_about(), command.get_long_about(), command.get_after_help()];
    let options = command.get_arguments().flat_map(|option| [option.get_help(), option.get_long_help()]);
    for text in styled.into_iter().chain(options).flatten() {
        let paragraphs = text.to_string().replace("\nJSON", "\n\nJSON");
        let prose = paragraphs.split("\n\n").filter(|paragraph| !paragraph.trim_start().starts_with("JSON"));
        let lines = prose.flat_map(|paragraph| paragraph.lines().filter(|line| !line.starts_with("  ")).chain([""]));
        texts.push((command.get_name().to_owned(), lines.collect::<Vec<_>>().join("\n")));
    }
    for below in command.get_subcommands() {
        help(below, texts);
    }
}

#[test]
fn help_has_sentences_of_at_most_25_words() {
    let mut texts = Vec::new();
    help(&Cli::command(), &mut texts);
    assert!(texts.len() >= 100, "only {} texts were found", texts.len());
    let found = |(command, text): &(String, String)| -> Vec<String> {
        sentences::long(text).iter().map(|long| format!("{command}: {} words: {}", long.words, long.text)).collect()
    };
    let long: Vec<String> = texts.iter().flat_map(found).collect();
    assert!(long.is_empty(), "more than {MOST_WORDS} words:\n{}", long.join("\n"));
}

/// A comment is read beside its code, by someone who has little time for either.
#[test]
fn comments_have_sentences_of_at_most_25_words() {
    const FOLDERS: [&str; 9] = ["bench", "core", "firmware", "fuzz", "host", "python", "tests", "web", "xtask"];
    let mut files = Vec::new();
    for folder in FOLDERS {
        sources(&root().join(folder), &mut files);
    }
    files.retain(|file| file.extension().is_some_and(|kind| kind == "rs"));
    assert!(files.len() >= 400, "only {} sources were found", files.len());
    let mut long = Vec::new();
    for file in files {
        let place = file.strip_prefix(root()).unwrap_or(&file).display().to_string();
        let found = sentences::long_in_comments(&fs::read_to_string(&file).unwrap());
        long.extend(found.iter().map(|long| format!("{place}:{}: {} words: {}", long.line, long.words, long.text)));
    }
    assert!(long.is_empty(), "more than {MOST_WORDS} words:\n{}", long.join("\n"));
}
