//! The comparison of models over the same segments: Vuong's test, with a price for every parameter.

use crate::discover::data::Data;
use crate::discover::decide::{Paired, TIED_Z, paired};
use crate::fit::Fit;

pub(super) use crate::discover::decide::{FURTHER, NAMING};

/// Nats, beside the price of its parameters, by which a model must be better where most segments bear it out.
const BETTER: f64 = 8.0;

/// The paired comparison of `other` with `fit`: positive in favour of `fit`.
pub(super) fn gain(data: &Data, other: &Fit, fit: &Fit) -> Paired {
    paired(&other.mse, &fit.mse, &fit.samples, data.floor())
}

/// Whether the evidence for `fit` suffices to name the effect that `without` lacks.
pub(super) fn names(data: &Data, without: &Fit, fit: &Fit) -> bool {
    gain(data, without, fit).names(fit.free.len().saturating_sub(without.free.len()), &NAMING)
}

/// The same for an effect beside others that does not close the gap.
pub(super) fn names_further(data: &Data, without: &Fit, fit: &Fit) -> bool {
    gain(data, without, fit).names(fit.free.len().saturating_sub(without.free.len()), &FURTHER)
}

/// Whether paired evidence separates two models that differ by `extra` parameters. Most segments must tell them apart,
/// or a few must do so beyond doubt. A phase of rest or an edge lies in few segments.
pub(super) fn better(evidence: &Paired, extra: usize) -> bool {
    let price = NAMING.price * extra as f64;
    (evidence.z > TIED_Z && evidence.lambda > BETTER + price) || evidence.beyond_doubt(extra, NAMING.price)
}

/// Whether the model carries a second body, whose start is free in every segment.
pub(super) fn has_body(fit: &Fit) -> bool {
    fit.candidate.effects.iter().any(|effect| effect.kind.second_body())
}

/// Whether `fit` is tied with `best`, whose cost is lower. Fewer parameters count as much as their price. Where only
/// `best` has a second body, `fit` may also be behind by a nat for each segment. There the body's free position and
/// velocity are worth half a nat each, even where no body is.
pub(super) fn as_good(data: &Data, fit: &Fit, best: &Fit) -> bool {
    let against = gain(data, fit, best);
    let starts = if has_body(best) && !has_body(fit) { best.mse.len() } else { 0 };
    !better(&against, best.free.len().saturating_sub(fit.free.len())) || against.lambda < starts as f64
}

/// The simplest of the fits that are tied with the first; `fits` are in the order of their costs. One without a second
/// body comes first, then one with fewer parameters. The last criterion is the likelihood ratio over `current`, in
/// effective samples and without the two best segments.
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
