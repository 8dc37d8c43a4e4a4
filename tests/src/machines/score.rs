//! The rule by which names are judged.

use breakaway_core::plant::Kind;

use super::truth::Truth;

/// A name, and the names that these recordings cannot tell from it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// The effect.
    pub kind: Kind,
    /// Effects that are tied with it.
    pub tied: Vec<Kind>,
}

impl Named {
    fn any(&self, test: impl Fn(Kind) -> bool) -> bool {
        test(self.kind) || self.tied.iter().copied().any(test)
    }
}

/// What became of a split.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Score {
    /// The leading name is right, or tied with what is, and nothing else is wrong. Where nothing is missing: nothing is
    /// named. Where what is missing is outside the catalogue: the verdict is *unknown* or *partly explained*.
    Right,
    /// A name, with all that is tied with it, is not true of the machine. What is outside the catalogue is *explained*.
    Wrong,
    /// Refused, unknown, or true names without the one that is needed.
    Abstains,
    /// *Nothing missing* is the verdict, although something is.
    FalseNothing,
    /// The machine logs no drive.
    NotAsked,
}

impl Score {
    /// In words, for the page.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Wrong => "**wrong**",
            Self::Abstains => "abstains",
            Self::FalseNothing => "false nothing",
            Self::NotAsked => "–",
        }
    }
}

/// Verdict of a discovery that was not made: the reader or the tool refused the recordings.
pub const REFUSED: &str = "refused";
/// Verdict of a discovery that ended in a panic.
pub const PANICKED: &str = "panicked";
/// Verdict of a machine that logs no drive.
pub const NO_DRIVE: &str = "no_drive";
/// Verdict of a discovery that finds nothing missing.
const NOTHING_MISSING: &str = "nothing_missing";
/// Verdict of a discovery whose names explain all.
const EXPLAINED: &str = "explained";

/// Judges a verdict and its names.
pub fn score(truth: &Truth<'_>, verdict: &str, named: &[Named]) -> Score {
    if *truth == Truth::NoDrive {
        return Score::NotAsked;
    }
    if named.iter().any(|name| !name.any(|kind| truth.allows(kind))) {
        return Score::Wrong;
    }
    match truth {
        _ if [REFUSED, PANICKED].contains(&verdict) => Score::Abstains,
        Truth::Nothing | Truth::NoDrive => Score::Right,
        _ if named.is_empty() && verdict == NOTHING_MISSING => Score::FalseNothing,
        Truth::Outside { .. } if verdict == EXPLAINED => Score::Wrong,
        Truth::Outside { .. } => Score::Right,
        Truth::Effects { lead, needed, .. } => {
            let leads = named.first().is_some_and(|name| name.any(|kind| lead.contains(&kind)));
            let holds = named.iter().any(|name| name.any(|kind| needed.contains(&kind)));
            if leads && holds { Score::Right } else { Score::Abstains }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::catalogue::{EMPS, FRC_LEFT, SO101, XL330};
    use super::*;

    fn name(kind: Kind, tied: &[Kind]) -> Named {
        Named { kind, tied: tied.to_vec() }
    }

    /// The rule, case by case.
    #[test]
    fn names_are_judged_with_what_is_tied() {
        use Kind::{AsymmetricViscous, ConstantLoad, Dahl, GravityLoad, LoadFriction, Spring};
        let emps = |verdict: &str, named: &[Named]| score(&EMPS.truth, verdict, named);
        let asymmetric = name(AsymmetricViscous, &[]);
        let load = name(ConstantLoad, &[]);
        assert_eq!(emps("partly_explained", std::slice::from_ref(&asymmetric)), Score::Right);
        assert_eq!(emps("explained", &[load.clone(), asymmetric.clone()]), Score::Right);
        assert_eq!(emps("partly_explained", &[load]), Score::Abstains);
        assert_eq!(emps("explained", &[asymmetric, name(Dahl, &[])]), Score::Wrong);
        assert_eq!(emps("unknown", &[]), Score::Abstains);
        assert_eq!(emps(REFUSED, &[]), Score::Abstains);
        assert_eq!(emps("nothing_missing", &[]), Score::FalseNothing);
        let xl330 = |named: &[Named]| score(&XL330.truth, "partly_explained", named);
        assert_eq!(xl330(&[name(Spring, &[GravityLoad])]), Score::Right);
        assert_eq!(xl330(&[name(Spring, &[])]), Score::Wrong);
        assert_eq!(xl330(&[name(LoadFriction, &[])]), Score::Abstains);
        let frc = |verdict: &str, named: &[Named]| score(&FRC_LEFT.truth, verdict, named);
        assert_eq!(frc("unknown", &[]), Score::Right);
        assert_eq!(frc(REFUSED, &[]), Score::Abstains);
        assert_eq!(frc("explained", &[name(Dahl, &[])]), Score::Wrong);
        let outside = |verdict: &str, named: &[Named]| score(&Truth::Outside { also: &[GravityLoad] }, verdict, named);
        let gravity = name(GravityLoad, &[]);
        assert_eq!(outside("unknown", &[]), Score::Right);
        assert_eq!(outside("partly_explained", std::slice::from_ref(&gravity)), Score::Right);
        assert_eq!(outside("explained", &[gravity]), Score::Wrong);
        assert_eq!(outside("partly_explained", &[name(Dahl, &[])]), Score::Wrong);
        assert_eq!(outside("nothing_missing", &[]), Score::FalseNothing);
        assert_eq!(outside(REFUSED, &[]), Score::Abstains);
        assert_eq!(score(&SO101.truth, NO_DRIVE, &[]), Score::NotAsked);
    }
}
