//! ULog, of PX4's autopilots: formats of the messages, then which are logged, then the messages, stamped in µs.

use std::collections::HashMap;

use super::Format;
use super::array::Kind;
use super::bytes::Bytes;
use super::fault::Fault;
use super::gather::{Gather, Value};
use super::log::{Log, MAX_CHANNELS};

/// Bytes before the first message: magic, version, time.
const HEADER: usize = 16;
/// Deepest message within a message.
const MAX_DEPTH: usize = 8;
/// The field that stamps a message, µs since the autopilot began.
const STAMP: &str = "timestamp";

/// A field at its place in a message.
#[derive(Clone, Debug)]
struct Field {
    name: String,
    at: usize,
    kind: Kind,
}

/// A message that is logged.
#[derive(Debug)]
struct Logged {
    group: usize,
    stamp: Field,
    fields: Vec<Field>,
}

#[derive(Debug, Default)]
struct Reader {
    /// Fields of each format, as text: type and name.
    formats: HashMap<String, Vec<(String, String)>>,
    logged: HashMap<u16, Logged>,
    gather: Gather,
    passed_over: Vec<String>,
}

/// Reads the log.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let mut bytes = Bytes::new(bytes);
    bytes.take(HEADER)?;
    let (mut reader, mut torn_at) = (Reader::default(), None);
    while !bytes.is_empty() {
        let began = bytes.at as u64;
        let mut message = || {
            let (length, kind) = (usize::from(bytes.u16()?), bytes.u8()?);
            Ok((kind, bytes.take(length)?))
        };
        match message() {
            Ok((kind, content)) => reader.message(kind, content, began)?,
            // The log of an autopilot that lost its power.
            Err(Fault::Truncated { .. }) => {
                torn_at = Some(began);
                break;
            }
            Err(other) => return Err(other),
        }
    }
    let mut log = reader.gather.log(Format::Ulog)?;
    (log.torn_at, log.passed_over) = (torn_at, reader.passed_over);
    Ok(log)
}

impl Reader {
    fn message(&mut self, kind: u8, content: &[u8], at: u64) -> Result<(), Fault> {
        let mut bytes = Bytes::new(content);
        match kind {
            b'F' => {
                let text = String::from_utf8_lossy(content).into_owned();
                let (name, fields) = text.split_once(':').unwrap_or((&text, ""));
                let fields = fields.split(';').filter_map(|field| field.trim().split_once(' '));
                let fields = fields.map(|(kind, name)| (kind.to_owned(), name.trim().to_owned())).collect();
                self.formats.insert(name.to_owned(), fields);
            }
            b'A' => {
                let (Ok(instance), Ok(id)) = (bytes.u8(), bytes.u16()) else {
                    return Err(Fault::Damaged { at, what: "a subscription is too short" });
                };
                let name = String::from_utf8_lossy(bytes.take(bytes.left())?).into_owned();
                self.subscribe(instance, id, &name)?;
            }
            b'D' => {
                let Ok(id) = bytes.u16() else {
                    return Err(Fault::Damaged { at, what: "a message is too short for its number" });
                };
                let Some(Logged { group, stamp, fields }) = self.logged.get(&id) else { return Ok(()) };
                let data = bytes.take(bytes.left())?;
                let number = |field: &Field| field.kind.number(data.get(field.at..).unwrap_or_default());
                self.gather.row(*group, number(stamp) / 1e6)?;
                for field in fields {
                    self.gather.set(*group, &field.name, &Value::Number(number(field)))?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes a message that is logged. Of several instances the first has the plain name.
    fn subscribe(&mut self, instance: u8, id: u16, name: &str) -> Result<(), Fault> {
        let (mut fields, mut left) = (Vec::new(), MAX_CHANNELS);
        let size = self.lay_out(name, "", (0, 0), &mut left, &mut fields)?;
        let stamp = fields.iter().position(|field| field.name == STAMP).map(|at| fields.remove(at));
        let (Some(_), Some(stamp)) = (size, stamp) else {
            self.passed_over.push(format!("`{name}`: its format is missing or has no `{STAMP}`"));
            return Ok(());
        };
        let full = if instance == 0 { name.to_owned() } else { format!("{name}.{instance}") };
        let group = self.gather.group(&full)?;
        self.logged.insert(id, Logged { group, stamp, fields });
        Ok(())
    }

    /// Lays out the fields of a format from a byte on, at a depth; `left` counts down what may still be gone through. Returns
    /// the byte after it, `None` if a format is not there.
    fn lay_out(
        &self,
        name: &str,
        path: &str,
        (mut at, depth): (usize, usize),
        left: &mut usize,
        out: &mut Vec<Field>,
    ) -> Result<Option<usize>, Fault> {
        let Some(format) = self.formats.get(name).filter(|_| depth <= MAX_DEPTH) else { return Ok(None) };
        for (kind, field) in format {
            let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
                Some((kind, count)) => (kind, count.parse::<u16>().map(usize::from).ok()),
                None => (kind.as_str(), None),
            };
            for element in 0..count.unwrap_or(1) {
                // A format may name itself many times over.
                *left =
                    left.checked_sub(1).ok_or(Fault::TooLarge { what: "fields in a message", most: MAX_CHANNELS })?;
                let element = count.map_or_else(String::new, |_| format!("[{element}]"));
                let full = format!("{path}{field}{element}");
                match (plain(kind), kind) {
                    (Some(kind), _) => {
                        if !field.starts_with("_padding") {
                            out.push(Field { name: full, at, kind });
                        }
                        at += kind.bytes();
                    }
                    (None, "char") => at += 1,
                    (None, other) => {
                        let Some(end) = self.lay_out(other, &format!("{full}."), (at, depth + 1), left, out)? else {
                            return Ok(None);
                        };
                        // An empty format could be announced any number of times.
                        if end == at {
                            break;
                        }
                        at = end;
                    }
                }
            }
        }
        Ok(Some(at))
    }
}

/// The kind of a type that is a number.
fn plain(name: &str) -> Option<Kind> {
    let little = true;
    Some(match name {
        "int8_t" => Kind::Signed { bytes: 1, little },
        "int16_t" => Kind::Signed { bytes: 2, little },
        "int32_t" => Kind::Signed { bytes: 4, little },
        "int64_t" => Kind::Signed { bytes: 8, little },
        "uint8_t" => Kind::Unsigned { bytes: 1, little },
        "uint16_t" => Kind::Unsigned { bytes: 2, little },
        "uint32_t" => Kind::Unsigned { bytes: 4, little },
        "uint64_t" => Kind::Unsigned { bytes: 8, little },
        "float" => Kind::Float { bytes: 4, little },
        "double" => Kind::Float { bytes: 8, little },
        "bool" => Kind::Bool,
        _ => return None,
    })
}
