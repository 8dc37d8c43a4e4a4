//! The chain: locate, name, add, show; until nothing more can be named.

use std::time::Instant;

use breakaway_core::plant::{Base, Effect, Kind};

use super::candidates::{self, Round};
use super::data::{Data, FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::decide::{FURTHER, paired};
use super::gap::{Gap, LEAST_TOTAL, open_loop_squares, root_mean};
use super::next_experiment::{self, Limits};
use super::outcome::{CandidateRow, Discovery, NamedEffect, Overlay, Provenance, Rung, Verdict};
use super::ranking::{better, evidence, nearest, parameters, preference, rivals, simpler_laws, table};
use super::refit;
use super::screen::Screen;
use super::where_map;
use crate::identify::estimate::{self, IdentifyError};
use crate::identify::shooting::{Candidate, Covariance, Fit, Free};
use crate::recording::{Recording, Units};

/// Iterations of the base model's fit.
const BASE_ITERATIONS: usize = 20;
/// Most effects added in one discovery.
const MAX_ADDED: usize = 3;
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
    let mut current =
        refit::fit_softly(&data, &start, BASE_ITERATIONS).map_err(|error| DiscoverError::Base(error.to_string()))?;
    let base_fit = current.clone();
    let rotary = matches!(units.x.as_str(), "rad" | "x");
    let mut ladder = vec![rung(&data, &current)];
    let mut named: Vec<NamedEffect> = Vec::new();
    let mut first_round: Vec<CandidateRow> = Vec::new();
    let mut closest = None;
    let mut simpler: Vec<Vec<Effect<f64>>> = Vec::new();
    let mut tie: Option<(Fit, Fit, Vec<Kind>)> = None;
    let base_gap = Gap::of(&data, &current);
    let mut gap = base_gap;
    for _ in 0..MAX_ADDED {
        if !named.is_empty() && !gap.something_left() {
            break;
        }
        progress(&format!("looking for effect {} among {}", named.len() + 1, Kind::ALL.len()));
        let Some(screen) = Screen::of_all_widths(&data, &current.candidate) else { break };
        let Round { data: judged, current: without, mut tried } = candidates::try_all(&data, &current, &screen, rotary);
        tried.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        let order = preference(&judged, &without, &tried);
        if named.is_empty() {
            closest = nearest(&judged, &without, &tried, &units);
        }
        let accepted = order.iter().copied().find_map(|index| {
            let fit = refit::settled(&data, refit::converged(&judged, tried[index].fit.as_ref().ok()?));
            let after = Gap::of(&data, &fit);
            let doubted = || {
                let enough = !gap.only_outliers() && evidence(&judged, &without, &tried[index], &FURTHER);
                (!named.is_empty() && !enough && !gap.closed_by(&after))
                    .then(|| "thins what is left in a few segments, and does not close it".to_owned())
            };
            let adrift = || {
                (tried[index].kind.free_memory() == 2 && !gap.followed_by_bodies(&after))
                    .then(|| "follows short segments from a start free in each, and not the open loop".to_owned())
            };
            let refusal = gap.refuses(&after).or_else(adrift).or_else(doubted);
            let Some(reason) = refusal else { return Some((index, fit, after)) };
            remarks.push(format!("{} {reason}: not named", tried[index].kind.name()));
            tried[index].fit = Err(reason);
            None
        });
        let mut rivals = accepted.as_ref().map_or_else(Vec::new, |(i, fit, _)| rivals(&judged, fit, &tried, *i));
        rivals.retain(|rival| {
            let other = tried.iter_mut().find(|t| t.kind == rival.kind && rival.tied);
            let reason = other.as_ref().and_then(|t| gap.refuses(&Gap::of(&data, t.fit.as_ref().ok()?)));
            if let (Some(other), Some(reason)) = (other, &reason) {
                other.fit = Err(reason.clone());
            }
            reason.is_none()
        });
        if named.is_empty() {
            first_round = table(&judged, &without, &tried, accepted.as_ref().map(|a| a.0));
        }
        let Some((index, fit, after)) = accepted else { break };
        if let Some(rival) = rivals.iter().find(|r| r.tied)
            && let Some(Ok(other)) = tried.iter().find(|t| t.kind == rival.kind).map(|t| &t.fit)
        {
            tie = Some((fit.clone(), other.clone(), vec![tried[index].kind, rival.kind]));
        }
        current = fit;
        gap = after;
        simpler.push(simpler_laws(&tried, index, start.effects.len() + named.len()));
        named.push(NamedEffect { kind: tried[index].kind, parameters: Vec::new(), rivals });
        // What was named while another was still missing may have taken that one's share.
        for j in (0..named.len() - 1).rev() {
            let place = start.effects.len() + j;
            let worse = |other: &Fit| {
                let evidence = paired(&other.mse, &current.mse, &current.samples, judged.floor());
                better(&evidence, current.free.len().saturating_sub(other.free.len()))
            };
            if let Some(other) = refit::without(&judged, &current, place).filter(|other| !worse(other)) {
                remarks.push(format!("beside what was named later, nothing is left of {}", named[j].kind.name()));
                tie.take_if(|(_, _, kinds)| kinds.contains(&named[j].kind));
                named.remove(j);
                simpler.remove(j);
                gap = Gap::of(&data, &other);
                current = other;
                continue;
            }
            if let Some(other) = refit::replaced(&judged, &current, place, &simpler[j]).filter(|other| !worse(other)) {
                let (old, new) = (named[j].kind, other.candidate.effects[place].kind);
                remarks.push(format!("beside what was named later, {} does as well as {}", new.name(), old.name()));
                named[j].kind = new;
                named[j].rivals.retain(|rival| rival.kind != new);
                gap = Gap::of(&data, &other);
                current = other;
            }
        }
        ladder.push(rung(&data, &current));
    }
    if !named.is_empty() && base_gap.leaves(&gap, LEAST_TOTAL) {
        let names: Vec<&str> = named.iter().map(|n| n.kind.name()).collect();
        remarks.push(format!("{} would leave most of the gap: not named", names.join(" and ")));
        (current, gap) = (base_fit.clone(), base_gap);
        named.clear();
        ladder.truncate(1);
        tie = None;
    }
    let kinds: Vec<Kind> = named.iter().map(|n| n.kind).collect();
    let errors = data.problem().covariance(&current);
    for (j, effect) in named.iter_mut().enumerate() {
        // What is named beside it was no rival.
        effect.rivals.retain(|rival| !kinds.contains(&rival.kind));
        let place = start.effects.len() + j;
        effect.parameters = parameters(&current.candidate, place, Some(&errors), &units);
    }
    progress("drawing the map");
    let where_map = match (Screen::new(&data, &base_fit.candidate), Screen::new(&data, &current.candidate)) {
        (Some(before), Some(after)) => where_map::rows(&data, &before, &after, &units),
        _ => Vec::new(),
    };
    let open_tie = tie.filter(|(_, _, tied)| !tied.iter().all(|kind| kinds.contains(kind)));
    let next_experiment = open_tie.and_then(|(a, b, kinds)| {
        progress("designing the next experiment");
        next_experiment::deciding(&a.candidate, &b.candidate, &kinds, &limits(&data), &units)
    });
    let bodies = named.iter().any(|n| n.kind.free_memory() == 2);
    let explained = if bodies { base_gap.explained_by_bodies(&gap) } else { gap.explained() };
    let verdict = match (named.is_empty(), base_gap.real(), explained) {
        (true, false, _) => Verdict::NothingMissing,
        (true, true, _) => Verdict::Unknown,
        (false, _, true) => Verdict::Explained,
        (false, _, false) => Verdict::PartlyExplained,
    };
    Ok(Discovery {
        verdict,
        sentence: sentence(verdict, &named, &ladder, data.sigma, where_map.first().map(|w| w.coordinate)),
        effects: named,
        ladder,
        model: current.candidate.clone(),
        model_se: model_se(&current.candidate, &errors),
        base_se: [0, 1, 2].map(|i| errors.standard_error(Free::Base(i)).unwrap_or(f64::NAN)),
        noise_floor: data.sigma,
        where_map,
        candidates: first_round,
        overlays: overlays(&data, &base_fit, &current),
        next_experiment,
        nearest: closest,
        remarks,
        units,
        segments: (data.fit.len() + data.score.len(), data.available),
        seconds: 0.0,
        provenance: request.provenance.clone(),
    })
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

fn rung(data: &Data, fit: &Fit) -> Rung {
    let score = data.over(&data.score).score(&fit.candidate);
    let (square, count) =
        open_loop_squares(data, fit).iter().fold((0.0, 0), |sum, (square, n)| (sum.0 + square, sum.1 + n));
    Rung {
        effects: fit.candidate.effects.iter().map(|e| e.kind).collect(),
        base: fit.candidate.base,
        fit_rmse: root_mean(&fit.mse),
        holdout_rmse: root_mean(&score),
        holdout_open_loop_rmse: (square / count.max(1) as f64).sqrt(),
    }
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
