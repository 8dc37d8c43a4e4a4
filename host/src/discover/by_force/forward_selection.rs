//! Which of the small and the seen effects the simulated motion bears out.

use super::super::judge::ruling::Ruling;

/// The ruling whose small and seen effects the simulated motion bears out, and its fit. Where the motion is better without
/// the small names they go. Else what is seen is added, the best first, as long as the motion is better with it. `error`
/// gives the open-loop error of another ruling's fit, where that is better than the best so far.
pub(super) fn forward_selection<F>(
    ruling: &Ruling,
    fit: impl Fn(&Ruling) -> F,
    error: impl Fn(&Ruling, &F, &F) -> Option<f64>,
) -> (Ruling, F) {
    let mut best = (ruling.clone(), fit(ruling));
    if let Some(without) = ruling.without_small() {
        let own = fit(&without);
        if error(&without, &own, &best.1).is_some() {
            return (without, own);
        }
    }
    loop {
        let each = best.0.with_each_seen().into_iter().map(|other| {
            let own = fit(&other);
            (error(&other, &own, &best.1), other, own)
        });
        let better = each.filter_map(|(error, other, own)| Some((error?, other, own)));
        let Some((_, other, own)) = better.min_by(|a, b| a.0.total_cmp(&b.0)) else { return best };
        best = (other, own);
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::super::judge::finding::Finding;
    use super::*;

    /// Of two effects that are seen, stiction leaves less in open loop, and nothing is better with the curve too. So
    /// stiction is named, and the curve stays seen.
    #[test]
    fn what_is_seen_is_added_the_best_first() {
        let seen = vec![Finding::of(Kind::Stribeck), Finding::of(Kind::Stiction)];
        let ruling = Ruling { seen, ..Ruling::naming(&[Kind::Delay], [0.05, 9.0]) };
        let kinds = |own: &[Finding]| own.iter().map(|own| own.effect.kind).collect::<Vec<_>>();
        let fit = |ruling: &Ruling| match kinds(&ruling.findings)[1..] {
            [Kind::Stiction] => 0.1,
            [Kind::Stribeck] => 0.2,
            _ => 0.3,
        };
        let (own, error) = forward_selection(&ruling, fit, |_, own, best| (own < best).then_some(*own));
        assert_eq!(
            [kinds(&own.findings), kinds(&own.seen)],
            [[Kind::Delay, Kind::Stiction].to_vec(), vec![Kind::Stribeck]]
        );
        assert!((error - 0.1_f64).abs() < 1e-12);
    }
}
