//! Messages of ROS: CDR as ROS 2 writes it, and the plain bytes of ROS 1. CDR has a header of four bytes, and then numbers
//! at multiples of their size.

use super::bytes::Bytes;
use super::fault::Fault;
use super::leaf::{Leaf, Leaves, MAX_ELEMENTS};
use super::ros_type::{Count, Field, Plain, Type, Types};

/// Deepest type within a type.
const MAX_DEPTH: usize = 16;
/// Most values of one message.
const MAX_LEAVES: usize = 4096;
/// Most types within the types of one message: a definition may name itself many times over.
const MAX_TYPES: usize = 4096;

/// How a message is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// ROS 2.
    Cdr,
    /// ROS 1.
    Ros1,
}

/// A message that is being read.
struct Reader<'a, 't> {
    bytes: Bytes<'a>,
    types: &'t Types,
    form: Form,
    /// Where the alignment is counted from, and the largest one.
    origin: usize,
    largest: usize,
    leaves: Leaves,
    /// Types that were gone through.
    gone_through: usize,
}

/// Reads a message.
pub(super) fn read(types: &Types, form: Form, message: &[u8]) -> Result<Leaves, Fault> {
    let mut bytes = Bytes::new(message);
    let mut largest = 8;
    if form == Form::Cdr {
        let head = bytes.take(4)?;
        // 0 and 1 are CDR; from 6 on it is version 2, with numbers at multiples of 4 at most.
        bytes.little = head[1] & 1 == 1;
        largest = if head[1] >= 6 { 4 } else { 8 };
        if (2..6).contains(&head[1]) || head[1] > 7 {
            let what = "messages in a form of CDR with lists of parameters".to_owned();
            return Err(Fault::Unsupported { what, instead: "rosbag2 writes plain CDR" });
        }
    }
    let origin = bytes.at;
    let mut reader = Reader { bytes, types, form, origin, largest, leaves: Leaves::default(), gone_through: 0 };
    reader.fields(&types.root, "", 0)?;
    Ok(reader.leaves)
}

impl Reader<'_, '_> {
    fn fields(&mut self, fields: &[Field], path: &str, depth: usize) -> Result<(), Fault> {
        self.gone_through += 1;
        if depth > MAX_DEPTH || self.leaves.len() > MAX_LEAVES || self.gone_through > MAX_TYPES {
            return Err(Fault::TooLarge { what: "values in a message", most: MAX_LEAVES });
        }
        for field in fields {
            let path = if path.is_empty() { field.name.clone() } else { format!("{path}/{}", field.name) };
            let count = match field.count {
                Count::One => None,
                Count::Fixed(count) => Some(count),
                Count::Any => Some(self.length()?),
            };
            match (&field.kind, count) {
                (Type::Plain(plain), None) => {
                    let leaf = self.plain(*plain)?;
                    self.leaves.push(&path, leaf);
                }
                (Type::Plain(plain), Some(count)) => self.list(*plain, count, &path)?,
                (Type::Message(name), count) => {
                    let at = self.bytes.at as u64;
                    let missing = Fault::Damaged { at, what: "a type is not in the definition of its message" };
                    let types = self.types;
                    let inner = types.fields(name).ok_or(missing)?;
                    for element in 0..count.unwrap_or(1) {
                        let from = self.leaves.len();
                        let path = if count.is_some() { format!("{path}[{element}]") } else { path.clone() };
                        let before = self.bytes.at;
                        self.fields(inner, &path, depth + 1)?;
                        self.leaves.join_stamp(&path, from);
                        // An empty type could be announced any number of times.
                        if self.bytes.at == before {
                            break;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn align(&mut self, size: usize) -> Result<(), Fault> {
        if self.form == Form::Ros1 { Ok(()) } else { self.bytes.align(self.origin, size.min(self.largest)) }
    }

    fn length(&mut self) -> Result<usize, Fault> {
        self.align(4)?;
        Ok(self.bytes.u32()? as usize)
    }

    fn list(&mut self, plain: Plain, count: usize, path: &str) -> Result<(), Fault> {
        let size = match plain {
            Plain::Bool => 1,
            Plain::Signed(size) | Plain::Unsigned(size) | Plain::Float(size) => size,
            Plain::Text | Plain::WideText | Plain::Time => 0,
        };
        if size > 0 && count > MAX_ELEMENTS {
            self.align(size)?;
            let all = count.checked_mul(size).ok_or(Fault::Truncated { at: self.bytes.at as u64 })?;
            return self.bytes.take(all).map(drop);
        }
        let (mut numbers, mut texts) = (Vec::new(), Vec::new());
        for _ in 0..count {
            match self.plain(plain)? {
                Leaf::Number(number) => numbers.push(number),
                Leaf::Text(text) => texts.push(text),
                Leaf::Numbers(_) | Leaf::Texts(_) => {}
            }
        }
        let is_text = matches!(plain, Plain::Text | Plain::WideText);
        self.leaves.push(path, if is_text { Leaf::Texts(texts) } else { Leaf::Numbers(numbers) });
        Ok(())
    }

    fn plain(&mut self, plain: Plain) -> Result<Leaf, Fault> {
        if let Plain::Signed(size) | Plain::Unsigned(size) | Plain::Float(size) = plain {
            self.align(size)?;
        }
        Ok(Leaf::Number(match plain {
            Plain::Bool => f64::from(u8::from(self.bytes.u8()? != 0)),
            Plain::Signed(1) => f64::from(self.bytes.i8()?),
            Plain::Signed(2) => f64::from(self.bytes.i16()?),
            Plain::Signed(4) => f64::from(self.bytes.i32()?),
            Plain::Signed(_) => self.bytes.i64()? as f64,
            Plain::Unsigned(1) => f64::from(self.bytes.u8()?),
            Plain::Unsigned(2) => f64::from(self.bytes.u16()?),
            Plain::Unsigned(4) => f64::from(self.bytes.u32()?),
            Plain::Unsigned(_) => self.bytes.u64()? as f64,
            Plain::Float(4) => f64::from(self.bytes.f32()?),
            Plain::Float(_) => self.bytes.f64()?,
            Plain::Time => f64::from(self.bytes.u32()?) + f64::from(self.bytes.u32()?) / 1e9,
            Plain::Text | Plain::WideText => {
                let length = self.length()?;
                let wide = if plain == Plain::WideText { length.saturating_mul(2) } else { length };
                let text = self.bytes.take(wide)?;
                // ROS 2 counts and writes the zero at the end.
                let text = text.strip_suffix(b"\0").unwrap_or(text);
                return Ok(Leaf::Text(String::from_utf8_lossy(text).into_owned()));
            }
        }))
    }
}
