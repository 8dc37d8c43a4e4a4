//! The judge's names as a model. The simulated motion gives the parameters that are printed, and the ladder. It adds no
//! name; it only takes back names that lower no simulation error.

mod forward_selection;
mod simulated;
#[cfg(test)]
mod tests;
mod verdict;

use super::assembled::assembled;
use super::candidate_rows;
use super::data::{FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::following::{contradicted, follows, follows_for_longer, open_loop, told};
use super::inertia;
use super::judge::finding::Finding;
use super::judge::ruling::Ruling;
use super::judge::settings::Settings;
use super::outcome::{Discovery, Force, NamedEffect, Rival, Rung};
use super::prepared::prepared;
use super::progress::{Progress, Watch};
use super::request::{DiscoverError, Request};
use super::ruled::radians;
use super::search::{Ended, parameters, rung};
use crate::fit::Fit;
use crate::recording::Units;
use forward_selection::forward_selection;
use simulated::simulated;
use verdict::{beside_doubt, verdict};

/// The discovery that the judge's ruling gives, and the ruling. The simulated motion decides on small effects. A small name
/// is only seen where the motion follows the open loop less well with it. What is seen is named where the motion follows it
/// better.
///
/// # Errors
/// [`DiscoverError`] where no base can be simulated at all.
pub(super) fn found(
    request: &Request,
    units: &Units,
    ruling: &Ruling,
    progress: Watch<'_>,
) -> Result<(Discovery, Ruling), DiscoverError> {
    let start = prepared(request, FIT_SEGMENT_S, Some(ruling), progress)
        .or_else(|_| prepared(request, SHORT_SEGMENT_S, Some(ruling), progress))?;
    let (data, base) = (&start.data, &start.base);
    progress(Progress::Step("fitting the simulated motion"));
    let rotary = radians(units).is_some();
    let simulated = |ruling: &Ruling| {
        if ruling.findings.is_empty() { (base.clone(), None) } else { simulated(data, base, ruling, rotary) }
    };
    // Where the model without the names in question is off by a tooth, the names are compared beside what repeats over position.
    // A base of another inertia follows by it what it misses, so it does not speak against what is missed.
    let withdrawn = |ruling: &Ruling, ladder: &[Rung], fit: &Fit| {
        let speaks = || !inertia::contradicted(ruling, &base.candidate) && !follows(data, base, fit);
        contradicted(ruling, ladder).filter(|_| speaks()).filter(|_| {
            let Some(repeating) = ruling.repeating() else { return true };
            let without = simulated(&repeating).0;
            !follows(data, &without, fit) && contradicted(ruling, &[rung(data, &without), rung(data, fit)]).is_some()
        })
    };
    let (ruling, (fit, of_forces)) = forward_selection(ruling, simulated, |own, (fit, _), (best, _)| {
        // What would be withdrawn must not take the names of the forces with it.
        let stays = || withdrawn(own, &[rung(data, base), rung(data, fit)], fit).is_none();
        let better = follows(data, best, fit) || follows_for_longer(data, best, fit) || told(data, best, fit);
        (better && stays()).then(|| open_loop(data, fit))
    });
    let mut remarks: Vec<String> = ruling.seen.iter().map(|own| seen(own, units)).collect();
    remarks.extend(ruling.of_recordings.map(|[own, all]| {
        format!("{own} of {all} recordings name it alone and together; the others hold too little of it")
    }));
    remarks.extend(of_forces);
    let errors = data.problem().covariance(&fit);
    let known = base.candidate.effects.len();
    let named = ruling.findings.iter().enumerate().map(|(j, finding)| {
        let mut parameters = parameters(&fit.candidate, known + j, Some(&errors), units);
        if fit.free.is_empty() {
            parameters.iter_mut().zip(finding.errors).for_each(|(parameter, error)| parameter.se = error);
        }
        NamedEffect { kind: finding.effect.kind, parameters, rivals: rivals(finding) }
    });
    let mut ladder = vec![rung(data, base)];
    if !ruling.findings.is_empty() {
        ladder.push(rung(data, &fit));
    }
    if let Some(reason) = withdrawn(&ruling, &ladder, &fit) {
        remarks.push(reason);
        let doubted = ruling.repeating().unwrap_or_else(|| ruling.naming_nothing());
        let (mut found, _) = self::found(request, units, &doubted, progress)?;
        found.remarks.extend(remarks);
        if ruling.explains_of_the_drive() > Settings::default().predictable {
            found.verdict = beside_doubt(&doubted);
        }
        return Ok((found, ruling));
    }
    let ended = Ended {
        verdict: verdict(&ruling),
        named: named.collect(),
        errors,
        fit,
        ladder,
        first_round: ruling.candidates.iter().map(|own| candidate_rows::row(own, &ruling)).collect(),
        closest: None,
        tie: None,
        remarks,
    };
    Ok((assembled(request, &start, units, ended, progress), ruling))
}

/// The remark on an effect that is seen, in a few windows or at rest.
fn seen(finding: &Finding, units: &Units) -> String {
    let name = finding.effect.kind.name();
    if let Some(share) = finding.small_share {
        let percent = 100.0 * share;
        return format!("{name} is seen too, with {percent:.0} % of the energy of the gap: too little to be named");
    }
    let (level, unit) = (finding.effect.p[0], &units.u);
    format!(
        "the axis stands under {level:.3} {unit} more than its Coulomb friction. The simulated motion follows no better \
         with {name}: not named"
    )
}

/// The measured forces of a ruling, as the report shows them.
pub(super) fn force(ruling: &Ruling) -> Force {
    Force {
        drive: ruling.residual_u,
        acceleration: ruling.residual_a,
        coherence: ruling.coherence,
        half_width_s: ruling.half_width_s,
        random: ruling.remainder.rms_u,
        random_share: ruling.remainder.share,
        bandwidth_hz: ruling.remainder.bandwidth_hz,
        predictable: (ruling.remainder.predictable.map(super::judge::term::Name::text))
            .or_else(|| ruling.repeats().then_some("the drive's period")),
    }
}

fn rivals(finding: &Finding) -> Vec<Rival> {
    let tied = finding.tied.iter();
    tied.map(|(kind, z)| Rival { kind: *kind, delta: 0.0, z: *z, tied: true }).collect()
}

/// A discovery of the simulated motion, with the judge's ties for each name that the judge gave too. Down to the sensor's
/// noise the motion tells what the forces do not. There it has only the ties with effects that it was not compared with.
pub(super) fn with_ties(mut small: Discovery, ruling: Option<&Ruling>) -> Discovery {
    let told = small.down_to_the_noise();
    let findings = ruling.map_or(&[][..], |ruling| &ruling.findings);
    for named in &mut small.effects {
        for tied in findings.iter().filter(|finding| finding.effect.kind == named.kind).flat_map(rivals) {
            if told && named.rivals.iter().any(|rival| rival.kind == tied.kind) {
                continue;
            }
            named.rivals.retain(|rival| rival.kind != tied.kind);
            named.rivals.push(tied);
        }
    }
    small
}
