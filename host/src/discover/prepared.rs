//! The recordings, cut into segments, and the base model that a discovery starts from.

use breakaway_core::plant::Base;

use super::data::Data;
use super::gap::{AT_THE_NOISE, open_loop_squares};
use super::judge::ruling::Ruling;
use super::progress::{Progress, Watch};
use super::request::{DiscoverError, Request};
use super::search::fit_softly;
use crate::fit::{Candidate, Fit, FitError};
use crate::identify::estimate;

/// Iterations of the base model's fit.
const BASE_ITERATIONS: usize = 20;
/// Largest factor between a given model's inertia and the recordings'. Beyond it the model is of another machine, or in
/// other units.
const UNITS_FACTOR: f64 = 20.0;

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
