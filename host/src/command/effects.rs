//! `breakaway effects`: the catalogue.

mod page;

use std::fmt::Write as _;

use breakaway_core::plant::Kind;
use breakaway_core::plant::effect::{ActsIn, Definition, Parameter, Relation};
use schemars::JsonSchema;
use serde::Serialize;

use super::UsageError;
use super::output::Output;
use crate::model::{known_effects, range};
use crate::nearest::{did_you_mean, nearest};

pub use page::page;

/// The catalogue of effects: law, parameters, what shows each, what it is confused with
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway effects
  breakaway effects stribeck

In units, U stands for the drive's unit and X for the position's.

JSON: effects, a list of name, title, law, acts_in, parameters (symbol, role, unit, meaning, min, max,
default), shown_by, confused_with, generalises, excludes and residue (lists of name and why), repeats, needs_angle,
phase_per_recording, shared_clock, compensation (null where there is none).")]
pub struct Args {
    /// One effect, by its name in the catalogue; all of them without it
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
}

/// The JSON document.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    effects: Vec<Entry>,
}

#[derive(Debug, Serialize, JsonSchema)]
#[allow(clippy::struct_excessive_bools, reason = "as the definition has them")]
struct Entry {
    name: &'static str,
    title: &'static str,
    law: &'static str,
    acts_in: &'static str,
    parameters: Vec<Quantity>,
    shown_by: &'static str,
    confused_with: &'static [&'static str],
    generalises: &'static [&'static str],
    excludes: Vec<Beside>,
    residue: Vec<Beside>,
    repeats: bool,
    needs_angle: bool,
    phase_per_recording: bool,
    shared_clock: bool,
    compensation: Option<&'static str>,
    #[serde(skip)]
    definition: &'static Definition,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Beside {
    name: &'static str,
    why: &'static str,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Quantity {
    symbol: &'static str,
    role: &'static str,
    unit: &'static str,
    meaning: &'static str,
    min: f64,
    max: f64,
    default: Option<f64>,
}

impl From<&'static Definition> for Entry {
    fn from(definition: &'static Definition) -> Self {
        let quantity = |p: &Parameter| {
            let (min, max) = p.canonical_range();
            Quantity {
                symbol: p.symbol,
                role: p.role.name(),
                unit: p.unit,
                meaning: p.meaning,
                min,
                max,
                default: p.default,
            }
        };
        let beside = |relations: &[Relation]| -> Vec<Beside> {
            relations.iter().map(|&Relation { name, why }| Beside { name, why }).collect()
        };
        Self {
            name: definition.name,
            title: definition.title,
            law: definition.law,
            acts_in: match definition.acts_in {
                ActsIn::Drive => "drive",
                ActsIn::Force => "force",
                ActsIn::Mechanics => "mechanics",
                ActsIn::Sensor => "sensor",
            },
            parameters: definition.parameters.iter().map(quantity).collect(),
            shown_by: definition.shown_by,
            confused_with: definition.confused_with,
            generalises: definition.generalises,
            excludes: beside(definition.excludes),
            residue: beside(definition.residue),
            repeats: definition.repeats,
            needs_angle: definition.needs_angle,
            phase_per_recording: definition.phase_per_recording,
            shared_clock: definition.shared_clock,
            compensation: definition.compensation,
            definition,
        }
    }
}

impl Args {
    /// Prints the catalogue or one effect of it.
    ///
    /// # Errors
    /// [`UsageError`] with the nearest name, if there is no such effect.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let Some(name) = self.name else {
            let effects = known_effects().map(Entry::from).collect();
            return output.print(&Document { effects }, list);
        };
        let kind = Kind::from_name(&name).ok_or_else(|| {
            let near = nearest(&name, known_effects().map(|known| known.name));
            UsageError(format!("no effect `{name}`{}; `breakaway effects` lists all", did_you_mean(near)))
        })?;
        let document = Document { effects: vec![kind.definition().into()] };
        output.print(&document, |document| document.effects.iter().map(|entry| one(entry.definition)).collect())
    }
}

fn list(document: &Document) -> String {
    let mut text = String::new();
    for entry in &document.effects {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:<22}{:<33}{}", entry.name, entry.title, entry.law);
    }
    text.push_str("\n`breakaway effects NAME` tells more of one\n");
    text
}

fn one(definition: &Definition) -> String {
    let mut text = format!("{} ({})\n\n", definition.title, definition.name);
    for (topic, saying) in topics(definition) {
        let _ = writeln!(text, "{topic:<15}{saying}");
    }
    text.push('\n');
    for parameter in definition.parameters {
        let [symbol, unit, meaning, range] = row(parameter);
        let _ = writeln!(text, "{symbol:<8}{unit:<10}{range:<24}{meaning}");
    }
    text
}

fn topics(definition: &Definition) -> Vec<(&'static str, String)> {
    let confused = match definition.confused_with {
        [] => "nothing in the catalogue".to_owned(),
        names => names.join(", "),
    };
    let place = match definition.acts_in {
        ActsIn::Drive => "the drive, between what is commanded and what acts",
        ActsIn::Force => "the balance of forces",
        ActsIn::Mechanics => "mechanics with a state of its own",
        ActsIn::Sensor => "the sensor, between the true and the measured position",
    };
    let mut topics = vec![
        ("law", definition.law.to_owned()),
        ("acts in", place.to_owned()),
        ("shown by", definition.shown_by.to_owned()),
        ("confused with", confused),
    ];
    if !definition.generalises.is_empty() {
        topics.push(("generalises", definition.generalises.join(", ")));
    }
    if !definition.excludes.is_empty() {
        topics.push(("excludes", reasons(definition.excludes)));
    }
    if !definition.residue.is_empty() {
        topics.push(("leaves", format!("what looks like {}", reasons(definition.residue))));
    }
    let needs = [
        (definition.needs_angle, "needs", "the position as an angle in radians"),
        (
            definition.phase_per_recording,
            "phase",
            "belongs to the encoder's zero, which may differ from recording to recording",
        ),
        (definition.shared_clock, "clock", "the recordings must share one"),
        (definition.repeats, "repeats", "a model may have several, with other parameters"),
    ];
    topics.extend(needs.into_iter().filter(|(applies, ..)| *applies).map(|(_, topic, text)| (topic, text.to_owned())));
    let compensation = definition.compensation.unwrap_or("none, since a controller cannot cancel it");
    topics.push(("compensation", compensation.to_owned()));
    topics
}

/// The names with their reasons; names that follow each other for the same reason share it.
fn reasons(relations: &[Relation]) -> String {
    let groups = relations.chunk_by(|a, b| a.why == b.why);
    let said = groups.map(|group| {
        let names: Vec<&str> = group.iter().map(|relation| relation.name).collect();
        format!("{} ({})", names.join(", "), group.first().map_or("", |relation| relation.why))
    });
    said.collect::<Vec<_>>().join("; ")
}

/// Symbol, unit, meaning, range.
fn row(parameter: &Parameter) -> [String; 4] {
    let mut range = range(parameter);
    if let Some(default) = parameter.default {
        let _ = write!(range, " (if left out: {default})");
    }
    [parameter.symbol.to_owned(), parameter.unit.to_owned(), parameter.meaning.to_owned(), range]
}
