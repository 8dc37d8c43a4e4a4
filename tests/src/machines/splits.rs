//! Which of a machine's recordings are fitted, and which are held out.

use std::fmt;

use breakaway::recording::Recording;

use super::Machine;
use super::alteration::{ALTERATIONS, Alteration, FRESH, FURTHER};
use super::reading::Source;

/// Most files that are left out one by one. More files are left out in groups.
const MOST_ALONE: usize = 8;
/// Groups that are left out one at a time. Odd, so that files that alternate in direction share a group.
const GROUPS: usize = 5;

/// A split of a machine's recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// All recordings; the tool holds out the last third of each.
    All,
    /// All recordings of a named group; the tool holds out as above.
    Group(&'static str),
    /// The files `k` with `k % of == fold` are held out, the others are fitted.
    Without {
        /// From 0.
        fold: usize,
        /// Number of folds.
        of: usize,
    },
    /// One of `of` parts alone. The parts are of the files in their order, or of the time of each where there are
    /// fewer files than parts. The tool holds out as above.
    Part {
        /// From 0.
        part: usize,
        /// Number of parts: 2 or 3.
        of: usize,
    },
    /// One file alone.
    Alone(usize),
    /// All recordings, made worse.
    Altered(Alteration),
}

impl fmt::Display for Split {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => write!(out, "all"),
            Self::Group(name) => write!(out, "group {name}"),
            Self::Without { fold, of } => write!(out, "without {} of {of}", fold + 1),
            Self::Part { part, of: 2 } => write!(out, "half {}", part + 1),
            Self::Part { part, of: 3 } => write!(out, "third {}", part + 1),
            Self::Part { part, of } => write!(out, "part {} of {of}", part + 1),
            Self::Alone(file) => write!(out, "file {} alone", file + 1),
            Self::Altered(alteration) => alteration.fmt(out),
        }
    }
}

impl Split {
    /// Kind of split, as `--splits` takes it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Group(_) => "groups",
            Self::Without { .. } => "without",
            Self::Part { of: 2, .. } => "halves",
            Self::Part { .. } => "thirds",
            Self::Alone(_) => "alone",
            Self::Altered(alteration) if FURTHER.contains(alteration) => "further",
            Self::Altered(alteration) if FRESH.contains(alteration) => "fresh",
            Self::Altered(_) => "altered",
        }
    }
}

/// Every split of a machine but those of [`harder`].
pub fn splits(machine: &Machine) -> Vec<Split> {
    let mut splits = vec![Split::All];
    splits.extend(machine.groups.iter().map(|group| Split::Group(group.name)));
    let folds = match machine.files {
        1 => 0,
        files if files <= MOST_ALONE => files,
        _ => GROUPS,
    };
    splits.extend((0..folds).map(|fold| Split::Without { fold, of: folds }));
    splits.extend((0..2).map(|part| Split::Part { part, of: 2 }));
    splits.extend((0..3).map(|part| Split::Part { part, of: 3 }));
    splits
}

/// Splits with sums of their own in docs/machines.md: up to eight of several files alone, and the alterations.
pub fn harder(machine: &Machine) -> Vec<Split> {
    let every = machine.files.div_ceil(MOST_ALONE);
    let alone = (0..machine.files).step_by(every).filter(|_| machine.files > 1).map(Split::Alone);
    alone.chain(ALTERATIONS.into_iter().chain(FURTHER).chain(FRESH).map(Split::Altered)).collect()
}

/// Recordings of a split.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    /// To fit, and to hold out from where `holdout` is empty.
    pub fit: Vec<Recording>,
    /// Held out.
    pub holdout: Vec<Recording>,
}

impl Taken {
    /// Whether recordings of a file are taken; of a file that was refused altogether, it is not known, and it is yes.
    pub fn concerns(&self, source: &Source) -> bool {
        let stem = source.file.trim_end_matches(".csv");
        let mut all = self.fit.iter().chain(&self.holdout);
        source.recording.is_none() || all.any(|recording| recording.name.starts_with(stem))
    }
}

/// The recordings that a split takes of a machine's files.
pub fn taken(machine: &Machine, split: Split, sources: &[Source]) -> Taken {
    let all = |sources: &[&Source]| sources.iter().flat_map(|source| source.recording.iter().cloned()).collect();
    let chosen = |of: &dyn Fn(usize, &Source) -> bool| {
        let chosen = sources.iter().enumerate().filter(|(k, source)| of(*k, source));
        all(&chosen.map(|(_, source)| source).collect::<Vec<_>>())
    };
    let fit = |fit| Taken { fit, holdout: Vec::new() };
    match split {
        Split::All => fit(chosen(&|_, _| true)),
        Split::Group(name) => {
            let holds = machine.groups.iter().find(|group| group.name == name).map_or(&[][..], |group| group.holds);
            fit(chosen(&|_, source| holds.iter().any(|text| source.file.contains(text))))
        }
        Split::Alone(file) => fit(chosen(&|k, _| k == file)),
        Split::Altered(alteration) => {
            fit(chosen(&|_, _| true).iter().map(|recording| alteration.of(recording)).collect())
        }
        Split::Without { fold, of } => {
            Taken { fit: chosen(&|k, _| k % of != fold), holdout: chosen(&|k, _| k % of == fold) }
        }
        Split::Part { part, of } if sources.len() >= of => {
            let bounds = [part, part + 1].map(|edge| edge * sources.len() / of);
            fit(chosen(&|k, _| (bounds[0]..bounds[1]).contains(&k)))
        }
        Split::Part { part, of } => {
            let whole: Vec<Recording> = chosen(&|_, _| true);
            fit(whole.iter().map(|recording| part_of(recording, part, of)).collect())
        }
    }
}

/// The rows `part / of` to `(part + 1) / of` of a recording.
fn part_of(recording: &Recording, part: usize, of: usize) -> Recording {
    let [start, end] = [part, part + 1].map(|edge| edge * recording.t.len() / of);
    let cut = |signal: &[f64]| signal.get(start..end).unwrap_or_default().to_vec();
    let gaps = recording.gaps.iter().filter(|&&gap| gap > start && gap < end);
    Recording {
        name: format!("{} part {} of {of}", recording.name, part + 1),
        t: cut(&recording.t),
        u: cut(&recording.u),
        x: cut(&recording.x),
        gaps: gaps.map(|gap| gap - start).collect(),
        ..recording.clone()
    }
}

#[cfg(test)]
#[path = "splits_tests.rs"]
mod tests;
