//! The report's first line: what was missing, how much of the unexplained force it explains, and what is left.

use super::horizon::Horizon;
use crate::discover::outcome::{Discovery, Verdict, WhereRow};
use crate::report::text::{number, quantity};

/// Titles whose first word is a name or an abbreviation, and keeps its capital letter in a sentence.
const PROPER: [&str; 4] = ["Stribeck", "LuGre", "Dahl", "PWM"];
/// Cross-validated share of the force below which a coordinate says nothing about the gap. The averages over an
/// unrelated coordinate reach a few per cent by chance.
pub(super) const PREDICTS: f64 = 0.05;
/// Share of the unexplained force below which the simulation error tells more of what an effect explains.
const TOLD_BY_FORCE: f64 = 0.01;
/// Held-out simulation error over the sensor's noise up to which nothing else is left. 80 segments of 400 samples
/// give the noise to half a per cent, and its estimate is good to a few.
const AT_THE_NOISE: f64 = 1.1;

/// What was missing, how much of the unexplained force it explains, and what is left as random force, in one line.
pub fn sentence(found: &Discovery) -> String {
    let mut sentences = vec![missing(found)];
    sentences.extend(explained(found));
    sentences.extend(left(found));
    sentences.join(" ")
}

/// An effect's title within a sentence.
pub(super) fn within_a_sentence(title: &str) -> String {
    if PROPER.iter().any(|name| title.starts_with(name)) {
        return title.to_owned();
    }
    let mut letters = title.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// The coordinate that predicts most of the unexplained force, if one predicts any.
pub(super) fn place(found: &Discovery) -> Option<&WhereRow> {
    found.where_map.first().filter(|row| row.r2 >= PREDICTS)
}

/// The titles of the named effects, each once: a ripple has a name for each of its waves.
fn titles(found: &Discovery) -> Vec<String> {
    let mut titles: Vec<String> = Vec::new();
    for effect in &found.effects {
        let title = within_a_sentence(effect.kind.definition().title);
        if !titles.contains(&title) {
            titles.push(title);
        }
    }
    titles
}

fn missing(found: &Discovery) -> String {
    match (found.verdict, titles(found).as_slice()) {
        (Verdict::NothingMissing, _) => "Nothing is missing.".to_owned(),
        (_, []) if found.force.is_some_and(|force| force.predictable.is_none()) => {
            let reason = if place(found).is_none() { ": no coordinate predicts the unexplained force" } else { "" };
            format!("These recordings cannot tell whether something is missing{reason}.")
        }
        (_, []) => match place(found) {
            Some(row) => format!(
                "Something is missing that no effect of the catalogue explains. The coordinate {} predicts {:.0} % of it.",
                row.coordinate,
                100.0 * row.r2
            ),
            None => {
                "Something is missing that no effect of the catalogue explains. No coordinate predicts it.".to_owned()
            }
        },
        (_, [one]) => format!("The model missed {one}."),
        (_, several) => format!("The model missed {}.", several.join(" and ")),
    }
}

/// The share of the unexplained force, or the simulation error over the report's horizon where that tells more.
fn explained(found: &Discovery) -> Option<String> {
    let (first, last) = (found.ladder.first()?, found.ladder.last()?);
    if found.effects.is_empty() {
        return None;
    }
    let several = titles(found).len() > 1;
    let share = found.force.map(|force| 1.0 - (force.drive[1] / force.drive[0]).powi(2));
    if let Some(share) = share.filter(|share| *share >= TOLD_BY_FORCE) {
        let it = if several { "Together they explain" } else { "It explains" };
        return Some(format!("{it} {:.0} % of the unexplained force.", 100.0 * share));
    }
    let horizon = Horizon::of(found);
    let errors = [first, last].map(|rung| horizon.error(rung));
    // Behind teeth a simulated rotor may be off by one, although the force falls.
    let moves = if errors[1] < errors[0] { "falls" } else { "rises" };
    let [before, after] = errors.map(|error| quantity(error, &found.units.x, 2));
    let with = if several { "them" } else { "it" };
    Some(format!("With {with} the held-out simulation error {} {moves} from {before} to {after}.", horizon.words()))
}

fn left(found: &Discovery) -> Option<String> {
    let force = found.force?;
    let share = number(100.0 * force.random_share, 2);
    Some(if found.effects.is_empty() && found.verdict != Verdict::NothingMissing {
        format!("It is a force of {share} % of the drive.")
    } else if found.over_noise() < AT_THE_NOISE {
        format!("What is left is the sensor's noise; as random force it is at most {share} % of the drive.")
    } else if let Some(by) = force.predictable {
        let by = by.replace('_', " ");
        format!("What is left is a force of {share} % of the drive; {by} predicts a part of it.")
    } else if found.verdict == Verdict::PartlyExplained {
        format!("What is left is a force of {share} % of the drive; nothing that was tried predicts it.")
    } else {
        format!("What is left is random force of {share} % of the drive.")
    })
}
