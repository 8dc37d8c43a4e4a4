//! The way through a discovery. The judge rules on the forces. The simulated motion gives parameters and small effects.
//! What was found is then assembled.

use breakaway_core::plant::{Base, Kind};
use web_time::Instant;

use super::by_force;
use super::corroboration;
use super::data::Data;
use super::following::off_by_a_tooth;
use super::gap::open_loop_squares;
use super::inertia::untold;
use super::judge::library::{tells, weighs};
use super::judge::ruling::Ruling;
use super::judge::settings::Settings;
use super::next_experiment::{self, Limits};
use super::objections;
use super::outcome::{Discovery, Overlay, Provenance, Verdict};
use super::progress::{Progress, Watch};
use super::ruled::{Ruled, leaves_nothing_predictable, ruled};
use super::screen::Screen;
use super::search::{Ended, Tie, fit_softly};
use super::small_effects;
use super::thinned::thinned;
use super::unweighed;
use super::where_map;
use crate::fit::{Candidate, Covariance, Fit, FitError, Free};
use crate::identify::estimate::{self, IdentifyError};
use crate::recording::{Recording, Units, in_session_order};

/// Held-out simulation error, over the sensor's noise, above which the simulated motion is not searched. Such a machine
/// moves by more than the noise for reasons of its own, and no effect brings the error down to it.
const ROUGH: f64 = 150.0;
/// Held-out simulation error, over the sensor's noise, up to which nothing but that noise is left.
const AT_THE_NOISE: f64 = 1.1;
/// The same ratio, above which the forces tell more of what is left than the motion. Nearer to the noise the motion tells
/// effects that act in few samples, as a drive that is clipped now and then.
pub(super) const FAR: f64 = 10.0;
/// Iterations of the base model's fit.
const BASE_ITERATIONS: usize = 20;
/// Largest factor between a given model's inertia and the recordings'. Beyond it the model is of another machine, or in
/// other units.
const UNITS_FACTOR: f64 = 20.0;

/// Why there is no discovery.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum DiscoverError {
    /// The base cannot be identified.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// Recordings of different units.
    #[error(
        "{first} is in {first_units} and {second} in {second_units}: recordings of one session need the same units"
    )]
    Units {
        /// A recording.
        first: String,
        /// Its units.
        first_units: String,
        /// Another.
        second: String,
        /// Its units.
        second_units: String,
    },
    /// The recordings are shorter than a segment.
    #[error("the recordings hold no segment of {0} s to fit and to score: record for longer")]
    TooShort(f64),
    /// The model cannot be of these recordings.
    #[error(
        "the model cannot simulate these recordings: its inertia b = {model:.3e} is {factor:.0} times off the recordings' \
         {data:.3e}. Check the units of drive and position"
    )]
    ModelUnits {
        /// b of the model.
        model: f64,
        /// b of the data.
        data: f64,
        /// Their ratio, ≥ 1.
        factor: f64,
    },
    /// The base cannot be simulated.
    #[error("the base model cannot be fitted by simulation: {0}")]
    Base(String),
}

/// What a discovery is told.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Recordings to fit, and to score where there is no `holdout`.
    pub recordings: Vec<Recording>,
    /// Recordings that are only scored.
    pub holdout: Vec<Recording>,
    /// Base model and effects known already; identified if absent.
    pub model: Option<Candidate>,
    /// Inputs, version, command.
    pub provenance: Provenance,
}

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
        ruled(&Request { recordings, holdout, ..request.clone() }, &units, &Settings::default());
    let thin = |all: &[Recording]| all.iter().map(thinned).collect();
    let request = &Request { recordings: thin(&judged.recordings), holdout: thin(&judged.holdout), ..judged.clone() };
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

/// Recordings, starting model and base fit of a discovery over segments of one length.
pub(super) struct Prepared {
    pub data: Data,
    pub base: Fit,
    pub remarks: Vec<String>,
}

/// Prepares them.
pub(super) fn prepared(
    request: &Request,
    segment_s: f64,
    ruling: Option<&Ruling>,
    progress: Watch<'_>,
) -> Result<Prepared, DiscoverError> {
    progress(Progress::Step("preparing the recordings"));
    let data = Data::new(&request.recordings, &request.holdout, segment_s);
    if data.fit.len() < 3 || data.score.is_empty() {
        return Err(DiscoverError::TooShort(segment_s));
    }
    let (starts, remarks) = starting_models(request, ruling)?;
    progress(Progress::Step("fitting the base model"));
    let fits = starts.iter().map(|start| fit_softly(&data, start, BASE_ITERATIONS));
    let base = nearest(&data, fits).map_err(|error| DiscoverError::Base(error.to_string()))?;
    Ok(Prepared { data, base, remarks })
}

/// A finished discovery: what was found, with maps, overlays and the experiment that would decide a tie.
pub(super) fn assembled(
    request: &Request,
    prepared: &Prepared,
    units: &Units,
    ended: Ended,
    progress: Watch<'_>,
) -> Discovery {
    let Prepared { data, base, remarks } = prepared;
    let mut remarks = remarks.clone();
    remarks.extend(ended.remarks);
    let (current, named, ladder) = (ended.fit, ended.named, ended.ladder);
    progress(Progress::Step("drawing the map"));
    let where_map = match (Screen::new(data, &base.candidate), Screen::new(data, &current.candidate)) {
        (Some(before), Some(after)) => where_map::rows(data, &before, &after, units),
        _ => Vec::new(),
    };
    let next_experiment = ended.tie.and_then(|Tie { a, b, kinds }| {
        progress(Progress::Step("designing the next experiment"));
        next_experiment::deciding(&a.candidate, &b.candidate, &kinds, &limits(data), units)
    });
    Discovery {
        verdict: ended.verdict,
        effects: named,
        ladder,
        model: current.candidate.clone(),
        model_se: model_se(&current.candidate, &ended.errors),
        base_se: [0, 1, 2].map(|i| ended.errors.standard_error(Free::Base(i)).unwrap_or(f64::NAN)),
        noise_floor: data.sigma,
        where_map,
        candidates: ended.first_round,
        overlays: overlays(data, base, &current),
        next_experiment,
        nearest: ended.closest,
        remarks,
        units: units.clone(),
        segments: (data.fit.len() + data.score.len(), data.available),
        seconds: 0.0,
        force: None,
        provenance: request.provenance.clone(),
    }
}

fn same_units(request: &Request) -> Result<Units, DiscoverError> {
    let mut all = request.recordings.iter().chain(&request.holdout);
    let Some(first) = all.next() else { return Err(IdentifyError::Nothing.into()) };
    let show = |u: &Units| format!("{} and {}", u.u, u.x);
    match all.find(|r| r.units != first.units) {
        Some(other) => Err(DiscoverError::Units {
            first: first.name.clone(),
            first_units: show(&first.units),
            second: other.name.clone(),
            second_units: show(&other.units),
        }),
        None => Ok(first.units.clone()),
    }
}

/// The fit that the held-out recordings follow best in open loop. The first that comes down to the noise ends the
/// search.
fn nearest(data: &Data, fits: impl Iterator<Item = Result<Fit, FitError>>) -> Result<Fit, FitError> {
    let mut best: Result<(Fit, f64), FitError> = Err(FitError::NoSegment);
    for fit in fits {
        let scored = fit.map(|fit| {
            let windows = if data.open_loop.is_empty() { &data.score } else { &data.open_loop };
            let squares = open_loop_squares(data, windows, &fit);
            let (square, count) = squares.iter().fold((0.0, 0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
            (fit, (square / count.max(1) as f64).sqrt())
        });
        let worse = |(_, error): &(Fit, f64)| scored.as_ref().is_ok_and(|(_, own)| own < error);
        if best.as_ref().map_or(true, worse) {
            best = scored;
        }
        if best.as_ref().is_ok_and(|(_, error)| *error < AT_THE_NOISE * data.sigma) {
            break;
        }
    }
    best.map(|(fit, _)| fit)
}

/// The models to start from, and the remarks of identifying the base from the recordings. A given model is the only
/// start. Without one there are two bases, by the estimators on the motion and by the measured forces. Only the second
/// remains where the forces tell the inertia and name an effect.
fn starting_models(request: &Request, ruling: Option<&Ruling>) -> Result<(Vec<Candidate>, Vec<String>), DiscoverError> {
    let identified = estimate::starting_model(&request.recordings);
    let by_force = ruling.and_then(Ruling::simulable_base);
    let own = identified.as_ref().ok().map(|identified| {
        let best = &identified.best;
        Base { b: best.b.value, c: best.c.value.max(0.0), f1: best.f1.value.max(0.0) }
    });
    let mut bases: Vec<Base<f64>> = own.into_iter().chain(by_force).collect();
    // A base that misses an effect as large as the drive is no start.
    if ruling.is_some_and(|ruling| ruling.tells_inertia() && !ruling.findings.is_empty()) {
        bases.reverse();
        bases.truncate(1);
    }
    let remarks = match identified {
        Ok(identified) => identified.remarks,
        Err(error) if bases.is_empty() => return Err(error.into()),
        Err(_) => Vec::new(),
    };
    let Some(model) = &request.model else {
        return Ok((bases.into_iter().map(|base| Candidate { base, effects: Vec::new() }).collect(), remarks));
    };
    let base = bases[0];
    let factor = (model.base.b / base.b).max(base.b / model.base.b);
    // A base that misses the main effect tells nothing of the units.
    if factor > UNITS_FACTOR && ruling.is_none_or(Ruling::tells_inertia) {
        return Err(DiscoverError::ModelUnits { model: model.base.b, data: base.b, factor });
    }
    Ok((vec![Candidate { base: model.base, effects: model.effects.clone() }], remarks))
}

fn model_se(model: &Candidate, errors: &Covariance) -> Vec<Vec<f64>> {
    let effects = model.effects.iter().enumerate();
    effects
        .map(|(j, effect)| {
            let count = effect.kind.definition().parameters.len();
            (0..count).map(|i| errors.standard_error(Free::Effect(j, i)).unwrap_or(f64::NAN)).collect()
        })
        .collect()
}

fn limits(data: &Data) -> Limits {
    let drive = data.tracks.iter().flat_map(|t| &t.u).fold(0.0, |m: f64, u| m.max(u.abs()));
    let travel =
        data.tracks.iter().map(|t| t.xs.iter().map(|x| (x - t.xs[0]).abs()).fold(0.0, f64::max)).fold(0.0, f64::max);
    Limits { drive, travel, tick_s: data.tracks[0].ts, sigma: data.sigma }
}

/// Up to three held-out windows, at most one for each recording: those in which the base is furthest off.
fn overlays(data: &Data, before: &Fit, after: &Fit) -> Vec<Overlay> {
    let problem = data.over(&data.open_loop);
    let mut order: Vec<(usize, f64)> = problem.score(&before.candidate).into_iter().enumerate().collect();
    order.retain(|(_, mse)| mse.is_finite());
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut seen = Vec::new();
    let mut overlays = Vec::new();
    for (i, _) in order {
        let segment = data.open_loop[i];
        if seen.contains(&segment.track) || overlays.len() == 3 {
            continue;
        }
        seen.push(segment.track);
        let one = data.over(std::slice::from_ref(&data.open_loop[i]));
        let simulated = |fit: &Fit| {
            one.fit(&fit.candidate, &[], None, 8)
                .map(|fitted| one.positions(&fit.candidate, segment, fitted.initial[0]))
                .unwrap_or_default()
        };
        let track = &data.tracks[segment.track];
        let range = segment.start..segment.start + segment.len;
        overlays.push(Overlay {
            title: format!("{}, held out, from t = {:.2} s", track.name, track.t[segment.start]),
            t: track.t[range.clone()].to_vec(),
            measured: track.x[range.clone()].to_vec(),
            before: simulated(before),
            after: if after.candidate.effects.len() > before.candidate.effects.len() {
                simulated(after)
            } else {
                Vec::new()
            },
            u: track.u[range].to_vec(),
        });
    }
    overlays
}
