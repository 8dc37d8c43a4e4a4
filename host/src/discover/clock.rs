//! The sensor's clock: one row for each reading, and whether a reading is so old that the loop is late.

use breakaway_core::plant::effect::{ActsIn, Role};
use breakaway_core::plant::{Effect, Kind};

use super::judge::finding::Finding;
use super::judge::reading_age::reading_age_s;
use super::judge::ruling::Ruling;
use super::judge::settings::Settings;
use super::request::Request;
use super::ruled::Ruled;
use crate::fit::Candidate;
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
    let [fresh, fresh_holdout] = [&request.recordings, &request.holdout].map(|all| Recording::refreshed_together(all));
    let Some(age_s) = reading_age_s(&fresh, settings) else {
        return Clocked { request: request.of(fresh, fresh_holdout), age_s: None, as_seen: None };
    };
    let aged = |all: &[Recording], fresh: &[Recording]| -> Vec<Recording> {
        let held = fresh.iter().map(|own| if own.read_every_s.is_some() { age_s } else { 0.0 });
        let all: Vec<Recording> =
            all.iter().zip(held).map(|(recording, age_s)| recording.with_readings_of(age_s)).collect();
        Recording::refreshed_together(&all)
    };
    let own = request.of(aged(&request.recordings, &fresh), aged(&request.holdout, &fresh_holdout));
    let [seen, seen_holdout] =
        [fresh, fresh_holdout].map(|all| all.into_iter().map(Recording::seen_by_rows).collect::<Vec<_>>());
    let rows_s = seen.iter().map(Recording::unsure_s).fold(0.0, f64::max);
    Clocked { request: own, age_s: Some(age_s), as_seen: (age_s > rows_s).then(|| request.of(seen, seen_holdout)) }
}

/// A request and its ruling with the delay of the loop, if the judge names one in the recordings `as_seen`. A delay may only
/// show beside the other names, so the judge is asked without them first, and then beside them. The other names stay those of
/// `by_clock`, where the drive is exact. The request has the drive as it was seen.
pub(super) fn with_delay(
    by_clock: &Ruled,
    as_seen: Request,
    rule: impl Fn(&[Recording], Option<&Candidate>) -> Option<Ruling>,
) -> Option<(Request, Ruling)> {
    let mut ruling = by_clock.ruling.clone()?;
    // The positions may have been moved to one zero.
    let at_zero = |seen: Vec<Recording>, moved: &[Recording]| -> Vec<Recording> {
        seen.into_iter().zip(moved).map(|(seen, moved)| Recording { x: moved.x.clone(), ..seen }).collect()
    };
    let Request { recordings, holdout, .. } = as_seen;
    let moved = &by_clock.request;
    let recordings = at_zero(recordings, &moved.recordings);
    ruling.findings.retain(|own| !is_late(own.effect.kind));
    let late = |ruling: Ruling| ruling.findings.into_iter().find(|own| is_late(own.effect.kind));
    let beside = || {
        let effects: Vec<Effect<f64>> = ruling.findings.iter().map(|own| own.effect).collect();
        let names = (!effects.is_empty()).then_some(Candidate { base: ruling.base, effects })?;
        rule(&recordings, Some(&names)).and_then(late)
    };
    let named = rule(&recordings, None).and_then(late).or_else(beside)?;
    ruling.findings.push(of_age(&named, by_clock.age_s?)?);
    let holdout = at_zero(holdout, &moved.holdout);
    Some((moved.of(recordings, holdout), ruling))
}

/// The delay that is as long as the readings are old, with the evidence of what was named. Within the interval of the
/// readings no other late drive can be told from it.
fn of_age(named: &Finding, age_s: f64) -> Option<Finding> {
    let late = || Kind::ALL.iter().copied().filter(|kind| is_late(*kind));
    let delay = late().find(|kind| kind.definition().parameters.iter().any(|own| own.role == Role::Delay))?;
    let tied = late().filter(|kind| *kind != delay).map(|kind| (kind, 0.0)).collect();
    Some(Finding { tied, gain: named.gain, ..Finding::of_z(Effect::new(delay, &[age_s]), named.z) })
}

/// Whether an effect makes the drive late.
fn is_late(kind: Kind) -> bool {
    let mut parameters = kind.definition().parameters.iter();
    kind.acts_in() == ActsIn::Drive
        && parameters.any(|parameter| matches!(parameter.role, Role::Delay | Role::TimeConstant))
}

#[cfg(test)]
mod tests {
    use super::super::judge::bar::tests::Axis;
    use super::super::ruled::ruled;
    use super::*;
    use crate::recording::Units;

    /// Rows of 2 ms from one reading to the next.
    const HELD: usize = 5;

    /// An axis with friction and random torque. Its position is read every [`HELD`] rows, and seen so many rows late.
    fn axis(late: usize) -> Recording {
        let mut recording = Axis { f1: 0.1, drag: 0.0, load: 0.0, seed: 1 }.recording();
        let x = recording.x.clone();
        let read = |k: usize| x[(k / HELD * HELD).saturating_sub(late)];
        recording.x = (0..x.len()).map(read).collect();
        recording
    }

    fn ruled_on(late: usize) -> Ruled {
        let units = Units { u: "V".into(), x: "rad".into() };
        let request = Request { recordings: vec![axis(late)], ..Request::default() };
        ruled(&request, &units, &Settings::default())
    }

    /// Readings that are four rows old delay the loop. The delay is named with their age, to half a row, and a lag is tied
    /// with it. The request then has the drive as it was seen.
    #[test]
    fn readings_older_than_a_row_are_a_delay() {
        let found = ruled_on(4);
        let delay = &found.ruling.as_ref().unwrap().findings[0];
        assert_eq!((delay.effect.kind, delay.tied.as_slice()), (Kind::Delay, &[(Kind::ElectricalLag, 0.0)][..]));
        assert!((delay.effect.p[0] - 8e-3).abs() < 1e-3, "{:?}", delay.effect);
        assert_eq!(found.age_s, None);
        let seen = Recording::refreshed_together(&[axis(4)]);
        assert_eq!(found.request.recordings[0].u, seen[0].u);
    }

    /// The judge names a delay only beside the load that was found. The delay has the age of the readings.
    #[test]
    fn a_delay_may_show_beside_the_names_alone() {
        let ruling = Some(Ruling::naming(&[Kind::ConstantLoad], [0.05, 9.0]));
        let request = Request { recordings: vec![axis(4)], ..Request::default() };
        let by_clock = Ruled { request: request.clone(), ruling, age_s: Some(8e-3), rezeroed: false };
        let rule = |_: &[Recording], names: Option<&Candidate>| {
            let beside = names.is_some_and(|names| names.effects[0].kind == Kind::ConstantLoad);
            Some(Ruling::naming(if beside { &[Kind::Delay] } else { &[Kind::Spring] }, [0.05, 9.0]))
        };
        let (_, ruling) = with_delay(&by_clock, request, rule).unwrap();
        let named: Vec<(Kind, f64)> = ruling.findings.iter().map(|own| (own.effect.kind, own.effect.p[0])).collect();
        assert_eq!(named, [(Kind::ConstantLoad, 1.0), (Kind::Delay, 8e-3)]);
    }

    /// A reading that is one row old may have come just after the row before. Nothing is named.
    #[test]
    fn readings_of_a_row_are_no_delay() {
        let found = ruled_on(1);
        assert!(found.ruling.unwrap().findings.is_empty());
        assert!(found.age_s.is_some_and(|age_s| (age_s - 2e-3).abs() < 1e-3), "{:?}", found.age_s);
    }
}
