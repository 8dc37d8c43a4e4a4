//! Definitions of ROS messages: the fields of a type, and of the types in it.

use std::collections::HashMap;

/// A type that has no fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plain {
    Bool,
    Signed(usize),
    Unsigned(usize),
    Float(usize),
    Text,
    WideText,
    /// ROS 1: seconds and nanoseconds, 32 bits each.
    Time,
}

impl Plain {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "bool" | "boolean" => Self::Bool,
            "int8" => Self::Signed(1),
            "int16" => Self::Signed(2),
            "int32" => Self::Signed(4),
            "int64" => Self::Signed(8),
            "uint8" | "byte" | "char" | "octet" => Self::Unsigned(1),
            "uint16" => Self::Unsigned(2),
            "uint32" => Self::Unsigned(4),
            "uint64" => Self::Unsigned(8),
            "float32" => Self::Float(4),
            "float64" => Self::Float(8),
            "string" => Self::Text,
            "wstring" => Self::WideText,
            "time" | "duration" => Self::Time,
            _ => return None,
        })
    }
}

/// What a field holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Plain(Plain),
    /// The name of another type.
    Message(String),
}

/// How many of it there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    One,
    Fixed(usize),
    /// As many as the message says.
    Any,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    pub name: String,
    pub kind: Type,
    pub count: Count,
}

/// The types of a schema.
#[derive(Clone, Debug, Default)]
pub(super) struct Types {
    /// Fields of the message itself.
    pub root: Vec<Field>,
    others: HashMap<String, Vec<Field>>,
}

impl Types {
    /// Reads a definition as `rosbag2` and `rosbag` write it. The message's own fields come first, then the other types. Each
    /// of these has a line of `=` above it, and a line `MSG: package/Type`. `None` if a line is not understood.
    pub(super) fn read(text: &str) -> Option<Self> {
        let mut types = Self::default();
        let mut name: Option<String> = None;
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if line.is_empty() || line.starts_with("====") {
                continue;
            }
            if let Some(other) = line.strip_prefix("MSG:") {
                let other = canonical(other.trim());
                types.others.entry(other.clone()).or_default();
                name = Some(other);
                continue;
            }
            let fields = match &name {
                Some(name) => types.others.entry(name.clone()).or_default(),
                None => &mut types.root,
            };
            fields.extend(field(line)?);
        }
        Some(types)
    }

    /// The fields of a type; ROS leaves out the package where it is the same, and that of `Header`.
    pub(super) fn fields(&self, name: &str) -> Option<&[Field]> {
        let name = canonical(name);
        let exact = self.others.get(&name);
        let last = name.rsplit('/').next().unwrap_or_default();
        let same = |other: &&String| other.rsplit('/').next() == Some(last);
        let found = exact.or_else(|| self.others.keys().filter(same).min().and_then(|name| self.others.get(name)));
        found.map(Vec::as_slice)
    }
}

/// `package/Type` of `package/msg/Type`.
fn canonical(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// The field of a line, none where it is a constant; `None` where the line is not understood.
fn field(line: &str) -> Option<Vec<Field>> {
    let (kind, rest) = line.split_once(char::is_whitespace)?;
    let rest = rest.trim();
    let name = rest.split(|c: char| c.is_whitespace() || c == '=').next()?;
    if rest[name.len()..].trim_start().starts_with('=') {
        return Some(Vec::new());
    }
    let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.rsplit_once('[')) {
        Some((kind, "")) => (kind, Count::Any),
        Some((kind, size)) if size.starts_with("<=") => (kind, Count::Any),
        Some((kind, size)) => (kind, Count::Fixed(size.parse().ok()?)),
        None => (kind, Count::One),
    };
    // A text may have a longest length: `string<=10`.
    let kind = kind.split("<=").next()?;
    let kind = Plain::of(kind).map_or_else(|| Type::Message(kind.to_owned()), Type::Plain);
    Some(vec![Field { name: name.to_owned(), kind, count }])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_state_is_understood() {
        let text = "# The state of joints\nstd_msgs/Header header\n\nstring[] name\nfloat64[] position # rad\nuint8 A=3\n\
                    float32[<=4] few\nint16[3] three\nstring<=5 short \"x\"\n\
                    ================\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
                    ================\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
        let types = Types::read(text).unwrap();
        let names: Vec<_> = types.root.iter().map(|field| (field.name.as_str(), field.count)).collect();
        let wanted = [("header", Count::One), ("name", Count::Any), ("position", Count::Any), ("few", Count::Any)];
        assert_eq!(names[..4], wanted);
        assert_eq!(names[4..], [("three", Count::Fixed(3)), ("short", Count::One)]);
        assert_eq!(types.fields("std_msgs/msg/Header").unwrap().len(), 2);
        assert_eq!(types.fields("Time").unwrap()[1].name, "nanosec");
        assert_eq!(types.fields("Other"), None);
    }
}
