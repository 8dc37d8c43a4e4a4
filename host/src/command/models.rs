//! `breakaway models`.

pub mod add;

use std::fmt::Write as _;

use clap::Subcommand;
use serde::Serialize;

use super::output::Output;
use crate::file::{FileKind, Target};
use crate::models::card::{Constants, Data, Head, HeldOut, Range};
use crate::models::compare::{Line, Quantity, compare, parameters};
use crate::models::page::effects;
use crate::models::{self, Card};
use crate::report::text::{number, quantity, range};

/// The motor library: cards of identified machines
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:
  breakaway models list
  breakaway models show emps -o emps.toml
  breakaway models compare emps ak80
  breakaway models add model.toml rec.csv --name arm --machine 'arm, joint 1' --source me --licence CC0-1.0 -o arm.toml

JSON of list: version, cards (name, machine, effects, units, held_out).
JSON of show: version, card, data, motor, range, held_out, units, parameters (name, value, se, unit).
JSON of compare: version, first, second, parameters (parameter, first, second, ratio).
JSON of add: version, card (the file), name, held_out.")]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub action: Action,
}

/// What to do with the library.
#[derive(Debug, Subcommand)]
pub enum Action {
    /// List the cards
    List,
    /// Show a card, or write its model to a file
    Show(ShowArgs),
    /// Show the parameters of two cards side by side
    Compare(CompareArgs),
    /// Make a card from a model and its recordings, and check it
    Add(Box<add::Args>),
}

/// Arguments of `show`.
#[derive(clap::Args, Debug)]
pub struct ShowArgs {
    /// Name of a card, or the path of one
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Write the card's model to this file; `-` is standard output
    #[arg(short, long, value_name = "M.toml")]
    pub output: Option<Target>,
}

/// Arguments of `compare`.
#[derive(clap::Args, Debug)]
pub struct CompareArgs {
    /// Name or path of a card
    #[arg(value_name = "A")]
    pub first: String,
    /// Name or path of another
    #[arg(value_name = "B")]
    pub second: String,
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Debug, Serialize, schemars::JsonSchema)]
pub(in crate::command) struct List {
    version: &'static str,
    cards: Vec<Listed>,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
struct Listed {
    name: String,
    machine: String,
    effects: Vec<String>,
    units: crate::recording::Units,
    held_out: HeldOut,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
pub(in crate::command) struct Shown<'a> {
    version: &'static str,
    card: &'a Head,
    data: &'a Data,
    motor: &'a Constants,
    range: &'a Range,
    held_out: &'a HeldOut,
    units: &'a crate::recording::Units,
    parameters: Vec<Parameter>,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
struct Parameter {
    name: String,
    #[serde(flatten)]
    quantity: Quantity,
}

#[derive(Debug, Serialize, schemars::JsonSchema)]
pub(in crate::command) struct Compared<'a> {
    version: &'static str,
    first: &'a str,
    second: &'a str,
    parameters: Vec<Line>,
}

impl Args {
    /// Lists, shows, compares, or makes a card.
    ///
    /// # Errors
    /// A card that is not there, cannot be read, or fails its check.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        match self.action {
            Action::List => list(output),
            Action::Show(args) => args.run(output),
            Action::Compare(args) => args.run(output),
            Action::Add(args) => args.run(output),
        }
    }
}

fn list(output: Output) -> anyhow::Result<()> {
    let cards = models::all()?;
    let listed = |card: &Card| Listed {
        name: card.head.name.clone(),
        machine: card.head.machine.clone(),
        effects: card.model.effects.iter().map(|entry| entry.name.clone()).collect(),
        units: card.model.units.clone(),
        held_out: card.held_out,
    };
    let document = List { version: VERSION, cards: cards.iter().map(listed).collect() };
    output.print(&document, |document| {
        let line =
            |(listed, card): (&Listed, &Card)| format!("{:<10}{:<52}{}\n", listed.name, listed.machine, effects(card));
        let lines: String = document.cards.iter().zip(&cards).map(line).collect();
        format!("{lines}\n`breakaway models show NAME` tells more of one")
    })
}

impl ShowArgs {
    fn run(self, output: Output) -> anyhow::Result<()> {
        let targets: Vec<_> = self.output.iter().map(|target| (target, FileKind::Model)).collect();
        let output = output.claim(&targets, &[])?;
        let card = models::card(&self.name)?;
        if let Some(target) = &self.output {
            let mut model = card.model.clone();
            // The mark by which the file is known as breakaway's own.
            model.provenance = vec![
                format!("identified by breakaway {VERSION}: card {} of the motor library", card.head.name),
                card.head.machine.clone(),
            ];
            target.write_text(&model.to_toml())?;
        }
        let quantities = parameters(&card).into_iter().map(|(name, quantity)| Parameter { name, quantity });
        let document = Shown {
            version: VERSION,
            card: &card.head,
            data: &card.data,
            motor: &card.motor,
            range: &card.range,
            held_out: &card.held_out,
            units: &card.model.units,
            parameters: quantities.collect(),
        };
        output.print(&document, shown)
    }
}

fn shown(document: &Shown<'_>) -> String {
    let Head { name, machine, source, repeat } = document.card;
    let (x, u) = (&document.units.x, &document.units.u);
    let mut text = format!("{name}: {machine}\n");
    let between = document.range;
    let held = document.held_out;
    let rows = [
        ("source", source.clone()),
        ("licence", document.data.licence.clone()),
        ("recordings", document.data.file.len().to_string()),
        (
            "valid for",
            format!(
                "{} {x}, up to {} {x}/s and {} {u}",
                range(between.position),
                number(between.speed, 4),
                number(between.drive, 4)
            ),
        ),
        (
            "held out",
            format!(
                "{} over {} windows of {} s; standing still {}",
                quantity(held.rmse, x, 4),
                held.windows,
                held.window_s,
                quantity(held.standstill_rmse, x, 4)
            ),
        ),
        ("again by", repeat.clone()),
    ];
    for (what, value) in rows {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "  {what:<12}{value}");
    }
    for Parameter { name, quantity } in &document.parameters {
        let _ = writeln!(text, "  {name:<30}{}", in_words(quantity));
    }
    text
}

fn in_words(quantity: &Quantity) -> String {
    format!("{} {}", quantity.text(), quantity.unit)
}

impl CompareArgs {
    fn run(self, output: Output) -> anyhow::Result<()> {
        let (first, second) = (models::card(&self.first)?, models::card(&self.second)?);
        let parameters = compare(&first, &second);
        let document = Compared { version: VERSION, first: &first.head.name, second: &second.head.name, parameters };
        output.print(&document, |document| {
            let cell = |quantity: &Option<Quantity>| quantity.as_ref().map_or_else(|| "–".to_owned(), in_words);
            let mut text = format!("{:<28}{:<44}{:<44}ratio\n", "", document.first, document.second);
            for line in &document.parameters {
                let ratio = line.ratio.map_or_else(|| "–".to_owned(), |ratio| format!("{ratio:.3}"));
                // Writing to a String cannot fail.
                let _ =
                    writeln!(text, "{:<28}{:<44}{:<44}{ratio}", line.parameter, cell(&line.first), cell(&line.second));
            }
            text
        })
    }
}
