//! What a card must be: complete, and with a model that simulates what was held out.

use std::path::Path;

use super::card::{Card, File};
use super::held_out;
use crate::fit::Candidate;
use crate::fleet::hash::Hashing;
use crate::recording::{ReadOptions, Recording};

/// Largest relative difference of an error that is computed again, on another system.
const SAME: f64 = 0.02;

/// What is wrong with a card by itself, one sentence each.
pub fn faults(card: &Card) -> Vec<String> {
    let mut faults = Vec::new();
    let mut must = |holds: bool, sentence: String| {
        if !holds {
            faults.push(sentence);
        }
    };
    let head = &card.head;
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    must(!head.name.is_empty() && head.name.chars().all(plain), "its name needs a-z, 0-9 and - alone".to_owned());
    for (key, text) in [
        ("machine", &head.machine),
        ("source", &head.source),
        ("repeat", &head.repeat),
        ("licence", &card.data.licence),
    ] {
        must(!text.trim().is_empty(), format!("`{key}` says nothing"));
    }
    must(!card.data.file.is_empty(), "it names no recording".to_owned());
    for File { name, sha256 } in &card.data.file {
        let hex = sha256.len() == 64 && sha256.chars().all(|c| c.is_ascii_hexdigit());
        must(hex, format!("the SHA-256 of {name} has not 64 digits"));
    }
    let [from, to] = card.range.position;
    must(from < to && card.range.speed > 0.0 && card.range.drive > 0.0, "its range is empty".to_owned());
    let held = &card.held_out;
    must(
        held.windows > 0 && held.rmse > 0.0 && held.rmse < held.standstill_rmse,
        format!(
            "held out, it errs by {:.3e}, and an axis that stands still by {:.3e}",
            held.rmse, held.standstill_rmse
        ),
    );
    faults
}

/// What is wrong with a card beside its recordings, which are in `folder`: their hashes and the held-out error.
///
/// # Errors
/// A recording that cannot be read.
pub fn faults_beside(card: &Card, folder: &Path) -> anyhow::Result<Vec<String>> {
    let mut faults = faults(card);
    for File { name, sha256 } in &card.data.file {
        let found = Hashing::new(std::fs::File::open(folder.join(name))?).finish()?;
        if found != *sha256 {
            faults.push(format!("{name} is another file than the card was made from"));
        }
    }
    let recordings = recordings(card, folder)?;
    let candidate = Candidate { base: card.model.base, effects: card.model.plant_effects()? };
    let again = held_out::score(&candidate, &recordings, card.held_out.window_s);
    let rmse = again.map_or(f64::INFINITY, |score| score.rmse);
    if (rmse / card.held_out.rmse - 1.0).abs() > SAME {
        faults.push(format!("held out, it errs by {rmse:.4e}, and the card says {:.4e}", card.held_out.rmse));
    }
    Ok(faults)
}

/// The recordings of a card, as its model was made from them.
///
/// # Errors
/// A recording that cannot be read.
pub fn recordings(card: &Card, folder: &Path) -> anyhow::Result<Vec<Recording>> {
    let data = &card.data;
    let select: Result<_, String> = data.select.iter().map(|condition| condition.parse()).collect();
    let options = ReadOptions {
        time: Some(data.time.clone()),
        input: Some(data.input.clone()),
        position: Some(data.position.clone()),
        select: select.map_err(anyhow::Error::msg)?,
        counts_per_turn: card.motor.counts_per_turn,
        ..ReadOptions::default()
    };
    let mut recordings = Vec::new();
    for File { name, .. } in &data.file {
        let mut recording = Recording::read(&folder.join(name), &options)?;
        recording.in_radians();
        if recording.moves() {
            recordings.push(recording);
        }
    }
    Ok(recordings)
}
