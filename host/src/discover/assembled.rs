//! A discovery with its maps, its overlays, and the experiment that would decide a tie.

use super::data::Data;
use super::next_experiment::{self, Limits};
use super::outcome::{Discovery, Overlay};
use super::prepared::Prepared;
use super::progress::{Progress, Watch};
use super::request::Request;
use super::screen::Screen;
use super::search::{Ended, Tie};
use super::where_map;
use crate::fit::{Candidate, Covariance, Fit, Free};
use crate::recording::Units;

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
