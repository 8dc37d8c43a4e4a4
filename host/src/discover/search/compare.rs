//! The comparison of models over the same segments: Vuong's test, with a price for every parameter.

use crate::discover::data::Data;
use crate::discover::decide::{Paired, TIED_Z, paired};
use crate::fit::Fit;

pub(super) use crate::discover::decide::{FURTHER, NAMING};

/// Nats beside the price of its parameters by which one of two models is better, where most segments bear it out.
const BETTER: f64 = 8.0;

/// What `fit` gains over `other`.
pub(super) fn gain(data: &Data, other: &Fit, fit: &Fit) -> Paired {
    paired(&other.mse, &fit.mse, &fit.samples, data.floor())
}

/// Whether the evidence for `fit` over `without`, which lacks an effect, suffices to name that.
pub(super) fn names(data: &Data, without: &Fit, fit: &Fit) -> bool {
    gain(data, without, fit).names(fit.free.len().saturating_sub(without.free.len()), &NAMING)
}

/// The same of an effect beside others that does not close the gap.
pub(super) fn names_further(data: &Data, without: &Fit, fit: &Fit) -> bool {
    gain(data, without, fit).names(fit.free.len().saturating_sub(without.free.len()), &FURTHER)
}

/// Whether paired evidence separates two models that differ by `extra` parameters: by most segments, or, where a few tell
/// them apart (a phase of rest, an edge), by a likelihood beyond doubt.
pub(super) fn better(evidence: &Paired, extra: usize) -> bool {
    let price = NAMING.price * extra as f64;
    (evidence.z > TIED_Z && evidence.lambda > BETTER + price) || evidence.beyond_doubt(extra, NAMING.price)
}

/// Whether the model carries a second body, whose start is free in every segment.
pub(super) fn has_body(fit: &Fit) -> bool {
    fit.candidate.effects.iter().any(|effect| effect.kind.second_body())
}

/// Whether `fit` is tied with `best`, whose cost is lower, or pays for having fewer parameters: a second body's start is free in
/// every segment, position and velocity, each worth half a nat where no body is.
pub(super) fn as_good(data: &Data, fit: &Fit, best: &Fit) -> bool {
    let against = gain(data, fit, best);
    let starts = if has_body(best) && !has_body(fit) { best.mse.len() } else { 0 };
    !better(&against, best.free.len().saturating_sub(fit.free.len())) || against.lambda < starts as f64
}

/// Of fits in the order of their costs, the one with the fewest parameters among those tied with the first, and of several the one
/// with the greatest likelihood ratio over `current`, which counts effective samples and not the two best segments; one with a
/// second body only where all have one.
pub(super) fn simplest(data: &Data, current: &Fit, fits: &[&Fit]) -> Option<usize> {
    let best = fits.first()?;
    let tied = fits.iter().enumerate().filter(|(_, fit)| as_good(data, fit, best));
    let order = |(_, a): &(usize, &&Fit), (_, b): &(usize, &&Fit)| {
        let key = |fit: &Fit| (has_body(fit), fit.free.len());
        let lambda = |fit: &Fit| gain(data, current, fit).lambda;
        key(a).cmp(&key(b)).then_with(|| lambda(b).total_cmp(&lambda(a)))
    };
    tied.min_by(order).map(|(rank, _)| rank)
}
