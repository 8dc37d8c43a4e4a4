//! The chain: locate, name, add, show; until nothing more can be named.

use std::time::Instant;

use breakaway_core::plant::{Base, Effect, Kind};

use super::candidates::{self, Round, Tried};
use super::data::Data;
use super::decide::{FURTHER, NAMING, Paired, TIED_Z, paired};
use super::next_experiment::{self, Limits};
use super::outcome::{CandidateRow, Discovery, NamedEffect, Overlay, ParameterValue, Provenance, Rival, Rung, Verdict};
use super::screen::Screen;
use super::where_map;
use crate::identify::estimate::{self, IdentifyError};
use crate::identify::shooting::{Candidate, Fit, Free};
use crate::model::catalogue::unit;
use crate::recording::{Recording, Units};

/// Effects with enough evidence that are checked on held-out data in a round.
const CONSIDERED: usize = 4;
/// Iterations of the base model's fit.
const BASE_ITERATIONS: usize = 20;
/// Most effects added in one discovery.
const MAX_ADDED: usize = 3;
/// The gap, mean of ln((σ² + mse)/2σ²) over held-out segments, that counts as within the noise.
const GAP_NOISE: f64 = 0.06;
/// Share of held-out segments that may stay above twice the noise's mean square in an explained record.
const LEFT_OVER: f64 = 0.05;
/// The median segment's mean square over the noise's below which no further effect is looked for.
const OUTLIERS: f64 = 1.15;
/// An effect that explains less than this share of the mean square gap is not named, nor are all together below the other:
/// they would leave most of it.
const LEAST_SHARE: f64 = 0.25;
const LEAST_TOTAL: f64 = 0.5;
/// Growth of the open-loop mean square error on held-out data at which an effect is not believed.
const OPEN_LOOP_GROWTH: f64 = 1.5;
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
/// # Errors
/// [`DiscoverError`].
pub fn discover(request: &Request, progress: &(dyn Fn(&str) + Sync)) -> Result<Discovery, DiscoverError> {
    let began = Instant::now();
    let units = same_units(request)?;
    progress("preparing the recordings");
    let data = Data::new(&request.recordings, &request.holdout);
    if data.fit.len() < 3 || data.score.is_empty() {
        return Err(DiscoverError::TooShort(super::data::FIT_SEGMENT_S));
    }
    let identified = estimate::identify(&request.recordings)?;
    let start = starting_model(request, &identified)?;
    progress("fitting the base model");
    let mut current = candidates::fit_softly(&data, &start, BASE_ITERATIONS)
        .map_err(|error| DiscoverError::Base(error.to_string()))?;
    let base_fit = current.clone();
    let rotary = matches!(units.x.as_str(), "rad" | "x");
    let mut ladder = vec![rung(&data, &current)];
    let mut named: Vec<NamedEffect> = Vec::new();
    let mut first_round: Vec<CandidateRow> = Vec::new();
    let mut simpler: Vec<Vec<Effect<f64>>> = Vec::new();
    let mut tie: Option<(Fit, Fit, Vec<Kind>)> = None;
    let base_gap = Gap::of(&data, &current);
    let mut gap = base_gap;
    let mut remarks = identified.remarks;
    while named.len() < MAX_ADDED && (named.is_empty() || !gap.only_outliers()) {
        progress(&format!("looking for effect {} among {}", named.len() + 1, Kind::ALL.len()));
        let Some(screen) = Screen::new(&data, &current.candidate) else { break };
        let Round { data: judged, current: without, mut tried } = candidates::try_all(&data, &current, &screen, rotary);
        tried.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        let order = preference(&judged, &without, &tried, named.is_empty());
        let accepted = order.iter().copied().find_map(|index| {
            let fit = candidates::converged(&judged, tried[index].fit.as_ref().ok()?);
            let after = Gap::of(&data, &fit);
            let Some(reason) = gap.refuses(&after) else { return Some((index, fit, after)) };
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
        for j in 0..named.len() - 1 {
            let place = start.effects.len() + j;
            if let Some(other) = candidates::replaced(&judged, &current, place, &simpler[j])
                && !better(&paired(&other.mse, &current.mse, &current.samples, judged.floor()), 1)
            {
                named[j].kind = other.candidate.effects[place].kind;
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
    for (j, effect) in named.iter_mut().enumerate() {
        let place = start.effects.len() + j;
        effect.parameters = parameters(&current, place, &units);
    }
    progress("drawing the map");
    let where_map = match (Screen::new(&data, &base_fit.candidate), Screen::new(&data, &current.candidate)) {
        (Some(before), Some(after)) => where_map::rows(&data, &before, &after, &units),
        _ => Vec::new(),
    };
    let next_experiment = tie.and_then(|(a, b, kinds)| {
        progress("designing the next experiment");
        next_experiment::deciding(&a.candidate, &b.candidate, &kinds, &limits(&data), &units)
    });
    let verdict = match (named.is_empty(), base_gap.real(), gap.explained()) {
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
        model_se: model_se(&current),
        base_se: [0, 1, 2].map(|i| current.standard_error(Free::Base(i)).unwrap_or(f64::NAN)),
        noise_floor: data.sigma,
        where_map,
        candidates: first_round,
        overlays: overlays(&data, &base_fit, &current),
        next_experiment,
        remarks,
        units,
        segments: (data.fit.len() + data.score.len(), data.available),
        seconds: began.elapsed().as_secs_f64(),
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

fn starting_model(request: &Request, identified: &estimate::Identified) -> Result<Candidate, DiscoverError> {
    let best = &identified.best;
    let base = Base { b: best.b.value, c: best.c.value.max(0.0), f1: best.f1.value.max(0.0) };
    let Some(model) = &request.model else { return Ok(Candidate { base, effects: Vec::new() }) };
    let factor = (model.base.b / base.b).max(base.b / model.base.b);
    if factor > UNITS_FACTOR {
        return Err(DiscoverError::ModelUnits { model: model.base.b, data: base.b, factor });
    }
    Ok(Candidate { base, effects: model.effects.clone() })
}

/// How far a model is from the held-out data.
#[derive(Clone, Copy, Debug)]
struct Gap {
    mean_log: f64,
    /// Root mean square error.
    rmse: f64,
    /// Mean square error beyond the noise's, without the worst tenth of the segments.
    excess: f64,
    /// Mean square of the median segment over the noise's.
    median: f64,
    /// Share of segments above twice the noise's mean square.
    above: f64,
    /// Mean square error of the open-loop windows, simulated from the smoothed motion at their start.
    open_loop: f64,
}

impl Gap {
    fn of(data: &Data, fit: &Fit) -> Self {
        let floor = data.sigma * data.sigma;
        let mse = data.over(&data.score).score(&fit.candidate);
        let n = mse.len() as f64;
        // A few segments that diverge (an impact, a missed stick) do not set the mean square: the upper decile is cut.
        let trimmed = |sorted: &[f64]| {
            let kept = &sorted[..(sorted.len() * 9).div_ceil(10)];
            kept.iter().sum::<f64>() / kept.len().max(1) as f64
        };
        let mut sorted = mse.clone();
        sorted.sort_by(f64::total_cmp);
        let mut open: Vec<f64> = open_loop_squares(data, fit).iter().map(|(square, n)| square / *n as f64).collect();
        open.sort_by(f64::total_cmp);
        Self {
            open_loop: trimmed(&open),
            rmse: root_mean(&mse),
            median: sorted[sorted.len() / 2] / floor,
            mean_log: mse.iter().map(|m| ((floor + m) / (2.0 * floor)).ln()).sum::<f64>() / n,
            excess: (trimmed(&sorted) - floor).max(1e-3 * floor),
            above: mse.iter().filter(|m| **m > 2.0 * floor).count() as f64 / n,
        }
    }
    /// Why a model with the gap `after` is no progress on held-out data; `None` if it is.
    fn refuses(&self, after: &Self) -> Option<String> {
        if after.mean_log >= self.mean_log || after.excess > 1.05 * self.excess || after.rmse > 1.5 * self.rmse {
            return Some("fits, but does not hold on held-out data".to_owned());
        }
        // Starts that are fitted in every segment can hide what goes wrong within a second.
        if after.open_loop > OPEN_LOOP_GROWTH * self.open_loop {
            return Some("fits short segments, but drifts off in open loop".to_owned());
        }
        self.leaves(after, LEAST_SHARE)
            .then(|| format!("would explain only {:.0} % of the mean square gap", 100.0 * self.share(after)))
    }
    /// Share of the mean square gap that the model with the gap `after` explains.
    fn share(&self, after: &Self) -> f64 {
        1.0 - after.excess / self.excess
    }
    /// Whether it explains less than `least` of the mean square, and of the logarithm less than half.
    fn leaves(&self, after: &Self, least: f64) -> bool {
        self.share(after) < least && after.mean_log > 0.5 * self.mean_log
    }
    fn real(&self) -> bool {
        self.mean_log > GAP_NOISE && self.above > LEFT_OVER
    }
    /// Whether the typical segment is down to the noise: what is left lies in a few, where a further effect would be fitted to
    /// outliers.
    fn only_outliers(&self) -> bool {
        self.median < OUTLIERS
    }
    fn explained(&self) -> bool {
        self.mean_log < GAP_NOISE && self.above <= LEFT_OVER
    }
}

/// The effects whose evidence suffices, in the order in which they are considered: the best first, but among those tied
/// with it the one with the fewest parameters; then the others by their cost, a few.
fn preference(data: &Data, current: &Fit, tried: &[Tried], first: bool) -> Vec<usize> {
    let asked = if first { &NAMING } else { &FURTHER };
    let mut order: Vec<usize> = (0..tried.len())
        .filter(|i| {
            tried[*i].fit.as_ref().is_ok_and(|fit| {
                let evidence = paired(&current.mse, &fit.mse, &fit.samples, data.floor());
                evidence.names(fit.free.len() - current.free.len(), asked)
            })
        })
        .take(CONSIDERED)
        .collect();
    let fits: Vec<&Fit> = order.iter().filter_map(|i| tried[*i].fit.as_ref().ok()).collect();
    let Some(best) = fits.first() else { return order };
    let simplest = fits
        .iter()
        .enumerate()
        .filter(|(_, fit)| {
            let against = paired(&fit.mse, &best.mse, &best.samples, data.floor());
            !better(&against, best.free.len().saturating_sub(fit.free.len()))
        })
        .min_by_key(|(rank, fit)| (fit.free.len(), *rank))
        .map_or(0, |(rank, _)| rank);
    let preferred = order.remove(simplest);
    order.insert(0, preferred);
    order
}

/// Whether paired evidence separates two models that differ by `extra` parameters: by most segments, or, where a few tell
/// them apart (a phase of rest, an edge), by a likelihood beyond doubt.
fn better(evidence: &Paired, extra: usize) -> bool {
    let price = NAMING.price * extra as f64;
    (evidence.z > TIED_Z && evidence.lambda > 8.0 + price) || (evidence.z > 1.2 && evidence.lambda > 100.0 + price)
}

/// The laws with fewer parameters than the named one that it may be confused with, as they were fitted beside it.
fn simpler_laws(tried: &[Tried], named: usize, place: usize) -> Vec<Effect<f64>> {
    let definition = tried[named].kind.definition();
    let Ok(winner) = &tried[named].fit else { return Vec::new() };
    tried
        .iter()
        .filter(|t| definition.confused_with.contains(&t.kind.name()))
        .filter_map(|t| t.fit.as_ref().ok())
        .filter(|fit| fit.free.len() < winner.free.len())
        .filter_map(|fit| fit.candidate.effects.get(place).copied())
        .collect()
}

fn rivals(data: &Data, winner: &Fit, tried: &[Tried], index: usize) -> Vec<Rival> {
    let mut rivals: Vec<Rival> = tried
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != index)
        .filter_map(|(_, t)| {
            let fit = t.fit.as_ref().ok()?;
            let p = paired(&fit.mse, &winner.mse, &winner.samples, data.floor());
            // A richer law that does no better is no rival: it has the named one as a special case, or pays for nothing.
            let idle = fit.free.len() > winner.free.len() && p.delta > -0.5 * NAMING.delta;
            Some(Rival { kind: t.kind, delta: p.delta, z: p.z, tied: !idle && !better(&p, 0) })
        })
        .collect();
    rivals.sort_by(|a, b| a.delta.total_cmp(&b.delta));
    rivals.truncate(5);
    rivals
}

fn table(data: &Data, current: &Fit, tried: &[Tried], winner: Option<usize>) -> Vec<CandidateRow> {
    let best = winner.and_then(|i| tried[i].fit.as_ref().ok());
    tried
        .iter()
        .enumerate()
        .map(|(i, t)| match &t.fit {
            Err(reason) => {
                CandidateRow { kind: t.kind, delta: f64::NAN, z: f64::NAN, lambda: f64::NAN, fate: reason.clone() }
            }
            Ok(fit) => {
                let p = paired(&current.mse, &fit.mse, &fit.samples, data.floor());
                let k = fit.free.len() - current.free.len();
                let fate = if Some(i) == winner {
                    "named".to_owned()
                } else if !p.names(k, &NAMING) {
                    format!(
                        "its gain is not significant (asked: Δ ≥ {}, z ≥ {}, λ ≥ {})",
                        NAMING.delta,
                        NAMING.z,
                        NAMING.lambda + NAMING.price * k as f64
                    )
                } else if let Some(best) = best {
                    let against = paired(&fit.mse, &best.mse, &best.samples, data.floor());
                    if fit.free.len() > best.free.len() && against.delta > -0.5 * NAMING.delta {
                        "does no better with more parameters".to_owned()
                    } else if better(&against, 0) {
                        format!("loses to the named effect by Δ {:.3}, z {:.1}", against.delta, against.z)
                    } else {
                        "tied: these recordings cannot tell it from the named effect".to_owned()
                    }
                } else {
                    "not the best".to_owned()
                };
                CandidateRow { kind: t.kind, delta: p.delta, z: p.z, lambda: p.lambda, fate }
            }
        })
        .collect()
}

fn parameters(fit: &Fit, j: usize, units: &Units) -> Vec<ParameterValue> {
    let effect: &Effect<f64> = &fit.candidate.effects[j];
    let definitions = effect.kind.definition().parameters.iter().enumerate();
    definitions
        .filter(|(i, p)| p.default.is_none_or(|default| effect.p[*i] != default))
        .map(|(i, p)| ParameterValue {
            symbol: p.symbol,
            unit: unit(p.unit, units),
            meaning: p.meaning,
            value: effect.p[i],
            se: fit.standard_error(Free::Effect(j, i)).unwrap_or(f64::NAN),
        })
        .collect()
}

fn model_se(fit: &Fit) -> Vec<Vec<f64>> {
    let effects = fit.candidate.effects.iter().enumerate();
    effects
        .map(|(j, effect)| {
            let count = effect.kind.definition().parameters.len();
            (0..count).map(|i| fit.standard_error(Free::Effect(j, i)).unwrap_or(f64::NAN)).collect()
        })
        .collect()
}

fn root_mean(mse: &[f64]) -> f64 {
    (mse.iter().sum::<f64>() / mse.len().max(1) as f64).sqrt()
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

/// Sum of squares and samples of every open-loop window, simulated from the smoothed motion at its start.
fn open_loop_squares(data: &Data, fit: &Fit) -> Vec<(f64, usize)> {
    let open = data.over(&data.open_loop);
    let windows = data.open_loop.iter().zip(open.smoothed_initial(&fit.candidate));
    windows
        .map(|(segment, initial)| {
            let measured = &data.tracks[segment.track].x[segment.start..segment.start + segment.len];
            let simulated = open.positions(&fit.candidate, *segment, initial);
            (simulated.iter().zip(measured).map(|(s, m)| (s - m).powi(2)).sum(), segment.len)
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
