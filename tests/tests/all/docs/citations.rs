//! What comments and pages cite is there: every `NAME.md` in the source, and the section after it, by number or by title.

use std::fs;
use std::path::{Path, PathBuf};

use super::commands::root;

/// Folders that hold no source of this project.
const NOT_SOURCE: [&str; 3] = ["target", ".git", "corpus"];

/// Source files below a folder.
pub fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() && !NOT_SOURCE.iter().any(|folder| name == *folder) {
            sources(&path, found);
        } else if path.extension().is_some_and(|kind| ["rs", "toml", "md"].iter().any(|known| kind == *known)) {
            found.push(path);
        }
    }
}

/// The page of a citation: the path as it stands, else beside the citing file, else among the pages.
fn page(cited: &str, beside: &Path) -> Option<String> {
    let places = [root().join(cited), beside.join(cited), root().join("docs").join(cited)];
    places.iter().find_map(|place| fs::read_to_string(place).ok())
}

/// The anchor that a heading has on the project's page.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase().replace(' ', "-");
    kept.chars().filter(|c| c.is_alphanumeric() || "-_".contains(*c)).collect()
}

/// The heading that a citation asks for, from the text after the page's name; `None` where it names none.
#[derive(Debug, PartialEq)]
enum Section<'a> {
    Number(&'a str),
    Title(&'a str),
    Anchor(&'a str),
}

fn section(rest: &str) -> Option<Section<'_>> {
    if let Some(anchor) = rest.strip_prefix('#') {
        return Some(Section::Anchor(anchor.split([')', ' ', '`', '"']).next()?));
    }
    let rest = rest.strip_prefix(')').unwrap_or(rest);
    let rest = rest.trim_start_matches(',').trim_start();
    let rest = rest.strip_prefix("sections ").or_else(|| rest.strip_prefix("section "))?;
    if let Some(title) = rest.strip_prefix('"') {
        return Some(Section::Title(title.split('"').next()?));
    }
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    (end > 0).then(|| Section::Number(&rest[..end]))
}

fn has(page: &str, section: &Section<'_>) -> bool {
    let mut headings =
        page.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    match section {
        Section::Number(number) => headings.any(|heading| heading.starts_with(&format!("{number}. "))),
        Section::Title(title) => headings.any(|heading| heading == *title),
        Section::Anchor(asked) => headings.any(|heading| anchor(heading) == *asked),
    }
}

#[test]
fn cited_pages_and_sections_exist() {
    let mut files = Vec::new();
    sources(&root(), &mut files);
    let (mut seen, mut wrong) = (0, Vec::new());
    for file in files {
        // This file has citations that are none.
        if file.ends_with(file!().rsplit('/').next().unwrap()) {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        let beside = file.parent().unwrap();
        for (number, line) in text.lines().enumerate() {
            for (at, _) in line.match_indices(".md") {
                let before = &line[..at];
                let start = before
                    .rfind(|c: char| !(c.is_alphanumeric() || "-_./".contains(c)))
                    .map_or(0, |k| k + before[k..].chars().next().map_or(0, char::len_utf8));
                let (cited, rest) = (&line[start..at + 3], &line[at + 3..]);
                // Patterns, places for a name, pages on the web, and in source what is no comment or is a file to be written: `simulate.md`.
                let is_source = file.extension().is_some_and(|kind| kind == "rs");
                let is_text = is_source && (!line[..start].contains("//") || line[..start].ends_with('`'));
                if is_text
                    || cited == ".md"
                    || cited.contains("NAME")
                    || line[..start].ends_with(['*', '}', ':'])
                    || rest.starts_with(char::is_alphanumeric)
                {
                    continue;
                }
                let place = format!("{}:{}", file.strip_prefix(root()).unwrap_or(&file).display(), number + 1);
                let Some(page) = page(cited, beside) else {
                    wrong.push(format!("{place}: no page {cited}"));
                    continue;
                };
                seen += 1;
                if let Some(section) = section(rest)
                    && !has(&page, &section)
                {
                    wrong.push(format!("{place}: {cited} has no {section:?}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(seen >= 100, "only {seen} citations were found: are they still recognised?");
}

#[test]
fn sections_are_recognised() {
    assert_eq!(section(", section 3: more"), Some(Section::Number("3")));
    assert_eq!(section(", sections 2 and 4)"), Some(Section::Number("2")));
    assert_eq!(section("), section 6;"), Some(Section::Number("6")));
    assert_eq!(section(", section \"The PID\";"), Some(Section::Title("The PID")));
    assert_eq!(section("#7-errata)"), Some(Section::Anchor("7-errata")));
    assert_eq!(section(" has it"), None);
    let page = "# Theory\n## 7. Errata\n### Cramér–Rao bounds\n";
    for (section, there) in [
        (Section::Number("7"), true),
        (Section::Number("8"), false),
        (Section::Title("Cramér–Rao bounds"), true),
        (Section::Title("Cramér"), false),
        (Section::Anchor("7-errata"), true),
        (Section::Anchor("errata"), false),
    ] {
        assert_eq!(has(page, &section), there, "{section:?}");
    }
}
