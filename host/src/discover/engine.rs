//! The way through a discovery. The judge rules on the forces. The simulated motion gives parameters and small effects.
//! What was found is then assembled.

use breakaway_core::plant::Kind;
use web_time::Instant;

use super::by_force;
use super::corroboration;
use super::following::off_by_a_tooth;
use super::gap::{AT_THE_NOISE, FAR};
use super::inertia::untold;
use super::judge::library::{tells, weighs};
use super::judge::ruling::Ruling;
use super::judge::settings::Settings;
use super::objections;
use super::outcome::{Discovery, Verdict};
use super::progress::{Progress, Watch};
use super::request::{DiscoverError, Request, same_units};
use super::ruled::{Ruled, leaves_nothing_predictable, ruled};
use super::small_effects;
use super::thinned::thinned;
use super::unweighed;
use crate::recording::{Recording, in_session_order};

/// Held-out simulation error, over the sensor's noise, above which the simulated motion is not searched. Such a machine
/// moves by more than the noise for reasons of its own, and no effect brings the error down to it.
const ROUGH: f64 = 150.0;

/// Finds what the model misses. `progress` is called at the start of each step.
///
/// The judge rules on the measured forces. Then the simulated motion is searched for effects too small for the forces.
/// The search is left out where the error is far above the sensor's noise. What it finds replaces the judge's names
/// only where open loop and forces corroborate it.
///
/// # Errors
/// [`DiscoverError`].
pub fn discover(request: &Request, progress: Watch<'_>) -> Result<Discovery, DiscoverError> {
    let began = Instant::now();
    let units = same_units(request)?;
    let [recordings, holdout] = [&request.recordings, &request.holdout].map(|all| in_session_order(all));
    progress(Progress::Step("judging the measured forces"));
    let Ruled { request: judged, ruling, age_s, rezeroed } =
        ruled(&request.of(recordings, holdout), &units, &Settings::default());
    let thin = |all: &[Recording]| all.iter().map(thinned).collect();
    let request = &judged.of(thin(&judged.recordings), thin(&judged.holdout));
    let by_force = ruling.as_ref().map(|ruling| by_force::found(request, &units, ruling, progress));
    let mut found = if let Some(Ok((by_force, ruling))) = by_force {
        let ruling = &ruling;
        let kinds = left_to_the_motion(ruling, &by_force);
        let small = (!kinds.is_empty())
            .then(|| {
                small_effects::found(request, &units, Some((ruling, Some(&by_force.model))), &kinds, progress).ok()
            })
            .flatten();
        match small.filter(|small| corroboration::believed(request, Some(ruling), small, &by_force)) {
            Some(mut small) => {
                // What the forces do not tell leaves their random torque as it was.
                let as_before =
                    by_force.down_to_the_noise() && ruling.shaken() && corroboration::differs_untold(&small, &by_force);
                if small.verdict == Verdict::PartlyExplained && as_before {
                    small.verdict = Verdict::Explained;
                }
                by_force::with_ties(small, Some(ruling))
            }
            None => unweighed::compared(request, &units, ruling, by_force, progress),
        }
    } else {
        let objects = |kind: Kind| ruling.as_ref().is_some_and(|ruling| objections::to_kind(ruling, kind));
        let kinds: Vec<Kind> = Kind::ALL.iter().copied().filter(|kind| !objects(*kind)).collect();
        let small =
            small_effects::found(request, &units, ruling.as_ref().map(|ruling| (ruling, None)), &kinds, progress)?;
        if corroboration::stands_alone(request, ruling.as_ref(), &small) {
            small
        } else {
            small.without_names(request.model.as_ref().map_or(0, |model| model.effects.len()))
        }
    };
    let doubted = found.verdict == Verdict::PartlyExplained;
    if doubted && ruling.as_ref().is_some_and(|own| leaves_nothing_predictable(&judged, &found.model, own, &units)) {
        found.verdict = Verdict::Explained;
    }
    found.remarks.extend(age_s.map(|age_s| {
        format!(
            "the position is held between readings, which are taken to be {:.1} ms old; a delay of the drive looks the same",
            1e3 * age_s
        )
    }));
    if rezeroed {
        let remark = "each recording has a zero of its own: all positions are counted from that of the first";
        found.remarks.push(remark.to_owned());
    }
    let b = found.model.base.b;
    if let Some(remark) = ruling.as_ref().and_then(|own| untold(own, b, found.over_noise(), &units.of_b())) {
        found.base_se[0] = f64::NAN;
        found.remarks.push(remark);
    }
    found.force = ruling.as_ref().map(by_force::force);
    found.seconds = began.elapsed().as_secs_f64();
    Ok(found)
}

/// The effects for which the simulated motion is searched. There are none where it is far above its sensor's noise, or
/// off by a tooth. The forces have weighed the effects that act in no less than a window in two cases. Either random
/// torque explains what is left; or the motion is far off, and the forces tell what is left. Of these effects remain what
/// the forces speak for, and bristles, whose bending the forces do not tell. Unless random torque explains what is left, what
/// they named remains too. An effect against which the forces speak is not sought: it would not be believed.
fn left_to_the_motion(ruling: &Ruling, found: &Discovery) -> Vec<Kind> {
    let error = || found.ladder.last().map_or(f64::INFINITY, |rung| rung.holdout_rmse);
    if off_by_a_tooth(ruling, &found.model.effects, error) || found.over_noise() > ROUGH {
        return Vec::new();
    }
    // Where the simulated motion contradicts the names, the forces have decided on nothing. The names stay a start.
    let taken_back = found.effects.is_empty() && !ruling.findings.is_empty();
    let far = found.over_noise() > FAR && ruling.tells_what_is_left();
    let weighed = found.over_noise() > AT_THE_NOISE && (far || ruling.shaken()) && !taken_back;
    let named = |kind: Kind| ruling.findings.iter().any(|finding| finding.effect.kind == kind);
    let shaken = ruling.shaken();
    let open = |kind: Kind| ruling.supports(kind) || !tells(kind) || !shaken && named(kind);
    let idle = |kind: Kind| weighed && weighs(kind) && !open(kind) || objections::to_kind(ruling, kind);
    Kind::ALL.iter().copied().filter(|kind| !idle(*kind)).collect()
}
