//! A log as its file has it: named channels, each in a group of rows with one clock.

use std::rc::Rc;

use super::Format;
use super::fault::Fault;
use crate::recording::limits::MAX_ROWS;

/// Most numbers and texts of a log that are kept: those of a recording of [`MAX_ROWS`] rows, in 1.2 GB.
pub const MAX_VALUES: usize = 3 * MAX_ROWS;
/// Most channels of a log: what spreadsheets can have.
pub const MAX_CHANNELS: usize = crate::recording::limits::MAX_COLUMNS;

/// The values of a channel, one per row of its group.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; NaN where a row has none.
    Numbers(Vec<f64>),
    /// Texts, such as the state of a routine; empty where a row has none.
    Texts(Vec<Rc<str>>),
}

impl Values {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Texts(texts) => texts.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers, if they are numbers.
    pub fn numbers(&self) -> Option<&[f64]> {
        match self {
            Self::Numbers(numbers) => Some(numbers),
            Self::Texts(_) => None,
        }
    }
}

/// One signal of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Its name in its group; empty where the group's name is its own.
    pub name: String,
    /// Its unit, where the file says it.
    pub unit: Option<String>,
    /// Its values.
    pub values: Values,
}

/// Channels that share their rows: a topic, an entry, or the arrays of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Its name; empty where its channels have names of their own.
    pub name: String,
    /// When each row was stamped, s; `None` where the format stamps no rows, and a channel may be the time.
    pub stamps_s: Option<Vec<f64>>,
    /// Its channels, all of one length.
    pub channels: Vec<Channel>,
}

impl Group {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.stamps_s.as_ref().map_or_else(|| self.channels.first().map_or(0, |c| c.values.len()), Vec::len)
    }

    /// A channel's full name.
    pub fn full_name(&self, channel: &Channel) -> String {
        match (self.name.is_empty(), channel.name.is_empty()) {
            (true, _) => channel.name.clone(),
            (_, true) => self.name.clone(),
            // An element of the group itself.
            _ if channel.name.starts_with('[') => format!("{}{}", self.name, channel.name),
            _ => format!("{}/{}", self.name, channel.name),
        }
    }
}

/// All channels of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// What the file is.
    pub format: Format,
    /// Its groups, none of them empty.
    pub groups: Vec<Group>,
    /// Byte at which a record begins that the file ends in, if it does.
    pub torn_at: Option<u64>,
    /// What was passed over, and why.
    pub passed_over: Vec<String>,
}

impl Log {
    /// A log of groups; those without rows or channels are left out.
    pub(super) fn new(format: Format, groups: Vec<Group>) -> Self {
        let groups = groups.into_iter().filter(|group| group.rows() > 0 && !group.channels.is_empty()).collect();
        Self { format, groups, torn_at: None, passed_over: Vec::new() }
    }

    /// A log of arrays that have no stamps: arrays of one length are one group.
    pub(super) fn of_arrays(format: Format, channels: Vec<Channel>) -> Result<Self, Fault> {
        if channels.len() > MAX_CHANNELS {
            return Err(Fault::TooLarge { what: "channels", most: MAX_CHANNELS });
        }
        let mut groups: Vec<Group> = Vec::new();
        for channel in channels.into_iter().filter(|channel| !channel.values.is_empty()) {
            match groups.iter_mut().find(|group| group.rows() == channel.values.len()) {
                Some(group) => group.channels.push(channel),
                None => groups.push(Group { channels: vec![channel], ..Group::default() }),
            }
        }
        // The longest first: a single number beside the signals is a setting.
        groups.sort_by_key(|group| std::cmp::Reverse(group.rows()));
        Ok(Self::new(format, groups))
    }

    /// The channels with their full names, in the order of the file.
    pub fn channels(&self) -> impl Iterator<Item = (String, &Group, &Channel)> {
        self.groups.iter().flat_map(|group| group.channels.iter().map(move |c| (group.full_name(c), group, c)))
    }

    /// Group and channel of a name: its full name; else the one channel whose full name ends in it, after a `/` or a `.`.
    pub fn find(&self, name: &str) -> Option<(&Group, &Channel)> {
        let exact = self.channels().find(|(full, ..)| full == name);
        let ends = |full: &str| full.strip_suffix(name).is_some_and(|before| before.ends_with(['/', '.']));
        let mut ending = self.channels().filter(|(full, ..)| ends(full));
        let only = || ending.next().filter(|_| ending.next().is_none());
        exact.or_else(only).map(|(_, group, channel)| (group, channel))
    }
}
