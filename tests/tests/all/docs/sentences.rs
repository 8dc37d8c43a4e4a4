//! Pages are read once: no sentence is longer than a person follows.

use breakaway::command::Cli;
use breakaway_tests::sentences::{self, MOST_WORDS};
use clap::CommandFactory as _;

use super::commands::pages;

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
