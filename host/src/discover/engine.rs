//! The chain: locate, name, add, show; until nothing more can be named.

use std::time::Instant;

use breakaway_core::plant::Base;

use super::chain::{Chain, Tie};
use super::data::{Data, FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::next_experiment::{self, Limits};
use super::outcome::{Discovery, NamedEffect, Overlay, Provenance, Rung, Verdict};
use super::refit;
use super::screen::Screen;
use super::where_map;
use crate::identify::estimate::{self, IdentifyError};
use crate::identify::shooting::{Candidate, Covariance, Fit, Free};
use crate::recording::{Recording, Units};

/// Iterations of the base model's fit.
const BASE_ITERATIONS: usize = 20;
/// A given model's inertia further off than this factor cannot be of this machine and these units.
const UNITS_FACTOR: f64 = 20.0;

/// Why there is no discovery.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
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

/// Finds what the model misses. `progress` is told what is being done.
///
/// A gap that nothing explains over segments of [`FIT_SEGMENT_S`] is looked at again over [`SHORT_SEGMENT_S`].
///
/// # Errors
/// [`DiscoverError`].
pub fn discover(request: &Request, progress: &(dyn Fn(&str) + Sync)) -> Result<Discovery, DiscoverError> {
    let began = Instant::now();
    let mut found = within(request, FIT_SEGMENT_S, progress)?;
    if found.verdict == Verdict::Unknown {
        progress("looking again over shorter segments");
        match within(request, SHORT_SEGMENT_S, progress) {
            Ok(mut short) if !short.effects.is_empty() => {
                short.remarks.push(format!(
                    "no model follows the motion over {FIT_SEGMENT_S} s: fitted and scored over segments of {SHORT_SEGMENT_S} s"
                ));
                found = short;
            }
            Ok(short) => found.nearest = short.nearest.or(found.nearest),
            Err(_) => (),
        }
        found.remarks.extend(found.nearest.clone().filter(|_| found.effects.is_empty()));
    }
    found.seconds = began.elapsed().as_secs_f64();
    Ok(found)
}

/// The chain over segments of one length.
fn within(request: &Request, segment_s: f64, progress: &(dyn Fn(&str) + Sync)) -> Result<Discovery, DiscoverError> {
    let units = same_units(request)?;
    progress("preparing the recordings");
    let data = Data::new(&request.recordings, &request.holdout, segment_s);
    if data.fit.len() < 3 || data.score.is_empty() {
        return Err(DiscoverError::TooShort(segment_s));
    }
    let (start, mut remarks) = starting_model(request)?;
    progress("fitting the base model");
    let base_fit =
        refit::fit_softly(&data, &start, BASE_ITERATIONS).map_err(|error| DiscoverError::Base(error.to_string()))?;
    let chain = grown(Chain::new(&data, &units, base_fit.clone()), progress);
    let other = chain.begun_otherwise().map(|other| grown(other, progress)).find(|other| other.replaces(&chain));
    let ended = other.unwrap_or(chain).end();
    remarks.extend(ended.remarks);
    let (current, named, ladder) = (ended.fit, ended.named, ended.ladder);
    progress("drawing the map");
    let where_map = match (Screen::new(&data, &base_fit.candidate), Screen::new(&data, &current.candidate)) {
        (Some(before), Some(after)) => where_map::rows(&data, &before, &after, &units),
        _ => Vec::new(),
    };
    let next_experiment = ended.tie.and_then(|Tie { a, b, kinds }| {
        progress("designing the next experiment");
        next_experiment::deciding(&a.candidate, &b.candidate, &kinds, &limits(&data), &units)
    });
    let verdict = ended.verdict;
    Ok(Discovery {
        verdict,
        sentence: sentence(verdict, &named, &ladder, data.sigma, where_map.first().map(|w| w.coordinate)),
        effects: named,
        ladder,
        model: current.candidate.clone(),
        model_se: model_se(&current.candidate, &ended.errors),
        base_se: [0, 1, 2].map(|i| ended.errors.standard_error(Free::Base(i)).unwrap_or(f64::NAN)),
        noise_floor: data.sigma,
        where_map,
        candidates: ended.first_round,
        overlays: overlays(&data, &base_fit, &current),
        next_experiment,
        nearest: ended.closest,
        remarks,
        units,
        segments: (data.fit.len() + data.score.len(), data.available),
        seconds: 0.0,
        provenance: request.provenance.clone(),
    })
}

/// A model grown until nothing is missing, or nothing more can be named.
fn grown<'a>(mut chain: Chain<'a>, progress: &(dyn Fn(&str) + Sync)) -> Chain<'a> {
    while chain.step(progress) {}
    chain
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

/// The model to start from, and what identifying it from the recordings had to say.
fn starting_model(request: &Request) -> Result<(Candidate, Vec<String>), DiscoverError> {
    let identified = estimate::identify(&request.recordings)?;
    let best = &identified.best;
    let base = Base { b: best.b.value, c: best.c.value.max(0.0), f1: best.f1.value.max(0.0) };
    // What is missing is said below, and better.
    let remarks = identified.remarks.into_iter().filter(|remark| !remark.contains("`breakaway discover`")).collect();
    let Some(model) = &request.model else { return Ok((Candidate { base, effects: Vec::new() }, remarks)) };
    let factor = (model.base.b / base.b).max(base.b / model.base.b);
    if factor > UNITS_FACTOR {
        return Err(DiscoverError::ModelUnits { model: model.base.b, data: base.b, factor });
    }
    Ok((Candidate { base, effects: model.effects.clone() }, remarks))
}

fn model_se(model: &Candidate, errors: &Covariance) -> Vec<Vec<f64>> {
    let effects = model.effects.iter().enumerate();
    effects
        .map(|(j, effect)| {
            let count = effect.kind.definition().parameters.len();
            (0..count).map(|i| errors.standard_error(Free::Effect(j, i)).unwrap_or(0.0)).collect()
        })
        .collect()
}

fn limits(data: &Data) -> Limits {
    let drive = data.tracks.iter().flat_map(|t| &t.u).fold(0.0, |m: f64, u| m.max(u.abs()));
    let travel =
        data.tracks.iter().map(|t| t.xs.iter().map(|x| (x - t.xs[0]).abs()).fold(0.0, f64::max)).fold(0.0, f64::max);
    Limits { drive, travel, tick_s: data.tracks[0].ts, sigma: data.sigma }
}

/// Up to three held-out windows: the ones in which the base is furthest off, one per recording first.
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

fn sentence(verdict: Verdict, named: &[NamedEffect], ladder: &[Rung], sigma: f64, place: Option<&str>) -> String {
    let titles: Vec<String> = named.iter().map(|n| n.kind.definition().title.to_lowercase()).collect();
    let (first, last) = (&ladder[0], &ladder[ladder.len() - 1]);
    let errors = format!(
        "the held-out simulation error falls from {:.1} to {:.1} times the noise",
        first.holdout_rmse / sigma,
        last.holdout_rmse / sigma
    );
    let place = place.unwrap_or("no coordinate");
    match verdict {
        Verdict::Explained => format!("The model missed {}: with it {errors}.", titles.join(" and ")),
        Verdict::PartlyExplained => {
            format!("The model missed {}: with it {errors}; something else remains.", titles.join(" and "))
        }
        Verdict::Unknown => format!(
            "The gap is real ({:.1} times the noise), and no effect of the catalogue explains it; it lives along {place}.",
            first.holdout_rmse / sigma
        ),
        Verdict::NothingMissing => "Nothing is missing: simulation and measurement agree within the noise.".to_owned(),
    }
}
