//! The verdict on the names of the forces.

use super::super::judge::ruling::Ruling;
use super::super::outcome::Verdict;

/// The verdict: by whether something was named, whether the force that is left can be predicted, and whether it is little.
/// An effect that is seen predicts a part of it.
pub(super) fn verdict(ruling: &Ruling) -> Verdict {
    let predictable = ruling.leaves_something_predictable() || !ruling.seen.is_empty();
    match (ruling.findings.is_empty(), predictable) {
        (false, false) if ruling.leaves_little() => Verdict::Explained,
        (false, _) => Verdict::PartlyExplained,
        (true, false) if ruling.tells_nothing_is_missing() => Verdict::NothingMissing,
        (true, _) => Verdict::Unknown,
    }
}

/// The verdict where the simulated motion contradicts names that explain what counts of the drive. Names that stay explain a
/// part of it.
pub(super) fn beside_doubt(stays: &Ruling) -> Verdict {
    if stays.findings.is_empty() { Verdict::Unknown } else { Verdict::PartlyExplained }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::super::judge::finding::Finding;
    use super::*;

    /// A tenth of the drive, or twice the sensor's noise, may be left at random where all is explained. Where only some
    /// recordings give the name, nothing is said of the others.
    #[test]
    fn much_that_is_left_is_not_explained() {
        let of = |left: [f64; 2]| verdict(&Ruling::naming(&[Kind::Cogging], left));
        assert_eq!([of([0.09, 50.0]), of([0.3, 1.9])], [Verdict::Explained; 2]);
        assert_eq!(of([0.11, 50.0]), Verdict::PartlyExplained);
        let some = Ruling { of_recordings: Some([2, 5]), ..Ruling::naming(&[Kind::Cogging], [0.01, 50.0]) };
        assert_eq!(verdict(&some), Verdict::PartlyExplained);
    }

    /// A ripple stays where the motion contradicts the delay beside it. What the delay explained is then missing.
    #[test]
    fn doubt_leaves_nothing_explained() {
        let ruling = Ruling::naming(&[Kind::Cogging, Kind::Delay], [0.01, 50.0]);
        let verdicts = [ruling.repeating().unwrap(), ruling.naming_nothing()].map(|stays| beside_doubt(&stays));
        assert_eq!(verdicts, [Verdict::PartlyExplained, Verdict::Unknown]);
    }

    /// An effect that is seen beside the names is predictable, however little it predicts.
    #[test]
    fn what_is_seen_is_not_explained() {
        let seen = Ruling { seen: vec![Finding::of(Kind::Spring)], ..Ruling::naming(&[Kind::Cogging], [0.01, 50.0]) };
        assert_eq!(verdict(&seen), Verdict::PartlyExplained);
    }
}
