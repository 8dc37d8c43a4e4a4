//! What the measured forces say against names of the simulated motion (docs/discovery.md, section 9).

use breakaway_core::plant::Kind;

use super::inertia;
use super::judge::library::tells;
use super::judge::ruling::{Candidacy, Ruling};
use super::judge::settings::Settings;
use super::judge::term::Name;
use crate::fit::Candidate;

/// z over blocks below which the measured forces speak against a name.
const AGAINST: f64 = -2.0;
/// Force that is left, over what the sensor's noise makes of it, above which the measured forces may speak.
const FORCE: f64 = 5.0;

/// Whether the measured forces object to `names` of the simulated motion. They tell no inertia and did not give a name; or
/// they contradict the inertia of its `model`; or they speak against each name.
pub(super) fn any(ruling: &Ruling, names: &[Kind], model: &Candidate) -> bool {
    let told = |kind: Kind| tells(kind) || kind.bristles() && tells_bristle(ruling, model, kind);
    names.iter().all(|kind| told(*kind) && is_doubtful(ruling, *kind))
        || inertia::contradicted(ruling, model)
        || names.iter().any(|kind| lacks_inertia(ruling, *kind))
}

/// Whether the measured forces object to an effect whatever its parameters. It need not be sought then.
pub(super) fn to_kind(ruling: &Ruling, kind: Kind) -> bool {
    lacks_inertia(ruling, kind) || tells(kind) && is_doubtful(ruling, kind)
}

/// Whether the measured forces tell no inertia, leave little that an effect could be, and did not give this one. The
/// simulated motion tells no inertia there either, and a heavy axis follows any even motion. On real machines the motion gave
/// four such names, and none of them was true (docs/discovery.md, section 9). Where much is left, an effect may be what
/// hides the inertia.
fn lacks_inertia(ruling: &Ruling, kind: Kind) -> bool {
    !ruling.tells_inertia() && ruling.leaves_little() && !gave(ruling, kind)
}

/// Whether a bristle of the model bends by more than the sensor's noise, so that the measured motion tells its force.
fn tells_bristle(ruling: &Ruling, model: &Candidate, kind: Kind) -> bool {
    let mut own = model.effects.iter().filter(|effect| effect.kind == kind);
    own.all(|effect| model.base.f1 / effect.p[0] >= ruling.least_stroke)
}

/// Whether the measured forces gave an effect: they named it, or it predicts best what they leave.
pub(super) fn gave(ruling: &Ruling, kind: Kind) -> bool {
    ruling.findings.iter().any(|finding| finding.effect.kind == kind)
        || ruling.remainder.predictable == Some(Name::Effect(kind))
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

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Base, Effect};

    use super::*;

    fn model(effects: &[Effect<f64>]) -> Candidate {
        Candidate { base: Base { b: 1.0, c: 1.0, f1: 0.4 }, effects: effects.to_vec() }
    }

    /// A motor at an even speed in wide windows (LAAS, one row of four). The motion gave it a backlash and 1700 times its
    /// inertia. Bristles that the forces name need no inertia (CICESE).
    #[test]
    fn a_name_of_the_motion_needs_an_inertia() {
        let with = |coherence: f64, named: &[Kind]| Ruling { coherence, ..Ruling::naming(named, [0.03, 400.0]) };
        let objects = |ruling: &Ruling, kind: Kind| any(ruling, &[kind], &model(&[])) && to_kind(ruling, kind);
        assert!(objects(&with(0.29, &[]), Kind::Backlash) && !objects(&with(0.31, &[]), Kind::Backlash));
        assert!(
            !objects(&with(0.05, &[Kind::Dahl]), Kind::Dahl) && objects(&with(0.05, &[Kind::Dahl]), Kind::Stiction)
        );
        let predictable = |mut ruling: Ruling| {
            ruling.remainder.predictable = Some(Name::Effect(Kind::Spring));
            ruling
        };
        assert!(!objects(&predictable(with(0.05, &[])), Kind::Spring));
        // Teeth move an axis more than a slow sine of the drive does (hidden plant, kind world, seed 909).
        let teeth = Ruling { coherence: 0.1, ..Ruling::naming(&[], [0.26, 670.0]) };
        assert!(!objects(&teeth, Kind::Cogging));
    }

    /// An eccentric encoder predicts best what the forces leave, with .028 nats. A bristle gains .005 (ODrive, five rows
    /// held). It bends by .1 rad, and the sensor's noise is .0004 rad. A bristle of a stiffness of 1000 bends by less.
    #[test]
    fn the_forces_speak_against_bristles_that_they_tell() {
        let bristle = Candidacy { kind: Kind::LuGre, gain: 0.005, z: 4.0, rejection: None };
        let ruling = |unnamed_gain: f64| Ruling {
            unnamed_gain,
            least_stroke: 0.0024,
            candidates: vec![bristle],
            ..Ruling::naming(&[], [0.06, 70.0])
        };
        let objects = |unnamed_gain: f64, stiffness: f64| {
            let lugre = Effect::new(Kind::LuGre, &[stiffness, 0.0, 0.1, 1.0]);
            any(&ruling(unnamed_gain), &[Kind::LuGre], &model(&[lugre]))
        };
        assert_eq!([objects(0.028, 4.0), objects(0.028, 1000.0), objects(0.006, 4.0)], [true, false, false]);
        assert!(!to_kind(&ruling(0.028), Kind::LuGre));
    }
}
