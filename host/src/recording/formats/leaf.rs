//! The values of a message: a path and a number, a text, or a list of these; and how they become channels.

use super::fault::Fault;
use super::gather::{Gather, Value};

/// Most elements of a list that become channels: an image or a scan is no signal of an axis.
pub(super) const MAX_ELEMENTS: usize = 64;
/// Fields that name the elements of the lists beside them, as in a JointState.
const NAMES: [&str; 3] = ["name", "names", "joint_names"];

/// A value at the end of a path.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leaf {
    Number(f64),
    Text(String),
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

/// The values of one message, each with its path, as in `header/stamp`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Leaves(Vec<(String, Leaf)>);

impl Leaves {
    pub(super) fn push(&mut self, path: &str, leaf: Leaf) {
        self.0.push((path.to_owned(), leaf));
    }

    /// Number of values so far.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Puts two values from `from` on in order so that `sec` comes before `nanosec` and `nsec`.
    pub(super) fn sort_from(&mut self, from: usize) {
        if let [first, second] = &mut self.0[from..]
            && first.0.len() > second.0.len()
        {
            std::mem::swap(first, second);
        }
    }

    /// Makes one number, in s, of the values from `from` on, if they are the seconds and nanoseconds of `path`.
    pub(super) fn join_stamp(&mut self, path: &str, from: usize) {
        let [(first, Leaf::Number(seconds)), (second, Leaf::Number(nanoseconds))] = &self.0[from..] else { return };
        let last = |path: &str| path.rsplit('/').next().unwrap_or_default().to_owned();
        let pair = (last(first), last(second));
        let is_stamp = [("sec", "nanosec"), ("sec", "nsec"), ("secs", "nsecs"), ("seconds", "nanos")]
            .iter()
            .any(|(whole, part)| pair.0 == *whole && pair.1 == *part);
        if is_stamp {
            let seconds = seconds + nanoseconds / 1e9;
            self.0.truncate(from);
            self.push(path, Leaf::Number(seconds));
        }
    }

    /// Sets the values in the last row of a group. Lists beside a list of names of the same length are named by it, the name
    /// first, as in `joint1/position`.
    pub(super) fn set(&self, gather: &mut Gather, group: usize) -> Result<(), Fault> {
        for (path, leaf) in &self.0 {
            match leaf {
                Leaf::Number(number) => gather.set(group, path, &Value::Number(*number))?,
                Leaf::Text(text) => gather.set(group, path, &Value::Text(text))?,
                Leaf::Numbers(numbers) => {
                    let names = self.names(path, numbers.len());
                    for (k, number) in numbers.iter().enumerate().take(MAX_ELEMENTS) {
                        let name = names.and_then(|names| names.get(k));
                        let name = name.map_or_else(|| format!("{path}[{k}]"), |name| named(path, name));
                        gather.set(group, &name, &Value::Number(*number))?;
                    }
                }
                Leaf::Texts(_) => {}
            }
        }
        Ok(())
    }

    /// The names of the list at `path`, if a list of as many stands beside it.
    fn names(&self, path: &str, count: usize) -> Option<&[String]> {
        let beside = path.rsplit_once('/').map_or("", |(before, _)| before);
        self.0.iter().find_map(|(other, leaf)| {
            let (before, last) = other.rsplit_once('/').unwrap_or(("", other));
            match leaf {
                Leaf::Texts(names) if before == beside && NAMES.contains(&last) && names.len() == count => {
                    Some(names.as_slice())
                }
                _ => None,
            }
        })
    }
}

/// The path of an element that has a name.
fn named(path: &str, name: &str) -> String {
    match path.rsplit_once('/') {
        Some((before, last)) => format!("{before}/{name}/{last}"),
        None => format!("{name}/{path}"),
    }
}
