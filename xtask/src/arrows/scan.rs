//! Which room's source names which other room.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// From a room to each room that it names, with the files that name it.
pub type Arrows = BTreeMap<(String, String), Vec<String>>;

/// The rooms of a crate: the modules at the top of its `src`, without what ties them together (`lib`, `main`, `bin/`).
pub fn rooms(src: &Path) -> Result<Vec<String>> {
    let mut rooms = Vec::new();
    for entry in fs::read_dir(src).with_context(|| src.display().to_string())? {
        let path = entry?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !["lib", "main", "bin"].contains(&name.as_str()) && !rooms.contains(&name) {
            rooms.push(name);
        }
    }
    rooms.sort();
    Ok(rooms)
}

/// The arrows between `rooms`: every `crate::ROOM` outside of comments and tests.
pub fn arrows(src: &Path, rooms: &[String]) -> Result<Arrows> {
    let mut arrows = Arrows::new();
    for file in files(src)? {
        let place = file.strip_prefix(src)?.to_string_lossy().replace('\\', "/");
        let from = place.split(['/', '.']).next().unwrap_or_default();
        if !rooms.iter().any(|room| room == from) {
            continue;
        }
        for to in named(&code(&fs::read_to_string(&file)?)) {
            if to != from && rooms.contains(&to) {
                let places = arrows.entry((from.to_owned(), to)).or_default();
                if !places.contains(&place) {
                    places.push(place.clone());
                }
            }
        }
    }
    Ok(arrows)
}

/// Source files but those of tests, in order.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<Result<Vec<PathBuf>>>()?;
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        if path.file_stem().is_some_and(|name| name == "tests") {
            continue;
        }
        if path.is_dir() {
            found.extend(files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    Ok(found)
}

/// The text without comments and without the tests at its end.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or(text);
    text.lines().map(|line| line.split("//").next().unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

/// The names that follow `crate::`, also those in a group.
fn named(code: &str) -> Vec<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = Vec::new();
    for (at, start) in code.match_indices("crate::") {
        // Not the end of a longer word, as in `in_crate::`.
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '$') {
            continue;
        }
        let rest = &code[at + start.len()..];
        match rest.strip_prefix('{') {
            None => names.push(word(rest)),
            Some(group) => {
                let mut depth = 0;
                let mut first = true;
                for (at, c) in group.char_indices() {
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => break,
                        '}' => depth -= 1,
                        ',' if depth == 0 => first = true,
                        c if first && !c.is_whitespace() => {
                            names.push(word(&group[at..]));
                            first = false;
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_after_crate_are_found_and_others_are_not() {
        let text = "use crate::plant::{Base, State};\nuse crate::{\n    link::Model,\n    scalar::{Real, Q32},\n};\n\
                    // crate::report\nfn f() -> crate::model::Model { breakaway_crate::other() }\n\
                    #[cfg(test)]\nmod tests {\n    use crate::device::Client;\n}\n";
        assert_eq!(named(&code(text)), ["plant", "link", "scalar", "model"]);
    }
}
