//! The outcome of a round: a name, something that is no name, or nothing.

use breakaway_core::plant::Kind;

use super::evidence::Rejection;
use super::library::tells_apart;
use super::settings::Settings;
use super::term::Name;
use super::tried::Tried;

/// One round: what was tried, and its outcome.
#[derive(Clone, Debug)]
pub struct Round {
    /// The best of every name, in order of the smaller gain.
    pub tried: Vec<Tried>,
    /// What it came to.
    pub outcome: Outcome,
}

/// The outcome of a round.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Names, and the names that are tied with them.
    Named(Vec<Name>, Vec<Name>),
    /// This gains, and is a decoy or inconsistent.
    Unknown(Name),
    /// Nothing gains.
    Nothing,
}

/// Gain on side U above which a term predicts a part of what is left, nats.
const PREDICTS: f64 = 0.05;

/// Whether an effect or a decoy that does not hold gains more than every one that does.
pub(super) fn inconsistent_rival(tried: &[Tried], settings: &Settings) -> bool {
    let holds = tried.iter().filter(|t| t.rejection().is_none()).map(|t| t.gain).fold(0.0, f64::max);
    let possible = tried.iter().filter(|t| {
        !matches!(t.rejection(), None | Some(Rejection::Inertia | Rejection::Base | Rejection::Overdamped))
    });
    possible.map(|t| t.gain).any(|gain| gain * settings.rival > holds)
}

/// The outcome of a round beside a model that leaves the share `left` of the drive.
pub(super) fn decide(tried: &[Tried], left: f64, settings: &Settings) -> Outcome {
    let is_effect = |t: &&Tried| t.terms.iter().all(|t| matches!(t.name, Name::Effect(_)));
    let holding: Vec<&Tried> = tried.iter().filter(|t| t.rejection().is_none()).filter(is_effect).collect();
    let bar_z = |tried: &Tried| settings.least_z(tried.terms[0].chosen_of);
    // Share of the drive that a term predicts.
    let predicted = |gain: f64| left * (1.0 - (-2.0 * gain).exp()).sqrt();
    let strongest = |tried: &[Tried]| {
        // A wave of another amplitude in each recording is no wave, and predicts nothing of a further recording.
        let is_one = |t: &&Tried| !t.terms[0].own_zeros || t.rejection() != Some(Rejection::Amplitude);
        let alone = tried.iter().filter(|t| t.terms.len() == 1 && t.gain > 0.0).filter(is_one);
        let alone = alone.filter(|t| t.evidence[0].z() >= bar_z(t));
        let seen = alone.map(|t| (t, t.evidence[0].u.flat));
        let seen = seen.filter(|(_, gain)| *gain > PREDICTS && predicted(*gain) > settings.predictable);
        seen.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(t, _)| t.terms[0].name)
    };
    let Some(best) = holding.iter().max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
        return strongest(tried).map_or(Outcome::Nothing, Outcome::Unknown);
    };
    // A smaller term is preferred where it does as well, or costs at most 3 % of the gain.
    let nearly = |t: &Tried| t.gain > 0.97 * best.gain;
    let as_well = |t: &Tried| t.gain > settings.tie * best.gain && best.better_than(t) < settings.tie_z;
    let simple = holding.iter().filter(|t| nearly(t) || as_well(t)).min_by_key(|t| t.size()).unwrap_or(best);
    for other in tried.iter().filter(|t| t.terms.len() == 1) {
        let factor = match other.terms[0].name {
            Name::Decoy(_) => settings.decoy,
            Name::Effect(_) if other.rejection().is_some() => settings.rival,
            Name::Effect(_) => continue,
        };
        // A term that is inconsistent alone speaks for the pair in which it is named.
        let part = simple.terms.len() > 1 && simple.terms.iter().any(|t| t.name == other.terms[0].name);
        let possible = !matches!(other.rejection(), Some(Rejection::Inertia | Rejection::Base | Rejection::Overdamped));
        if possible && other.gain * factor > best.gain && other.evidence[0].z() >= bar_z(other) && !part {
            let material = predicted(other.gain) > settings.predictable;
            return if material { Outcome::Unknown(other.terms[0].name) } else { Outcome::Nothing };
        }
    }
    let mut names: Vec<Name> = Vec::new();
    // What gains much more than the smaller term is tied with it.
    let preferred_to = holding.iter().copied().filter(|t| !nearly(simple) && t.gain > simple.gain);
    let preferred_to = preferred_to.filter(|t| t.terms.len() == simple.terms.len());
    let as_well = tied(simple, tried, &[], settings).chain(preferred_to);
    for name in as_well.flat_map(Tried::names) {
        if !names.contains(&name) && !simple.names().contains(&name) {
            names.push(name);
        }
    }
    Outcome::Named(simple.names(), names)
}

/// The rivals of `own` that do as well on both sides. They may miss a bar. One with more parameters counts only where
/// the two effects resemble each other, or where it was tied `before`. A whole number of waves in a turn is no parameter. So
/// a ripple of one wave is as small as gravity, which has its law.
pub(super) fn tied<'a>(
    own: &'a Tried,
    tried: &'a [Tried],
    before: &'a [Kind],
    settings: &'a Settings,
) -> impl Iterator<Item = &'a Tried> {
    let resembles = |t: &Tried| {
        let mut pairs = own.names().into_iter().zip(t.names());
        pairs.all(|pair| match pair {
            (Name::Effect(one), Name::Effect(other)) => {
                one == other || one.resembles(other) || !tells_apart(one, other) || before.contains(&other)
            }
            _ => false,
        })
    };
    // A side that does not tell the effect does not tell it from a rival either.
    let of_u = own.evidence.iter().all(|evidence| evidence.is_of_side_u(settings));
    let gain = move |t: &Tried| if of_u { t.evidence.iter().map(|own| own.u.flat).sum() } else { t.gain };
    tried.iter().filter(move |t| {
        let effects = t.terms.iter().all(|t| matches!(t.name, Name::Effect(_)));
        let near = !matches!(
            t.rejection(),
            Some(Rejection::Inertia | Rejection::Base | Rejection::Amplitude | Rejection::Overdamped)
        );
        let as_well = gain(t) > settings.tie * gain(own) && own.better_than(t) < settings.tie_z;
        let as_small = t.size() - t.counted_waves <= own.size();
        effects && near && t.terms.len() == own.terms.len() && as_well && (as_small || resembles(t))
    })
}

#[cfg(test)]
mod tests {
    use super::super::evidence::Evidence;
    use super::super::gain::Gain;
    use super::super::ringing::{damped_gain, reject_overdamped};
    use super::super::term::Term;
    use super::*;

    /// An effect that holds, of so many parameters. It leaves these squares in the blocks of either side.
    fn holding(kind: Kind, size: usize, gain: f64, blocks: &[f64]) -> Tried {
        let terms = vec![Term { size, ..Term::force(Name::Effect(kind), Vec::new()) }];
        let own = Gain { flat: gain, local: gain, z: 7.0 };
        let evidence = vec![Evidence { u: own, a: own, disagreement: 0.0, coherence: 1.0, rejection: None }];
        Tried { terms, evidence, gain, blocks: [blocks.to_vec(), blocks.to_vec()], counted_waves: 0 }
    }

    /// A ripple with a phase for each recording gains 4 % more than a drift with three parameters (hidden plant, unkind
    /// world, seed 8007). Where the blocks do not tell them apart, the drift is named and the ripple is tied. Where every
    /// block speaks for the ripple, that is named alone.
    #[test]
    fn of_terms_that_do_as_well_the_smaller_is_named() {
        let ripple = holding(Kind::PositionFriction, 6, 0.144, &[1.0, 1.0, 1.0, 1.0]);
        let outcome = |blocks: &[f64]| {
            let drift = holding(Kind::FrictionDrift, 3, 0.139, blocks);
            decide(&[ripple.clone(), drift], 0.1, &Settings::default())
        };
        let [ripple_name, drift_name] = [Kind::PositionFriction, Kind::FrictionDrift].map(Name::Effect);
        assert_eq!(outcome(&[1.3, 0.8, 1.2, 0.8]), Outcome::Named(vec![drift_name], vec![ripple_name]));
        assert_eq!(outcome(&[1.1, 1.2, 1.1, 1.2]), Outcome::Named(vec![ripple_name], Vec::new()));
    }

    /// LuGre's friction has Dahl's as a special case, and does as well in these blocks. It is tied, because the forces do not
    /// tell the two apart. Cogging, which has a spring as its limit, is not.
    #[test]
    fn bristles_that_do_as_well_are_tied() {
        let outcome = |special: Kind, general: Kind| {
            let own = holding(special, 2, 0.1, &[1.0, 1.1, 1.0, 1.1]);
            decide(&[own, holding(general, 5, 0.101, &[1.1, 1.0, 1.1, 1.0])], 0.1, &Settings::default())
        };
        let named = |kind: Kind, tied: &[Kind]| {
            Outcome::Named(vec![Name::Effect(kind)], tied.iter().copied().map(Name::Effect).collect())
        };
        assert_eq!(outcome(Kind::Dahl, Kind::LuGre), named(Kind::Dahl, &[Kind::LuGre]));
        assert_eq!(outcome(Kind::Spring, Kind::Cogging), named(Kind::Spring, &[]));
    }

    /// A servo's spring and gravity, as side U tells them (XL330, one recording of 9 s). Side A has a z of 2.4, and gains
    /// half as much by gravity as by the spring. Where side A has the z of a name, it tells the two apart.
    #[test]
    fn a_side_that_does_not_tell_an_effect_does_not_tell_its_rival() {
        let settings = Settings::default();
        let of = |kind: Kind, [u, a]: [f64; 2], z: f64| {
            let mut own = holding(kind, 2, a, &[1.0, 1.1, 0.9, 1.0]);
            let side = |flat: f64, z: f64| Gain { flat, local: flat, z };
            (own.evidence[0].u, own.evidence[0].a) = (side(u, 5.1), side(a, z));
            own
        };
        let ties = |z: f64| {
            let gravity = [of(Kind::GravityLoad, [1.36, 0.15], 1.5)];
            tied(&of(Kind::Spring, [1.43, 0.34], z), &gravity, &[], &settings).count()
        };
        assert_eq!([ties(2.4), ties(4.1)], [1, 0]);
    }

    /// A second body that gains so much, under this name.
    fn body(name: Name, gain: f64, rejection: Option<Rejection>) -> Tried {
        let mut own = holding(Kind::FlexibleCoupling, 3, gain, &[1.0, 1.1, 0.9, 1.0]);
        (own.terms[0].name, own.terms[0].body, own.evidence[0].rejection) = (name, Some([281.0, 0.3]), rejection);
        own
    }

    /// The outcome of what was tried alone, beside a model that leaves the share `left` of the drive.
    fn round(mut tried: Vec<Tried>, left: f64) -> Outcome {
        let settings = Settings::default();
        let damped = damped_gain(&tried, &settings);
        reject_overdamped(&mut tried, damped, &settings);
        decide(&tried, left, &settings)
    }

    const COUPLING: Name = Name::Effect(Kind::FlexibleCoupling);
    const DAMPED: Name = Name::Decoy("damped mode");

    /// A coupling beside a mode with more damping, which gains more. That the mode leaves no positive friction does not make
    /// the coupling one (LAAS, at constant speed). A mode beside which the inertia is not positive says nothing.
    #[test]
    fn more_damping_speaks_against_a_coupling() {
        let outcome =
            |rejection: Rejection| round(vec![body(COUPLING, 0.096, None), body(DAMPED, 0.25, Some(rejection))], 0.2);
        assert_eq!(outcome(Rejection::Base), Outcome::Unknown(DAMPED));
        assert_eq!(outcome(Rejection::Inertia), Outcome::Named(vec![COUPLING], Vec::new()));
    }

    /// A coupling of flexlink's belt gains .70 nats, and a damped mode .05 at most. A friction that follows the drive at
    /// reversals gains .30 and .28: it does not ring, and is no coupling. What is left predicts less than 2 % of the drive.
    #[test]
    fn a_coupling_rings() {
        let outcome =
            |coupling: f64, damped: f64| round(vec![body(COUPLING, coupling, None), body(DAMPED, damped, None)], 0.02);
        assert_eq!(outcome(0.70, 0.05), Outcome::Named(vec![COUPLING], Vec::new()));
        assert_eq!(outcome(0.30, 0.28), Outcome::Nothing);
    }

    /// Where a coupling does not ring, the best of the other effects is named. It must gain more than the damped mode.
    #[test]
    fn a_coupling_that_does_not_ring_gives_way() {
        let outcome = |drag: f64| {
            let drag = holding(Kind::QuadraticDrag, 1, drag, &[1.0, 1.1, 0.9, 1.0]);
            round(vec![body(COUPLING, 0.30, None), drag, body(DAMPED, 0.20, None)], 0.2)
        };
        assert_eq!(outcome(0.25), Outcome::Named(vec![Name::Effect(Kind::QuadraticDrag)], Vec::new()));
        assert_eq!(outcome(0.15), Outcome::Unknown(DAMPED));
    }
}
