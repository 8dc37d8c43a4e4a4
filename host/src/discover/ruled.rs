//! The judge's ruling on the recordings of a discovery: by the sensor's clock, from one zero, beside known effects.

use std::ops::RangeInclusive;

use breakaway_core::plant::Effect;

use super::clock::{Clocked, clocked, with_delay};
use super::judge::ruling::{ALL_WIDTHS, Ruling, rule_within};
use super::judge::settings::Settings;
use super::judge::zeros;
use super::known::without_effects;
use super::replication::replicated;
use super::request::Request;
use crate::fit::Candidate;
use crate::recording::{Recording, Units};

/// Most times that the recordings are moved to one zero.
const REZEROED: usize = 3;

/// A ruling, and the recordings on which it was made.
#[derive(Clone, Debug)]
pub struct Ruled {
    /// The request, with one row for each reading of the sensor and one zero for all recordings.
    pub request: Request,
    /// The ruling on the recordings to fit; `None` where they hold too little motion.
    pub ruling: Option<Ruling>,
    /// Age of the sensor's readings, s; `None` where none was found, or where a delay of the loop was named for it.
    pub age_s: Option<f64>,
    /// Whether the recordings were moved to one zero.
    pub rezeroed: bool,
}

/// Rules on a request, beside the effects of its model. Positions move only where a law of the position shows that each
/// recording had its own zero. Where all recordings together name nothing, the ruling is on those that name something
/// alone.
pub fn ruled(request: &Request, units: &Units, settings: &Settings) -> Ruled {
    let Clocked { mut request, age_s, as_seen } = clocked(request, settings);
    let known = request.model.clone();
    let rule = |recordings: &[Recording], half_widths_s: RangeInclusive<f64>| {
        rule_beside(recordings, known.as_ref(), half_widths_s, units, settings)
    };
    let mut ruling = rule(&request.recordings, ALL_WIDTHS);
    let mut rezeroed = false;
    // A second law of the position may tell the zeros better than the first did.
    for _ in 0..REZEROED {
        let Some((first, own)) = request.recordings.first().zip(ruling.as_ref()) else { break };
        let all: Vec<Recording> = request.recordings.iter().chain(&request.holdout).cloned().collect();
        let Some(shifts) = zeros::shifts(&all, first, own, settings) else { break };
        let moved = request.recordings.iter_mut().chain(&mut request.holdout).zip(shifts);
        moved.for_each(|(recording, shift)| recording.x.iter_mut().for_each(|x| *x += shift));
        rezeroed = true;
        // The other windows named nothing before, or were less evident.
        ruling = rule(&request.recordings, own.half_width_s..=own.half_width_s);
    }
    if ruling.as_ref().is_none_or(|ruling| ruling.findings.is_empty()) {
        ruling = replicated(&request.recordings, |own| rule(own, ALL_WIDTHS)).or(ruling);
    }
    let by_clock = Ruled { request, ruling, age_s, rezeroed };
    let beside = |recordings: &[Recording], names: Option<&Candidate>| {
        let all = [known.as_ref(), names].into_iter().flatten();
        let effects: Vec<Effect<f64>> = all.clone().flat_map(|own| own.effects.clone()).collect();
        let known = all.last().map(|own| Candidate { base: own.base, effects });
        rule_beside(recordings, known.as_ref(), ALL_WIDTHS, units, settings)
    };
    let late = as_seen.and_then(|as_seen| with_delay(&by_clock, as_seen, beside));
    match late {
        Some((request, ruling)) => Ruled { request, ruling: Some(ruling), age_s: None, rezeroed },
        None => by_clock,
    }
}

/// Whether a model leaves little of the forces, and nothing that can be predicted. The simulation error alone does not
/// tell, because random torque raises it too. So the judge rules once more, beside the model's effects. Two kinds of
/// model are left as they are. The force of a second body cannot be taken from the recordings. Where only some
/// recordings give the names, nothing is said of the others.
pub(super) fn leaves_nothing_predictable(request: &Request, model: &Candidate, ruling: &Ruling, units: &Units) -> bool {
    let bodies = model.effects.iter().any(|effect| effect.kind.second_body());
    let wider = ruling.half_width_s..=f64::INFINITY;
    let again = || rule_beside(&request.recordings, Some(model), wider, units, &Settings::default());
    let nothing =
        |again: Ruling| again.findings.is_empty() && !again.leaves_something_predictable() && again.leaves_nothing();
    !bodies && ruling.of_recordings.is_none() && again().is_some_and(nothing)
}

/// The ruling on what the effects of `known` leave, in windows of these half-widths, s.
fn rule_beside(
    recordings: &[Recording],
    known: Option<&Candidate>,
    half_widths_s: RangeInclusive<f64>,
    units: &Units,
    settings: &Settings,
) -> Option<Ruling> {
    let rule = |recordings: &[Recording]| rule_within(recordings, radians(units), half_widths_s.clone(), settings);
    let Some(known) = known else { return rule(recordings) };
    rule(&without_effects(recordings, known)).map(|ruling| ruling.beside(&known.effects))
}

/// Radians in a position unit; `None` where the position is no angle. A position without a unit counts as an angle.
pub fn radians(units: &Units) -> Option<f64> {
    matches!(units.x.as_str(), "rad" | "x").then_some(1.0)
}
