//! The effects that the search tried, as the report shows them.

use breakaway_core::plant::{Effect, Kind};

use super::add::Round;
use super::compare::{NAMING, as_good, better, gain, names, simplest};
use crate::discover::decide::Thresholds;
use crate::discover::outcome::{CandidateRow, ParameterValue, Rival};
use crate::fit::{Candidate, Covariance, Fit, Free};
use crate::model::catalogue::unit;
use crate::recording::Units;

/// Most rivals that are listed.
const RIVALS: usize = 5;

/// The effects of a round that come closest to `own`, which is in the fit `winner`.
pub(super) fn rivals(round: &Round, winner: &Fit, own: Kind) -> Vec<Rival> {
    let others = round.tried.iter().filter(|tried| tried.kind != own);
    let mut rivals: Vec<Rival> = others
        .filter_map(|tried| {
            let fit = tried.fit.as_ref().ok()?;
            let p = gain(&round.data, fit, winner);
            let richer = fit.free.len() > winner.free.len() && p.delta > -0.5 * NAMING.delta;
            let idle = richer && !own.resembles(tried.kind);
            Some(Rival { kind: tried.kind, delta: p.delta, z: p.z, tied: !idle && !better(&p, 0) })
        })
        .collect();
    rivals.sort_by(|a, b| a.delta.total_cmp(&b.delta));
    rivals.truncate(RIVALS);
    rivals
}

/// The fate of every effect of a round, in which `named` was named with these rivals.
pub(super) fn table(round: &Round, named: Option<Kind>, rivals: &[Rival]) -> Vec<CandidateRow> {
    let winner = round.tried.iter().find(|tried| Some(tried.kind) == named).and_then(|tried| tried.fit.as_ref().ok());
    let fate = |kind: Kind, fit: &Fit| {
        let extra = fit.free.len().saturating_sub(round.without.free.len());
        if Some(kind) == named {
            return "named".to_owned();
        }
        if !names(&round.data, &round.without, fit) {
            let lambda = NAMING.lambda + NAMING.price * extra as f64;
            let Thresholds { delta, z, .. } = NAMING;
            return format!("its gain is not significant (asked: Δ ≥ {delta}, z ≥ {z}, λ ≥ {lambda})");
        }
        let Some(winner) = winner else { return "not the best".to_owned() };
        let against = gain(&round.data, fit, winner);
        let idle = named.is_none_or(|named| !named.resembles(kind));
        if rivals.iter().any(|rival| rival.kind == kind && rival.tied) {
            "tied: these recordings cannot tell it from the named effect".to_owned()
        } else if idle && fit.free.len() > winner.free.len() && against.delta > -0.5 * NAMING.delta {
            "does no better with more parameters".to_owned()
        } else {
            format!("loses to the named effect by Δ {:.3}, z {:.1}", against.delta, against.z)
        }
    };
    let row = |kind: Kind, fit: &Result<Fit, String>| match fit {
        Err(reason) => CandidateRow { kind, delta: f64::NAN, z: f64::NAN, lambda: f64::NAN, fate: reason.clone() },
        Ok(fit) => {
            let p = gain(&round.data, &round.without, fit);
            CandidateRow { kind, delta: p.delta, z: p.z, lambda: p.lambda, fate: fate(kind, fit) }
        }
    };
    round.tried.iter().map(|tried| row(tried.kind, &tried.fit)).collect()
}

/// The effect that comes closest where none is named, in words with its parameters. Its likelihood suffices, and the
/// segments or the held-out data do not bear it out. It is the simplest of those tied, which are listed too.
pub(super) fn nearest(round: &Round, units: &Units) -> Option<String> {
    let Round { data, without, tried } = round;
    let enough = |fit: &Fit| {
        let price = NAMING.price * (fit.free.len() - without.free.len()) as f64;
        gain(data, without, fit).lambda - price >= NAMING.lambda
    };
    // They are in the order of their cost.
    let fits: Vec<(Kind, &Fit)> =
        tried.iter().filter_map(|t| Some((t.kind, t.fit.as_ref().ok()?))).filter(|(_, fit)| enough(fit)).collect();
    let index = simplest(data, without, &fits.iter().map(|(_, fit)| *fit).collect::<Vec<_>>())?;
    let (kind, fit) = fits[index];
    let others = fits.iter().filter(|(other, fit)| *other != kind && as_good(data, fit, fits[0].1));
    let others: Vec<&str> = others.map(|(other, _)| other.name()).collect();
    let evidence = gain(data, without, fit);
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
        if names(data, without, fit) { "held-out data" } else { "most segments" }
    ))
}

/// The parameters of effect `j` that differ from a default or have none. Standard errors are given with `errors`.
pub(in crate::discover) fn parameters(
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
            // A whole number of waves is held, and has no standard error.
            se: errors.and_then(|errors| errors.standard_error(Free::Effect(j, i))).unwrap_or(f64::NAN),
        })
        .collect()
}
