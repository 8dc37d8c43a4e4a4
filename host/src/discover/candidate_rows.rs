//! The judge's first round as lines of the table of candidates.

use breakaway_core::plant::Kind;

use super::judge::evidence::Rejection;
use super::judge::ruling::{Candidacy, Ruling};
use super::outcome::{CandidateRow, NamedEffect};

/// Fate of an effect that the judge named and the simulated motion replaced.
const REPLACED: &str = "named by the measured forces; the simulated motion bears out another in its place";

/// The judge's first round as lines of the table. The fate of each line is its fate beside `named`.
pub(super) fn rows(ruling: &Ruling, named: &[NamedEffect]) -> Vec<CandidateRow> {
    let fate = |kind: Kind| {
        let tied = |own: &NamedEffect| own.rivals.iter().any(|rival| rival.tied && rival.kind == kind);
        if named.iter().any(|own| own.kind == kind) {
            Some("named".to_owned())
        } else if named.iter().any(tied) {
            Some("tied: these recordings cannot tell it from the named effect".to_owned())
        } else {
            None
        }
    };
    let rows = ruling.candidates.iter().map(|own| {
        let row = row(own, ruling);
        let judged = ruling.findings.iter().any(|finding| finding.effect.kind == own.kind);
        let other = || if judged { REPLACED.to_owned() } else { row.fate.clone() };
        CandidateRow { fate: fate(own.kind).unwrap_or_else(other), ..row }
    });
    rows.collect()
}

/// A line of the first round.
pub(super) fn row(own: &Candidacy, ruling: &Ruling) -> CandidateRow {
    let named = ruling.findings.iter().any(|finding| finding.effect.kind == own.kind);
    let tied = ruling.findings.iter().any(|finding| finding.tied.iter().any(|(kind, _)| *kind == own.kind));
    let fate = match own.rejection {
        _ if named => "named".to_owned(),
        _ if tied => "tied: these recordings cannot tell it from the named effect".to_owned(),
        None => "holds, and explains less than the named effect".to_owned(),
        Some(rejection) => rejected(rejection).to_owned(),
    };
    CandidateRow { kind: own.kind, delta: own.gain, z: own.z, lambda: f64::NAN, fate }
}

const fn rejected(rejection: Rejection) -> &'static str {
    match rejection {
        Rejection::Gain => "gains too little, or not in every part of the recordings",
        Rejection::Inertia => "the inertia is not positive with it",
        Rejection::Base => "the friction of the base is negative with it",
        Rejection::Coherence => "with it the drive determines a smaller share of the acceleration",
        Rejection::Disagreement(_) => "the drive and the acceleration give different forces for it",
        Rejection::Amplitude => "its amplitude has the wrong sign",
        Rejection::Floor => "a constant and the direction predict the drive as well",
        Rejection::Overdamped => "a body that does not ring explains half as much or more",
    }
}
