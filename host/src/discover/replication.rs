//! Names that several recordings give alone. Recordings that excite nothing of an effect may hide it from a ruling on all
//! of them together. Ramps tell nothing of bristles, and a hundred of them outvote three slow sines.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::judge::ruling::Ruling;
use crate::recording::Recording;

/// Fewest recordings that must give a name alone.
const LEAST: usize = 2;

/// The ruling on the recordings that name the same effect alone. At least two recordings must name it first, and no other
/// may name another effect. They must also name it together, with one set of parameters. `rule` rules on recordings.
pub(super) fn replicated(
    recordings: &[Recording],
    rule: impl Fn(&[Recording]) -> Option<Ruling> + Sync,
) -> Option<Ruling> {
    if recordings.len() <= LEAST {
        return None;
    }
    let first = |ruling: &Ruling| ruling.findings.first().map(|finding| finding.effect.kind);
    let alone = |recording: &Recording| rule(std::slice::from_ref(recording)).as_ref().and_then(first);
    let names: Vec<Option<Kind>> = recordings.par_iter().map(alone).collect();
    let name = names.iter().copied().flatten().next()?;
    let agree = names.iter().flatten().all(|own| *own == name);
    let own: Vec<Recording> =
        recordings.iter().zip(&names).filter(|(_, named)| named.is_some()).map(|(own, _)| own.clone()).collect();
    if !agree || own.len() < LEAST {
        return None;
    }
    let together = rule(&own).filter(|ruling| first(ruling) == Some(name))?;
    Some(Ruling { of_recordings: Some([own.len(), recordings.len()]), ..together })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is named alone, by the recordings' names, and what those that name something name together.
    fn ruling(recordings: &[Recording], alone: &[Option<Kind>], together: Option<Kind>) -> Ruling {
        let name = match recordings {
            [one] => alone[one.name.parse::<usize>().unwrap()],
            _ => together,
        };
        Ruling::naming(name.as_slice(), [0.05, 9.0])
    }

    fn of(alone: &[Option<Kind>], together: Option<Kind>) -> Option<[usize; 2]> {
        let recordings: Vec<Recording> =
            (0..alone.len()).map(|i| Recording { name: i.to_string(), ..Recording::default() }).collect();
        replicated(&recordings, |own| Some(ruling(own, alone, together)))?.of_recordings
    }

    #[test]
    fn two_recordings_that_agree_alone_and_together_give_a_name() {
        let (dahl, spring) = (Some(Kind::Dahl), Some(Kind::Spring));
        assert_eq!(of(&[None, dahl, None, dahl], dahl), Some([2, 4]));
        assert_eq!(of(&[None, dahl, None, None], dahl), None, "one recording");
        assert_eq!(of(&[spring, dahl, None, dahl], dahl), None, "another name");
        assert_eq!(of(&[None, dahl, None, dahl], None), None, "not together");
        assert_eq!(of(&[dahl, dahl], dahl), None, "these are all recordings, which were asked together before");
    }
}
