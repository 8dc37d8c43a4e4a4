//! Messages put together to channels: each message is a row of its group, and names its values.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::Format;
use super::fault::Fault;
use super::log::{Channel, Group, Log, MAX_CHANNELS, MAX_VALUES, Values};

/// A value of a message.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Number(f64),
    Text(&'a str),
}

/// A group that grows.
#[derive(Debug, Default)]
struct Growing {
    group: Group,
    index: HashMap<String, usize>,
}

/// Groups that grow message by message.
#[derive(Debug, Default)]
pub(super) struct Gather {
    groups: Vec<Growing>,
    texts: HashSet<Rc<str>>,
    values: usize,
    channels: usize,
}

impl Gather {
    /// A new group; its number.
    pub(super) fn group(&mut self, name: &str) -> Result<usize, Fault> {
        if self.groups.len() >= MAX_CHANNELS {
            return Err(Fault::TooLarge { what: "groups of channels", most: MAX_CHANNELS });
        }
        let group = Group { name: name.to_owned(), stamps_s: Some(Vec::new()), channels: Vec::new() };
        self.groups.push(Growing { group, index: HashMap::new() });
        Ok(self.groups.len() - 1)
    }

    /// Begins a row of a group.
    pub(super) fn row(&mut self, group: usize, stamp_s: f64) -> Result<(), Fault> {
        self.count(1)?;
        if let Some(stamps) = self.groups.get_mut(group).and_then(|g| g.group.stamps_s.as_mut()) {
            stamps.push(stamp_s);
        }
        Ok(())
    }

    fn count(&mut self, values: usize) -> Result<(), Fault> {
        self.values += values;
        if self.values > MAX_VALUES { Err(Fault::TooLarge { what: "values", most: MAX_VALUES }) } else { Ok(()) }
    }

    /// Sets a value of the group's last row.
    pub(super) fn set(&mut self, group: usize, name: &str, value: &Value<'_>) -> Result<(), Fault> {
        let Some(growing) = self.groups.get_mut(group) else { return Ok(()) };
        let rows = growing.group.rows();
        if rows == 0 {
            return Ok(());
        }
        let at = if let Some(at) = growing.index.get(name) {
            *at
        } else {
            self.channels += 1;
            if self.channels > MAX_CHANNELS {
                return Err(Fault::TooLarge { what: "channels", most: MAX_CHANNELS });
            }
            let values = match value {
                Value::Number(_) => Values::Numbers(Vec::new()),
                Value::Text(_) => Values::Texts(Vec::new()),
            };
            growing.group.channels.push(Channel { name: name.to_owned(), unit: None, values });
            growing.index.insert(name.to_owned(), growing.group.channels.len() - 1);
            growing.group.channels.len() - 1
        };
        let channel = &mut growing.group.channels[at];
        let before = channel.values.len();
        match (&mut channel.values, value) {
            (Values::Numbers(numbers), Value::Number(number)) => {
                numbers.resize(rows - 1, f64::NAN);
                numbers.push(*number);
            }
            (Values::Texts(texts), Value::Text(text)) => {
                let known = self.texts.get(*text).cloned();
                let known = known.unwrap_or_else(|| {
                    let new: Rc<str> = Rc::from(*text);
                    self.texts.insert(Rc::clone(&new));
                    new
                });
                texts.resize(rows - 1, Rc::from(""));
                texts.push(known);
            }
            // A channel that changes its kind keeps the first one.
            _ => {}
        }
        let grown = channel.values.len().saturating_sub(before);
        self.count(grown)
    }

    /// The log; rows without a value of a channel have NaN or an empty text there.
    pub(super) fn log(self, format: Format) -> Result<Log, Fault> {
        let mut all = 0;
        let mut groups = Vec::new();
        for mut group in self.groups.into_iter().map(|growing| growing.group) {
            let rows = group.rows();
            all += rows * group.channels.len();
            if all > MAX_VALUES {
                return Err(Fault::TooLarge { what: "values", most: MAX_VALUES });
            }
            for channel in &mut group.channels {
                match &mut channel.values {
                    Values::Numbers(numbers) => numbers.resize(rows, f64::NAN),
                    Values::Texts(texts) => texts.resize(rows, Rc::from("")),
                }
            }
            groups.push(group);
        }
        Ok(Log::new(format, groups))
    }
}
