//! Real machines that others recorded, with what is known of them: read, split, discovered, scored.
//!
//! [`catalogue`] lists the machines, [`splits`] says which of their recordings are fitted and which are held out, and
//! [`score`] judges the names against the truth. `cargo xtask machines` writes docs/machines.md from the rows. The
//! recordings are in the folder of [`measured_data`](crate::measured_data); the project holds none of them.

pub mod alteration;
#[cfg(test)]
mod ball_screw;
pub mod catalogue;
pub mod compare;
pub mod discovery;
pub mod drive_free;
pub mod export;
#[cfg(test)]
mod order_tracking;
pub mod page;
pub mod reading;
pub mod rows;
pub mod score;
pub mod splits;
pub mod truth;

use breakaway::recording::{ReadOptions, Selection, Units};

use splits::Split;
use truth::{Known, Truth};

/// A machine and its recordings.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    /// Short name, as `--machines` takes it.
    pub name: &'static str,
    /// What it is, and who recorded it.
    pub title: &'static str,
    /// Folder of its files under the measured data.
    pub folder: &'static str,
    /// How the names of its files begin.
    pub prefix: &'static str,
    /// Number of its files.
    pub files: usize,
    /// Where the signals are.
    pub columns: Columns,
    /// Groups of its files that are a split of their own.
    pub groups: &'static [Group],
    /// What a discovery has to say.
    pub truth: Truth<'static>,
    /// Parameters that are known, with their source.
    pub known: &'static [Known],
}

/// Columns of a machine's files.
#[derive(Clone, Copy, Debug)]
pub struct Columns {
    /// Time, s.
    pub time: &'static str,
    /// Applied drive; `None` where it was not logged.
    pub input: Option<&'static str>,
    /// Position.
    pub position: &'static str,
    /// Condition `column=value` on the rows.
    pub select: Option<&'static str>,
    /// Units of drive and position where the names of the columns do not say them.
    pub units: Option<[&'static str; 2]>,
}

/// Files whose name holds one of the given texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Name of the group.
    pub name: &'static str,
    /// The texts.
    pub holds: &'static [&'static str],
}

impl Columns {
    /// As options of the reader; `None` where no drive was logged.
    pub fn options(&self) -> Option<ReadOptions> {
        let select: Option<Selection> = self.select.and_then(|condition| condition.parse().ok());
        Some(ReadOptions {
            time: Some(self.time.to_owned()),
            input: Some(self.input?.to_owned()),
            position: Some(self.position.to_owned()),
            select: select.into_iter().collect(),
            ..ReadOptions::default()
        })
    }

    /// The units that the catalogue states.
    pub fn units(&self) -> Option<Units> {
        self.units.map(|[u, x]| Units { u: u.to_owned(), x: x.to_owned() })
    }
}

/// The machine of a name.
pub fn named(name: &str) -> Option<&'static Machine> {
    catalogue::MACHINES.into_iter().find(|machine| machine.name == name)
}

/// The quick subset: one split of six machines.
pub fn quick() -> Vec<(&'static Machine, Split)> {
    let xl330 = catalogue::XL330.groups.first().map_or(Split::All, |group| Split::Group(group.name));
    vec![
        (&catalogue::EMPS, Split::All),
        (&catalogue::FLEXLINK, Split::All),
        (&catalogue::AK80, Split::All),
        (&catalogue::FRC_LEFT, Split::All),
        (&catalogue::XL330, xl330),
        (&catalogue::LAAS_SINE, Split::All),
    ]
}
