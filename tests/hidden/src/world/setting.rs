//! The names of the unkind items, and the choice of them.

use super::World;
use std::fmt;

/// One thing that makes the world unkind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    /// Random torque.
    Torque,
    /// Clock jitter.
    Jitter,
    /// Positions held by a slow sensor.
    Held,
    /// Another sample rate.
    Rate,
    /// Another encoder.
    Counts,
    /// Recordings in closed loop.
    Closed,
    /// A random encoder zero for each recording.
    Zero,
    /// A position that is reported late.
    Delay,
    /// A supply that sags.
    Sag,
}

/// Every item with its name, in the order of their random streams.
const ITEMS: [(Item, &str); 9] = [
    (Item::Torque, "torque"),
    (Item::Jitter, "jitter"),
    (Item::Held, "held"),
    (Item::Rate, "rate"),
    (Item::Counts, "counts"),
    (Item::Closed, "closed"),
    (Item::Zero, "zero"),
    (Item::Delay, "delay"),
    (Item::Sag, "sag"),
];

impl Item {
    /// Every item.
    pub fn all() -> impl Iterator<Item = Self> {
        ITEMS.into_iter().map(|(item, _)| item)
    }

    /// The item's name.
    pub fn name(self) -> &'static str {
        ITEMS[self.index()].1
    }

    /// Its place in the list.
    pub(crate) fn index(self) -> usize {
        self as usize
    }
}

/// Which world a case is made in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Setting {
    /// The kind one.
    Kind,
    /// Everything: torque, jitter, rate, counts and zero in every case; held, closed, delay and sag in every second one.
    Unkind,
    /// These items, every one of them in every case.
    Only(Vec<Item>),
}

/// A world's name that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownItem(pub String);

impl fmt::Display for UnknownItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let items: Vec<&str> = ITEMS.iter().map(|(_, name)| *name).collect();
        write!(f, "no world is called `{}`: kind, unkind, or unkind:ITEM,… of {}", self.0, items.join(", "))
    }
}

impl std::error::Error for UnknownItem {}

impl Setting {
    /// The setting of that name: `kind`, `unkind`, or `unkind:jitter,torque` (a `+` parts the items as well).
    ///
    /// # Errors
    /// [`UnknownItem`] with the name or the item that is none.
    pub fn named(name: &str) -> Result<Self, UnknownItem> {
        let find = |item: &str| {
            let found = ITEMS.iter().find(|(_, name)| *name == item);
            found.map(|(item, _)| *item).ok_or_else(|| UnknownItem(item.to_owned()))
        };
        match name.split_once(':') {
            None if name == "kind" => Ok(Self::Kind),
            None if name == "unkind" => Ok(Self::Unkind),
            Some(("unkind", items)) => {
                let mut items = items.split([',', '+']).map(find).collect::<Result<Vec<_>, _>>()?;
                items.sort_unstable();
                items.dedup();
                Ok(Self::Only(items))
            }
            _ => Err(UnknownItem(name.to_owned())),
        }
    }

    /// Its name, without commas.
    pub fn name(&self) -> String {
        match self {
            Self::Kind => "kind".to_owned(),
            Self::Unkind => "unkind".to_owned(),
            Self::Only(items) => {
                format!("unkind:{}", items.iter().map(|item| item.name()).collect::<Vec<_>>().join("+"))
            }
        }
    }

    /// The world of that seed. An item's values depend on the seed alone, not on the other items, except that a sensor is
    /// never held for less than two ticks.
    pub fn draw(&self, seed: u64) -> World {
        match self {
            Self::Kind => World::default(),
            Self::Unkind => World::drawn(seed, Item::all().filter(|item| super::draw::is_present(seed, *item))),
            Self::Only(items) => World::drawn(seed, items.iter().copied()),
        }
    }
}
