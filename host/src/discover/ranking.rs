//! Which effects have evidence enough, in which order they are considered, and which of the others come close.

use breakaway_core::plant::{Effect, Kind};

use super::candidates::Tried;
use super::data::Data;
use super::decide::{NAMING, Paired, TIED_Z, Thresholds, paired};
use super::outcome::{CandidateRow, ParameterValue, Rival};
use crate::identify::shooting::{Candidate, Covariance, Fit, Free};
use crate::model::catalogue::unit;
use crate::recording::Units;

/// Effects with enough evidence that are checked on held-out data in a round.
const CONSIDERED: usize = 4;

/// Whether the evidence for an effect suffices.
pub(super) fn evidence(data: &Data, current: &Fit, tried: &Tried, asked: &Thresholds) -> bool {
    tried.fit.as_ref().is_ok_and(|fit| {
        let evidence = paired(&current.mse, &fit.mse, &fit.samples, data.floor());
        evidence.names(fit.free.len() - current.free.len(), asked)
    })
}

/// The effects whose evidence suffices, in the order in which they are considered: the best first, but among those tied
/// with it the one with the fewest parameters; then the others by their cost, a few.
pub(super) fn preference(data: &Data, current: &Fit, tried: &[Tried]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..tried.len()).filter(|i| evidence(data, current, &tried[*i], &NAMING)).take(CONSIDERED).collect();
    let fits: Vec<&Fit> = order.iter().filter_map(|i| tried[*i].fit.as_ref().ok()).collect();
    let Some(simplest) = simplest(data, current, &fits) else { return order };
    let preferred = order.remove(simplest);
    order.insert(0, preferred);
    order
}

/// Effects of a round other than `named` whose evidence suffices, without a second body, in the order in which most segments bear
/// them out.
pub(super) fn others(data: &Data, current: &Fit, tried: &[Tried], named: Kind) -> Vec<usize> {
    let mut others: Vec<(usize, f64)> = tried
        .iter()
        .enumerate()
        .filter(|(_, t)| t.kind != named && !t.kind.second_body() && evidence(data, current, t, &NAMING))
        .filter_map(|(i, t)| {
            let fit = t.fit.as_ref().ok()?;
            Some((i, paired(&current.mse, &fit.mse, &fit.samples, data.floor()).z))
        })
        .collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    others.into_iter().map(|(i, _)| i).collect()
}

/// Of fits in the order of their costs, the one with the fewest parameters among those tied with the first, and of several the one
/// with the greatest likelihood ratio, which counts effective samples and not the two best segments; one with a second body only
/// where all have one.
fn simplest(data: &Data, current: &Fit, fits: &[&Fit]) -> Option<usize> {
    let best = fits.first()?;
    let lambda = |fit: &Fit| paired(&current.mse, &fit.mse, &fit.samples, data.floor()).lambda;
    let as_good = fits.iter().enumerate().filter(|(_, fit)| as_good(data, fit, best));
    let order = |(_, a): &(usize, &&Fit), (_, b): &(usize, &&Fit)| {
        let key = |fit: &Fit| (has_body(fit), fit.free.len());
        key(a).cmp(&key(b)).then_with(|| lambda(b).total_cmp(&lambda(a)))
    };
    as_good.min_by(order).map(|(rank, _)| rank)
}

fn has_body(fit: &Fit) -> bool {
    fit.candidate.effects.iter().any(|effect| effect.kind.second_body())
}

/// Whether `fit` is tied with `best`, whose cost is lower, or pays for having fewer parameters: a second body's start is free in
/// every segment, position and velocity, each worth half a nat where no body is.
fn as_good(data: &Data, fit: &Fit, best: &Fit) -> bool {
    let against = paired(&fit.mse, &best.mse, &best.samples, data.floor());
    let starts = if has_body(best) && !has_body(fit) { best.mse.len() } else { 0 };
    !better(&against, best.free.len().saturating_sub(fit.free.len())) || against.lambda < starts as f64
}

/// Whether paired evidence separates two models that differ by `extra` parameters: by most segments, or, where a few tell
/// them apart (a phase of rest, an edge), by a likelihood beyond doubt.
pub(super) fn better(evidence: &Paired, extra: usize) -> bool {
    let price = NAMING.price * extra as f64;
    (evidence.z > TIED_Z && evidence.lambda > 8.0 + price) || evidence.beyond_doubt(extra, NAMING.price)
}

/// The laws to try in the place of the named one once another effect is there: what is tied with it, and what it may be
/// confused with or has as special cases, though it was far behind or not believed while the other was missing; but no second
/// body that was, whose starts gain wherever something is left.
pub(super) fn instead(tried: &[Tried], named: usize, rivals: &[Rival], place: usize) -> Vec<Effect<f64>> {
    let kind = tried[named].kind;
    let tied = |other: Kind| rivals.iter().any(|rival| rival.tied && rival.kind == other);
    tried
        .iter()
        .filter(|t| t.kind != kind && (tied(t.kind) || (like(kind, t.kind) && !t.kind.second_body())))
        .filter_map(|t| t.fit.as_ref().ok().and_then(|fit| fit.candidate.effects.get(place).copied()).or(t.begun))
        .collect()
}

/// Whether `named` may be confused with `other`, or has it as a special case.
pub(super) fn like(named: Kind, other: Kind) -> bool {
    named.definition().confused_with.contains(&other.name()) || special_case(other, named)
}

/// The effect that comes closest where none is named, said with its parameters: its likelihood suffices, and the segments or
/// the held-out data do not bear it out. Of several that are tied it is the simplest, and the others are said.
pub(super) fn nearest(data: &Data, current: &Fit, tried: &[Tried], units: &Units) -> Option<String> {
    let evidence = |fit: &Fit| paired(&current.mse, &fit.mse, &fit.samples, data.floor());
    let enough =
        |fit: &Fit| evidence(fit).lambda - NAMING.price * (fit.free.len() - current.free.len()) as f64 >= NAMING.lambda;
    // They are in the order of their cost.
    let fits: Vec<(Kind, &Fit)> =
        tried.iter().filter_map(|t| Some((t.kind, t.fit.as_ref().ok()?))).filter(|(_, fit)| enough(fit)).collect();
    let index = simplest(data, current, &fits.iter().map(|(_, fit)| *fit).collect::<Vec<_>>())?;
    let (kind, fit) = fits[index];
    let others = fits.iter().filter(|(other, fit)| *other != kind && as_good(data, fit, fits[0].1));
    let others: Vec<&str> = others.map(|(other, _)| other.name()).collect();
    let evidence = evidence(fit);
    let place = fit.candidate.effects.len() - 1;
    let parameters: Vec<String> = parameters(&fit.candidate, place, None, units)
        .iter()
        .map(|p| format!("{} = {:.3} {}", p.symbol, p.value, p.unit))
        .collect();
    let tied = if others.is_empty() { String::new() } else { format!("; tied with it: {}", others.join(", ")) };
    Some(format!(
        "over segments of {} s {} comes closest ({}; λ {:.0}, z {:.1}{tied}), and is not borne out by {}",
        data.segment_s,
        kind.name(),
        parameters.join(", "),
        evidence.lambda,
        evidence.z,
        if evidence.names(fit.free.len() - current.free.len(), &NAMING) { "held-out data" } else { "most segments" }
    ))
}

/// Whether a law that does no better with more parameters is a rival all the same: these recordings may lack what tells the
/// two apart. Others pay for nothing, or have the named one as a special case.
pub(super) fn look_alike(named: Kind, other: Kind) -> bool {
    named.definition().confused_with.contains(&other.name()) && !special_case(named, other)
}

/// Whether `law` is `general` with certain parameters, or in the limit: a ripple longer than what was recorded is a load.
pub(super) fn special_case(law: Kind, general: Kind) -> bool {
    match general {
        Kind::LuGre => matches!(law, Kind::Dahl | Kind::Stribeck),
        Kind::Cogging => matches!(law, Kind::GravityLoad | Kind::ConstantLoad),
        Kind::TimePeriodic => law == Kind::ConstantLoad,
        _ => false,
    }
}

pub(super) fn rivals(data: &Data, winner: &Fit, tried: &[Tried], index: usize) -> Vec<Rival> {
    let mut rivals: Vec<Rival> = tried
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != index)
        .filter_map(|(_, t)| {
            let fit = t.fit.as_ref().ok()?;
            let p = paired(&fit.mse, &winner.mse, &winner.samples, data.floor());
            let richer = fit.free.len() > winner.free.len() && p.delta > -0.5 * NAMING.delta;
            let idle = richer && !look_alike(tried[index].kind, t.kind);
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
                    let named = winner.map(|i| tried[i].kind);
                    let idle = named.is_none_or(|named| !look_alike(named, t.kind));
                    if idle && fit.free.len() > best.free.len() && against.delta > -0.5 * NAMING.delta {
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

/// What is free, or differs from its default, of effect `j`; with its standard errors where `errors` are given.
pub(super) fn parameters(
    model: &Candidate,
    j: usize,
    errors: Option<&Covariance>,
    units: &Units,
) -> Vec<ParameterValue> {
    let effect: &Effect<f64> = &model.effects[j];
    let definitions = effect.kind.definition().parameters.iter().enumerate();
    definitions
        .filter(|(i, p)| p.default.is_none_or(|default| effect.p[*i] != default))
        .map(|(i, p)| ParameterValue {
            symbol: p.symbol,
            unit: unit(p.unit, units),
            meaning: p.meaning,
            value: effect.p[i],
            // What is held, a whole number of waves, has no error.
            se: errors.and_then(|errors| errors.standard_error(Free::Effect(j, i))).unwrap_or(f64::NAN),
        })
        .collect()
}

#[cfg(test)]
mod tests;
