//! The pages as a site: docs/SUMMARY.md has each of them, and every link leads to a file and to a heading in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use super::commands::{pages, root};

/// The order of the site; no page of it.
const SUMMARY: &str = "docs/SUMMARY.md";

/// The targets of the links of a text, each with its line from 1. Blocks and code have none.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut fenced = false;
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        fenced ^= line.trim_start().starts_with("```");
        if fenced || line.starts_with("    ") {
            continue;
        }
        // What stands in backticks is code; a link's own text may be code, and its target never is.
        for (k, part) in line.split("](").enumerate() {
            if k > 0
                && let Some((target, _)) = part.split_once(')')
            {
                found.push((number + 1, target.to_owned()));
            }
        }
    }
    found
}

/// The anchor of a heading, as GitHub and mdBook make it: small letters, `-` for a space, no other signs.
fn anchor(heading: &str) -> String {
    // Of a link its text counts.
    let text: String = heading
        .split("](")
        .enumerate()
        .map(|(k, part)| if k == 0 { part } else { part.split_once(')').map_or("", |(_, rest)| rest) })
        .collect();
    let kept = text.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, '-' | '_' | ' '));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

/// The anchors of a page; a heading that comes again has a number.
fn anchors(text: &str) -> BTreeSet<String> {
    let (mut fenced, mut anchors) = (false, BTreeSet::new());
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    for line in text.lines() {
        fenced ^= line.trim_start().starts_with("```");
        let heading = line.trim_start_matches('#');
        if !fenced && heading.len() < line.len() && heading.starts_with(' ') {
            let first = anchor(heading);
            let before = seen.entry(first.clone()).or_default();
            anchors.insert(if *before == 0 { first } else { format!("{first}-{before}") });
            *before += 1;
        }
    }
    anchors
}

/// `page` and a link in it: the file it leads to, from the root.
fn resolved(page: &str, target: &str) -> PathBuf {
    let mut path = Path::new(page).parent().map(Path::to_path_buf).unwrap_or_default();
    for part in Path::new(target).components() {
        match part {
            Component::ParentDir => _ = path.pop(),
            Component::CurDir => {}
            part => path.push(part),
        }
    }
    path
}

/// A page that is written and not listed has no place on the site; one that is listed and not there breaks its build.
#[test]
fn the_summary_lists_every_page_once() {
    let pages = pages();
    let summary = &pages.iter().find(|(name, _)| name == SUMMARY).expect("docs/SUMMARY.md").1;
    let listed: Vec<String> = links(summary).into_iter().map(|(_, target)| format!("docs/{target}")).collect();
    let written: BTreeSet<&str> = pages
        .iter()
        .map(|(name, _)| name.as_str())
        .filter(|name| name.starts_with("docs/") && *name != SUMMARY)
        .collect();
    assert_eq!(listed.iter().map(String::as_str).collect::<BTreeSet<_>>(), written);
    assert_eq!(listed.len(), written.len(), "a page is listed twice");
    // In the site each page has the title that it has itself.
    for line in summary.lines().filter_map(|line| line.strip_prefix("- [")) {
        let (title, rest) = line.split_once("](").unwrap();
        let name = format!("docs/{}", rest.trim_end_matches(')'));
        let own = pages.iter().find(|(page, _)| *page == name).and_then(|(_, text)| text.lines().next()).unwrap();
        assert_eq!(own, format!("# {title}"), "{name}");
    }
}

/// A link with `#` leads to a heading of the page that it names, or of its own.
#[test]
fn anchors_are_headings() {
    let pages = pages();
    let mut seen = 0;
    for (page, text) in &pages {
        for (line, target) in links(text).into_iter().filter(|(_, target)| !target.contains("://")) {
            let Some((file, name)) = target.split_once('#') else { continue };
            let file = if file.is_empty() { PathBuf::from(page) } else { resolved(page, file) };
            let text =
                std::fs::read_to_string(root().join(&file)).unwrap_or_else(|e| panic!("{page}:{line}: {target}: {e}"));
            assert!(anchors(&text).contains(name), "{page}:{line}: {target}: there are {:?}", anchors(&text));
            seen += 1;
        }
    }
    assert!(seen >= 5, "only {seen} links to headings were found");
}

/// The site has the pages and the figures of docs alone: a link to another folder would lead nowhere there.
#[test]
fn links_of_the_site_stay_in_it() {
    for (page, text) in pages().iter().filter(|(page, _)| page.starts_with("docs/")) {
        for (line, target) in links(text).into_iter().filter(|(_, target)| !target.contains("://")) {
            let file = target.split('#').next().unwrap_or_default();
            let inside = resolved(page, file).starts_with("docs") || file.is_empty();
            assert!(inside, "{page}:{line}: {target} is outside of the site");
        }
    }
}
