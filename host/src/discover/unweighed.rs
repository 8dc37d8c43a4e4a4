//! Effects that the measured forces do not tell from the judge's names, compared with them on the simulated motion.

use breakaway_core::plant::{Effect, Kind};

use super::by_force;
use super::data::{FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::judge::finding::Finding;
use super::judge::library::{tells_apart, weighs};
use super::judge::ruling::Ruling;
use super::model::Model;
use super::outcome::Discovery;
use super::prepared::{Prepared, prepared};
use super::progress::{Progress, Watch};
use super::request::Request;
use super::search::{Standing, confusable, stand_ins};
use crate::recording::Units;

/// Iterations of the model of the judge's names.
const ITERATIONS: usize = 20;

/// The discovery `found` of a ruling, after each name was compared with the effects from which the forces do not tell it.
/// The judge cannot weigh those, or it tied them with the name. Only effects that may be confused with the name count.
/// One that does as well is tied with the name. One that does better takes its place, and the name is tied. So does a
/// special case that does as well.
pub(super) fn compared(
    request: &Request,
    units: &Units,
    ruling: &Ruling,
    mut found: Discovery,
    progress: Watch<'_>,
) -> Discovery {
    // Names that the simulated motion contradicted are no longer in it.
    if found.effects.is_empty() || ruling.findings.iter().all(|finding| untold(finding).is_empty()) {
        return found;
    }
    let start = prepared(request, FIT_SEGMENT_S, Some(ruling), progress)
        .or_else(|_| prepared(request, SHORT_SEGMENT_S, Some(ruling), progress));
    let Ok(start) = start else { return found };
    progress(Progress::Step("comparing what the measured forces do not tell apart"));
    let named = |findings: &[Finding]| {
        let ruling = Ruling { findings: findings.to_vec(), ..ruling.clone() };
        by_force::found(request, units, &ruling, progress).ok().map(|(found, _)| found)
    };
    let mut findings = ruling.findings.clone();
    let mut tied = false;
    for j in 0..findings.len() {
        let own = findings[j].clone();
        let Some((effect, standing)) = stand_in(&start, &findings, j, &untold(&own)) else { continue };
        if standing == Standing::Better || own.effect.kind.generalises(effect.kind) {
            findings[j] = instead(&own, effect);
            let holds = |other: &Discovery| holds(standing, [found.over_noise(), other.over_noise()]);
            if let Some(other) = named(&findings).filter(holds) {
                (found, tied) = (other, false);
                continue;
            }
        }
        findings[j] = beside(&own, effect.kind);
        tied |= findings[j].tied.len() > own.tied.len();
    }
    if tied { named(&findings).unwrap_or(found) } else { found }
}

/// Whether an effect holds in the place of a name. What does better on the segments that were fitted must follow the held-out
/// ones no less well. The errors are those with the name and with the effect.
fn holds(standing: Standing, [name, effect]: [f64; 2]) -> bool {
    standing == Standing::AsGood || effect <= name
}

/// The effects that may be confused with a finding, and from which the measured forces do not tell it.
fn untold(finding: &Finding) -> Vec<Kind> {
    let own = finding.effect.kind;
    let tied = |kind: Kind| finding.tied.iter().any(|(tied, _)| *tied == kind);
    let mut kinds = confusable(own, false);
    kinds.retain(|kind| !weighs(*kind) || !tells_apart(own, *kind) || tied(*kind));
    kinds
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

    /// The forces weigh a dead time. Where they tie it with a dead zone, the motion is asked too (hidden plant, unkind world,
    /// seed 8953, 3 %). It is always asked for stiction, which has no column. A load is not confused with a dead zone.
    #[test]
    fn what_the_forces_tie_is_compared() {
        let mut zone = Finding::of(Kind::DeadZone);
        assert_eq!(untold(&zone), [Kind::Stiction]);
        zone.tied = vec![(Kind::PwmDeadTime, 0.5), (Kind::ConstantLoad, 0.5)];
        assert_eq!(untold(&zone), [Kind::PwmDeadTime, Kind::Stiction]);
    }

    /// A lag did better than a delay on the fitted segments. On the held-out ones it left 33 times the noise, and the delay
    /// 13 (hidden plant, unkind world, seed 8954, 10 %). A special case that does as well may leave a little more.
    #[test]
    fn what_takes_a_place_follows_the_held_out_motion() {
        assert!(!holds(Standing::Better, [13.0, 33.0]) && holds(Standing::Better, [17.7, 9.6]));
        assert!(holds(Standing::AsGood, [1.0, 1.01]));
    }
}
