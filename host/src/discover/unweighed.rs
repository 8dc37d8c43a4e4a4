//! Effects that no force in a window tells, compared on the simulated motion with the judge's names.

use breakaway_core::plant::{Effect, Kind};

use super::by_force;
use super::data::{FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::engine::{Prepared, Request, prepared};
use super::judge::finding::Finding;
use super::judge::library::{tells_apart, weighs};
use super::judge::ruling::Ruling;
use super::model::Model;
use super::outcome::Discovery;
use super::progress::{Progress, Watch};
use super::search::{Standing, confusable, stand_ins};
use crate::recording::Units;

/// Iterations of the model of the judge's names.
const ITERATIONS: usize = 20;

/// The discovery `found` of a ruling, after each name was compared with the effects that the judge cannot weigh. Only
/// effects that may be confused with the name count. One that does as well is tied with the name. One that does better
/// takes its place, and the name is tied. So does a special case that does as well.
pub(super) fn compared(
    request: &Request,
    units: &Units,
    ruling: &Ruling,
    found: Discovery,
    progress: Watch<'_>,
) -> Discovery {
    let unweighed = |finding: &Finding| {
        let mut kinds = confusable(finding.effect.kind, false);
        kinds.retain(|kind| !weighs(*kind) || !tells_apart(finding.effect.kind, *kind));
        kinds
    };
    // Names that the simulated motion contradicted are no longer in it.
    if found.effects.is_empty() || ruling.findings.iter().all(|finding| unweighed(finding).is_empty()) {
        return found;
    }
    let start = prepared(request, FIT_SEGMENT_S, Some(ruling), progress)
        .or_else(|_| prepared(request, SHORT_SEGMENT_S, Some(ruling), progress));
    let Ok(start) = start else { return found };
    progress(Progress::Step("comparing what the measured forces do not tell apart"));
    let mut findings = ruling.findings.clone();
    let mut changed = false;
    for j in 0..findings.len() {
        let kinds = unweighed(&findings[j]);
        if let Some((effect, standing)) = stand_in(&start, &findings, j, &kinds) {
            changed = true;
            findings[j] = match standing {
                Standing::Better => instead(&findings[j], effect),
                Standing::AsGood if findings[j].effect.kind.generalises(effect.kind) => instead(&findings[j], effect),
                Standing::AsGood => beside(&findings[j], effect.kind),
            };
        }
    }
    if !changed {
        return found;
    }
    by_force::found(request, units, &Ruling { findings, ..ruling.clone() }, progress).map_or(found, |(found, _)| found)
}

/// The effect of `kinds` with the lowest cost in the place of finding `j`; `None` where none does as well.
fn stand_in(start: &Prepared, findings: &[Finding], j: usize, kinds: &[Kind]) -> Option<(Effect<f64>, Standing)> {
    if kinds.is_empty() {
        return None;
    }
    let known = start.base.candidate.effects.len();
    let model = findings.iter().fold(Model::of(&start.base), |model, finding| model.with(finding.effect));
    let fit = model.fit(&start.data.problem(), None, ITERATIONS).ok()?;
    stand_ins(&start.data, &fit, known + j, kinds).into_iter().next()
}

/// The finding with another effect in its place. The old effect is tied.
fn instead(finding: &Finding, effect: Effect<f64>) -> Finding {
    let mut tied = vec![(finding.effect.kind, 0.0)];
    tied.extend(finding.tied.iter().filter(|(kind, _)| *kind != effect.kind));
    Finding { effect, errors: [f64::NAN; _], held: Vec::new(), tied, ..finding.clone() }
}

/// The finding with an effect tied, if the forces did not tie it.
fn beside(finding: &Finding, kind: Kind) -> Finding {
    let mut finding = finding.clone();
    if !finding.tied.iter().any(|(tied, _)| *tied == kind) {
        finding.tied.push((kind, 0.0));
    }
    finding
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The forces tie LuGre's friction with Dahl's, and the motion may tie it again (hidden plant, unkind world, seed 8809).
    #[test]
    fn what_is_tied_twice_is_listed_once() {
        let once = beside(&Finding::of(Kind::Dahl), Kind::LuGre);
        let twice = beside(&once, Kind::LuGre);
        assert_eq!(twice.tied.iter().map(|(kind, _)| *kind).collect::<Vec<_>>(), [Kind::LuGre]);
    }
}
