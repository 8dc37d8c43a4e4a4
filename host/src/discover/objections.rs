//! What the measured forces say against names of the simulated motion (docs/discovery.md, section 9).

use breakaway_core::plant::Kind;

use super::inertia;
use super::judge::library::tells;
use super::judge::ruling::{Candidacy, Ruling};
use super::judge::settings::Settings;
use super::judge::term::Name;
use super::outcome::Discovery;

/// z over blocks below which the measured forces speak against a name.
const AGAINST: f64 = -2.0;
/// Force that is left, over what the sensor's noise makes of it, above which the measured forces may speak.
const FORCE: f64 = 5.0;

/// Whether the measured forces object to the names of the simulated motion: they speak against each name, they contradict
/// the inertia, or they tell no inertia and did not give the names.
///
/// Where the drive determines little of the acceleration, the simulated motion tells no inertia either. A model with
/// enough inertia follows any even motion. On real machines the motion gave four such names, none of them true.
pub(super) fn any(ruling: &Ruling, small: &Discovery) -> bool {
    let names: Vec<Kind> = small.effects.iter().map(|named| named.kind).collect();
    let told = |kind: Kind| tells(kind) || kind.bristles() && tells_bristle(ruling, small, kind);
    names.iter().all(|kind| told(*kind) && is_doubtful(ruling, *kind))
        || inertia::contradicted(ruling, &small.model)
        || !ruling.tells_inertia() && !given(ruling, &names)
}

/// Whether a bristle of the model is bent by more than the sensor's noise, so that the forces tell it.
fn tells_bristle(ruling: &Ruling, small: &Discovery, kind: Kind) -> bool {
    let f1 = small.model.base.f1;
    let mut own = small.model.effects.iter().filter(|effect| effect.kind == kind);
    own.all(|effect| f1 / effect.p[0] >= ruling.least_stroke)
}

/// Whether the measured forces gave each of the `names`: they named it, or it predicts best what they leave.
pub(super) fn given(ruling: &Ruling, names: &[Kind]) -> bool {
    let of_forces = |kind: &Kind| {
        ruling.findings.iter().any(|finding| finding.effect.kind == *kind)
            || ruling.remainder.predictable == Some(Name::Effect(*kind))
    };
    names.iter().all(of_forces)
}

/// Whether the measured forces speak against an effect, whatever its parameters. They say nothing against one that they do
/// not tell.
pub(super) fn speak_against(ruling: &Ruling, kind: Kind) -> bool {
    tells(kind) && is_doubtful(ruling, kind)
}

/// Whether the measured forces show another thing than an effect that they weighed. They do so only where they named nothing
/// themselves, and where more is left of them than the sensor makes. Two things speak against an effect. Its z is far
/// below zero on one side at least; or what they see and do not name gains much more.
fn is_doubtful(ruling: &Ruling, kind: Kind) -> bool {
    let outdone = Settings::default().decoy * ruling.unnamed_gain;
    let doubtful = |own: &Candidacy| own.z < AGAINST || own.gain < outdone;
    ruling.findings.is_empty()
        && ruling.remainder.over_noise > FORCE
        && ruling.candidates.iter().any(|own| own.kind == kind && doubtful(own))
}
