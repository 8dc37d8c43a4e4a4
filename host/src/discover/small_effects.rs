//! Effects too small for the measured forces. Models are searched on the simulated motion, where little more than the
//! sensor's noise need be left. `corroboration.rs` decides whether the names are believed.

use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use breakaway_core::plant::{Effect, Kind};

use super::assembled::assembled;
use super::candidate_rows;
use super::data::{FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::judge::ruling::Ruling;
use super::model::Model;
use super::outcome::{Discovery, Verdict};
use super::prepared::{Prepared, prepared};
use super::progress::{Progress, Watch};
use super::request::{DiscoverError, Request};
use super::search::{Beginning, Search};
use crate::fit::Candidate;
use crate::recording::{Recording, Units, share_a_clock};

/// Said where nothing is named, and effects of session time were not sought.
const NO_CLOCK: &str = "the recordings do not share a clock, so no effect of session time was sought: drifts, inertia steps \
                        and forces that are periodic in time";

/// Searches `kinds` on the simulated motion. `judged` holds the judge's ruling, and its names as the simulated motion
/// fits them, where there are such.
///
/// Effects of session time are sought only where the recordings share a clock. Elsewhere a recording begins when the one
/// before it has ended, so that the time between them means nothing.
///
/// A gap that nothing explains over segments of [`FIT_SEGMENT_S`] is searched again over [`SHORT_SEGMENT_S`].
///
/// # Errors
/// [`DiscoverError`].
pub(super) fn found(
    request: &Request,
    units: &Units,
    judged: Option<(&Ruling, Option<&Candidate>)>,
    kinds: &[Kind],
    progress: Watch<'_>,
) -> Result<Discovery, DiscoverError> {
    let work = Arc::default();
    let sought = of_the_clock(kinds, &request.recordings);
    let over = |segment_s: f64| within(request, units, (segment_s, &work), (judged, &sought), progress);
    let mut found = over(FIT_SEGMENT_S)?;
    if found.verdict == Verdict::Unknown {
        progress(Progress::Step("looking again over shorter segments"));
        match over(SHORT_SEGMENT_S) {
            Ok(mut short) if !short.effects.is_empty() => {
                short.remarks.push(format!(
                    "no model follows the motion over {FIT_SEGMENT_S} s: fitted and scored over segments of \
                     {SHORT_SEGMENT_S} s"
                ));
                found = short;
            }
            Ok(short) => found.nearest = short.nearest.or(found.nearest),
            Err(_) => (),
        }
        found.remarks.extend((sought.len() < kinds.len()).then(|| NO_CLOCK.to_owned()));
        found.remarks.extend(found.nearest.clone().filter(|_| found.effects.is_empty()));
    }
    Ok(found)
}

/// The kinds without the effects of session time, where the recordings do not share a clock.
fn of_the_clock(kinds: &[Kind], recordings: &[Recording]) -> Vec<Kind> {
    let shared = share_a_clock(recordings);
    kinds.iter().copied().filter(|kind| shared || !kind.definition().shared_clock).collect()
}

/// The search over segments of one length. All lengths share one bound of work. It begins with the base, and with the
/// judge's names beside it.
fn within(
    request: &Request,
    units: &Units,
    (segment_s, work): (f64, &Arc<AtomicU64>),
    (judged, kinds): (Option<(&Ruling, Option<&Candidate>)>, &[Kind]),
    progress: Watch<'_>,
) -> Result<Discovery, DiscoverError> {
    let ruling = judged.map(|(ruling, _)| ruling);
    let mut start =
        prepared(request, segment_s, None, progress).or_else(|_| prepared(request, segment_s, ruling, progress))?;
    start.data.work = work.clone();
    let names = judged.filter(|(ruling, _)| !ruling.findings.is_empty());
    let first = names.map(|(ruling, fitted)| beginning(&start, ruling, fitted));
    let mut ended = Search::new(&start.data, units, start.base.clone(), kinds).run(first.as_ref(), progress);
    if let Some(ruling) = ruling.filter(|_| ended.first_round.is_empty()) {
        ended.first_round = candidate_rows::rows(ruling, &ended.named);
    }
    Ok(assembled(request, &start, units, ended, progress))
}

/// The base with the judge's names; what the judge held stays held. The values are those `fitted` to the simulated
/// motion, where it has the same effects, which it then bears out; else the judge's.
fn beginning(start: &Prepared, ruling: &Ruling, fitted: Option<&Candidate>) -> Beginning {
    let mut model = Model::of(&start.base);
    let known = model.effects.len();
    for finding in &ruling.findings {
        model = model.with(finding.effect);
        let j = model.effects.len() - 1;
        for i in &finding.held {
            model.hold(j, *i);
        }
    }
    let kinds = |effects: &[Effect<f64>]| effects.iter().map(|effect| effect.kind).collect::<Vec<_>>();
    let borne_out = fitted.filter(|fitted| kinds(&fitted.effects) == kinds(&model.effects));
    let base = borne_out.map_or_else(
        || ruling.simulable_base().unwrap_or(start.base.candidate.base),
        |fitted| {
            model.effects[known..].copy_from_slice(&fitted.effects[known..]);
            fitted.base
        },
    );
    Beginning { model: model.on(base), borne_out: borne_out.is_some() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recordings that each begin at 0 s tell of no time between them. A motor's inertia stepped by a factor of 43 where
    /// the second of two began to be held out (HSM150, jitter of 40 %).
    #[test]
    fn effects_of_time_need_a_shared_clock() {
        let from = |first: f64| Recording { t: vec![first, first + 1.0], ..Recording::default() };
        let kinds = [Kind::InertiaStep, Kind::FrictionDrift, Kind::GainDrift, Kind::TimePeriodic, Kind::Cogging];
        assert_eq!(of_the_clock(&kinds, &[from(0.0), from(0.0)]), [Kind::Cogging]);
        assert_eq!(of_the_clock(&kinds, &[from(0.0), from(2.0)]), kinds);
    }
}
