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
