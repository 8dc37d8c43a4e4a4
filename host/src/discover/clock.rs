//! The sensor's clock: one row for each reading, and whether a reading is so old that the loop is late.

use breakaway_core::plant::effect::{ActsIn, Role};
use breakaway_core::plant::{Effect, Kind};

use super::engine::Request;
use super::judge::finding::Finding;
use super::judge::reading_age::reading_age_s;
use super::judge::ruling::Ruling;
use super::judge::settings::Settings;
use super::ruled::Ruled;
use crate::recording::Recording;

/// A request with one row for each reading of the sensor.
pub(super) struct Clocked {
    /// The request. Each row has the drive of the instant at which the reading was taken.
    pub request: Request,
    /// Age of the readings, s. `None` where no reading is held, or where the sensor's clock does not explain the best age.
    pub age_s: Option<f64>,
    /// The request with the drive of the instant at which the reading was seen, where the readings are older than the rows
    /// explain. Otherwise `None`.
    pub as_seen: Option<Request>,
}

/// Puts a request on its sensor's clock.
pub(super) fn clocked(request: &Request, settings: &Settings) -> Clocked {
    let of = |recordings: Vec<Recording>, holdout: Vec<Recording>| Request { recordings, holdout, ..request.clone() };
    let [fresh, fresh_holdout] = [&request.recordings, &request.holdout].map(|all| Recording::refreshed_together(all));
    let Some(age_s) = reading_age_s(&fresh, settings) else {
        return Clocked { request: of(fresh, fresh_holdout), age_s: None, as_seen: None };
    };
    let aged = |all: &[Recording], fresh: &[Recording]| -> Vec<Recording> {
        let held = fresh.iter().map(|own| if own.read_every_s.is_some() { age_s } else { 0.0 });
        let all: Vec<Recording> =
            all.iter().zip(held).map(|(recording, age_s)| recording.with_readings_of(age_s)).collect();
        Recording::refreshed_together(&all)
    };
    let own = of(aged(&request.recordings, &fresh), aged(&request.holdout, &fresh_holdout));
    let [seen, seen_holdout] =
        [fresh, fresh_holdout].map(|all| all.iter().map(Recording::seen_by_rows).collect::<Vec<_>>());
    let rows_s = seen.iter().map(Recording::unsure_s).fold(0.0, f64::max);
    Clocked { request: own, age_s: Some(age_s), as_seen: (age_s > rows_s).then(|| of(seen, seen_holdout)) }
}

/// A request and its ruling with the delay of the loop, if the judge names one in the recordings `as_seen`. The other names
/// stay those of `by_clock`, where the drive is exact. The request has the drive as it was seen.
pub(super) fn with_delay(
    by_clock: &Ruled,
    as_seen: Request,
    rule: impl Fn(&[Recording]) -> Option<Ruling>,
) -> Option<(Request, Ruling)> {
    let mut ruling = by_clock.ruling.clone()?;
    let named = rule(&as_seen.recordings)?.findings.into_iter().find(|own| is_late(own.effect.kind))?;
    let delay = of_age(named, by_clock.age_s?)?;
    ruling.findings.retain(|own| !is_late(own.effect.kind));
    ruling.findings.push(delay);
    // The positions may have been moved to one zero.
    let at_zero = |seen: Vec<Recording>, moved: &[Recording]| -> Vec<Recording> {
        seen.into_iter().zip(moved).map(|(seen, moved)| Recording { x: moved.x.clone(), ..seen }).collect()
    };
    let Request { recordings, holdout, .. } = as_seen;
    let moved = &by_clock.request;
    let recordings = at_zero(recordings, &moved.recordings);
    let holdout = at_zero(holdout, &moved.holdout);
    Some((Request { recordings, holdout, ..moved.clone() }, ruling))
}

/// The delay that is as long as the readings are old, with the evidence of what was named. Within the interval of the
/// readings no other late drive can be told from it.
fn of_age(named: Finding, age_s: f64) -> Option<Finding> {
    let late = || Kind::ALL.iter().copied().filter(|kind| is_late(*kind));
    let delay = late().find(|kind| kind.definition().parameters.iter().any(|own| own.role == Role::Delay))?;
    let tied = late().filter(|kind| *kind != delay).map(|kind| (kind, 0.0)).collect();
    Some(Finding { effect: Effect::new(delay, &[age_s]), tied, errors: [f64::NAN; _], held: Vec::new(), ..named })
}

/// Whether an effect makes the drive late.
fn is_late(kind: Kind) -> bool {
    let mut parameters = kind.definition().parameters.iter();
    kind.acts_in() == ActsIn::Drive
        && parameters.any(|parameter| matches!(parameter.role, Role::Delay | Role::TimeConstant))
}
