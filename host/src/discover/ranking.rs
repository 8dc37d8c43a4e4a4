//! Which effects have evidence enough, in which order they are considered, and which of the others come close.

use breakaway_core::plant::Effect;

use super::candidates::Tried;
use super::data::Data;
use super::decide::{FURTHER, NAMING, Paired, TIED_Z, paired};
use super::outcome::{CandidateRow, Rival};
use crate::identify::shooting::Fit;

/// Effects with enough evidence that are checked on held-out data in a round.
const CONSIDERED: usize = 4;

/// The effects whose evidence suffices, in the order in which they are considered: the best first, but among those tied
/// with it the one with the fewest parameters; then the others by their cost, a few.
pub(super) fn preference(data: &Data, current: &Fit, tried: &[Tried], first: bool) -> Vec<usize> {
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
pub(super) fn better(evidence: &Paired, extra: usize) -> bool {
    let price = NAMING.price * extra as f64;
    (evidence.z > TIED_Z && evidence.lambda > 8.0 + price) || (evidence.z > 1.2 && evidence.lambda > 100.0 + price)
}

/// The laws with fewer parameters than the named one that it may be confused with, as they were fitted beside it.
pub(super) fn simpler_laws(tried: &[Tried], named: usize, place: usize) -> Vec<Effect<f64>> {
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

pub(super) fn rivals(data: &Data, winner: &Fit, tried: &[Tried], index: usize) -> Vec<Rival> {
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

pub(super) fn table(data: &Data, current: &Fit, tried: &[Tried], winner: Option<usize>) -> Vec<CandidateRow> {
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
