//! The report's first sentences: what was missing, how much of the gap it explains, and what is left.

use crate::discover::outcome::{Discovery, Verdict};

/// What was missing, how much of the unexplained force it explains, and what is left.
pub fn sentence(found: &Discovery) -> String {
    let mut sentences = vec![missing(found)];
    sentences.extend(explained(found));
    sentences.extend(left(found));
    sentences.join(" ")
}

fn missing(found: &Discovery) -> String {
    let mut titles: Vec<String> = Vec::new();
    for effect in &found.effects {
        let title = effect.kind.definition().title.to_lowercase();
        if !titles.contains(&title) {
            titles.push(title);
        }
    }
    match (found.verdict, titles.as_slice()) {
        (Verdict::NothingMissing, _) => "Nothing is missing.".to_owned(),
        (_, []) => {
            let place = found.where_map.first().map_or("no coordinate", |row| row.coordinate);
            let predictable = found.force.and_then(|force| force.predictable);
            if predictable.is_some() || found.force.is_none() {
                format!("Something is missing that no effect of the catalogue explains; it lives along {place}.")
            } else {
                "These recordings cannot tell whether something is missing.".to_owned()
            }
        }
        (_, [one]) => format!("The model missed {one}."),
        (_, several) => format!("The model missed {}.", several.join(" and ")),
    }
}

/// The share of the unexplained force, or of the simulation error where that tells more.
fn explained(found: &Discovery) -> Option<String> {
    let (first, last) = (found.ladder.first()?, found.ladder.last()?);
    if found.effects.is_empty() {
        return None;
    }
    let over = |rmse: f64| rmse / found.noise_floor;
    let simulation = format!(
        "the held-out simulation error falls from {:.1} to {:.1} times the noise",
        over(first.holdout_rmse),
        over(last.holdout_rmse)
    );
    let force = found.force.map(|force| 1.0 - (force.drive[1] / force.drive[0]).powi(2)).filter(|share| *share >= 0.01);
    Some(match force {
        Some(share) => format!("It explains {:.0} % of the unexplained force; {simulation}.", 100.0 * share),
        None => format!("With it {simulation}."),
    })
}

/// Held-out simulation error over the sensor's noise up to which nothing else is left: 80 segments of 400 samples tell the noise to
/// half a per cent, and its estimate is of a few.
const AT_THE_NOISE: f64 = 1.1;

fn left(found: &Discovery) -> Option<String> {
    let force = found.force?;
    if found.over_noise() < AT_THE_NOISE {
        return Some("What is left is within the sensor's noise.".to_owned());
    }
    let size = format!(
        "{:.2} % of the drive ({:.2e} {} below {:.0} Hz)",
        100.0 * force.random_share,
        force.random,
        found.units.u,
        force.bandwidth_hz
    );
    Some(match force.predictable {
        Some(by) => format!("What is left is {size}; a part of it is predictable, best by {}.", by.replace('_', " ")),
        None => format!("What is left is random force of {size}."),
    })
}
