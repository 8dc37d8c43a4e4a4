//! The catalogue as a page of documentation.

use std::fmt::Write as _;

use breakaway_core::plant::Kind;
use breakaway_core::plant::effect::ActsIn;

use super::{row, topics};
use crate::model::known_effects;

/// The effects of the drive, in the order in which they act.
fn along_the_drive() -> Vec<&'static str> {
    let mut drive: Vec<Kind> = Kind::ALL.iter().copied().filter(|kind| kind.acts_in() == ActsIn::Drive).collect();
    drive.sort_by_key(|kind| kind.along_the_drive());
    drive.iter().map(|kind| kind.name()).collect()
}

/// What the page says before its list of effects, a paragraph per line.
const INTRODUCTION: [&str; 4] = [
    "The base model is `b·ẍ + c·ẋ + f1·sgn(ẋ) = u`. An effect is a named term on top of it. Its law is \
     the force that it adds to `b·ẍ = u − c·ẋ − f1·sgn(ẋ)`, or the change that it makes to the drive `u_a` or to the \
     measured position. In units, `U` stands for the drive's unit and `X` for the position's.",
    "A model file has an `[[effect]]` with `name` and the parameters by symbol. Its phases may lie outside the range \
     that is given here, since whole turns change nothing. This page is generated from the definitions in \
     `core/src/plant/effect`; `breakaway effects NAME` prints the same.",
    "An effect *generalises* others if it becomes them with certain parameters or in a limit. It *excludes* others if \
     one model cannot hold both. It *leaves* what looks like others if its law idealises something. One of those is \
     named beside it only on more evidence than the simulation's.",
    "A *phase* or a *clock* says what recordings must share to be explained by one set of parameters.",
];

/// The catalogue as a page of documentation: `docs/effects.md`.
pub fn page() -> String {
    let mut text = "# The effects\n\n".to_owned();
    let order = format!(
        "Effects of the drive act one after the other in this order, whatever their order in the file: {}.",
        along_the_drive().join(", ")
    );
    for paragraph in INTRODUCTION.into_iter().chain([order.as_str()]) {
        let _ = writeln!(text, "{}\n", wrapped(paragraph, ""));
    }
    for definition in known_effects() {
        let _ = writeln!(text, "- [{}](#{})", definition.title, definition.name);
    }
    for definition in known_effects() {
        let _ = writeln!(text, "\n## {}\n\n{}\n", definition.name, definition.title);
        for (topic, saying) in topics(definition) {
            let tick = if topic == "law" { "`" } else { "" };
            let _ = writeln!(text, "{}", wrapped(&format!("- {topic}: {tick}{saying}{tick}"), "  "));
        }
        text.push_str("\n| symbol | unit | meaning | range |\n|---|---|---|---|\n");
        for parameter in definition.parameters {
            let [symbol, unit, meaning, range] = row(parameter);
            let _ = writeln!(text, "| `{symbol}` | {unit} | {meaning} | {range} |");
        }
    }
    text
}

/// The text in lines of at most 100 characters, all but the first after `indent`.
fn wrapped(text: &str, indent: &str) -> String {
    const WIDTH: usize = 100;
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            Some(_) => lines.push(format!("{indent}{word}")),
            None => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}
