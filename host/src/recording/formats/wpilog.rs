//! WPILib's data log, version 1.0: records of an entry, a time in µs and a value; entry 0 says which entries there are.

use std::collections::HashMap;

use super::Format;
use super::bytes::Bytes;
use super::fault::Fault;
use super::gather::{Gather, Value};
use super::log::Log;

/// Most elements of an array that become channels.
const MAX_ELEMENTS: usize = 64;

/// How an entry's values are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Boolean,
    Int64,
    Float,
    Double,
    Text,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        match name {
            "boolean" => Some(Self::Boolean),
            "int64" => Some(Self::Int64),
            "float" => Some(Self::Float),
            "double" => Some(Self::Double),
            "string" | "json" => Some(Self::Text),
            _ => None,
        }
    }
}

/// An entry whose values are read.
#[derive(Debug)]
struct Entry {
    group: usize,
    kind: Kind,
    is_array: bool,
}

/// Reads the log.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let mut bytes = Bytes::new(bytes);
    bytes.take(6)?;
    let version = bytes.u16()?;
    if version >> 8 != 1 {
        let what = format!("version {}.{} of WPILOG", version >> 8, version & 255);
        return Err(Fault::Unsupported { what, instead: "version 1 is, which WPILib writes since 2022" });
    }
    let extra = bytes.u32()? as usize;
    bytes.take(extra)?;
    let (mut gather, mut entries) = (Gather::default(), HashMap::new());
    let (mut passed_over, mut torn_at) = (Vec::new(), None);
    while !bytes.is_empty() {
        let began = bytes.at as u64;
        match record(&mut bytes, &mut gather, &mut entries, &mut passed_over) {
            Ok(()) => {}
            // A robot that is switched off leaves a record half written, or zeros behind it.
            Err(Fault::Truncated { .. }) if began > 0 => {
                torn_at = Some(began);
                break;
            }
            Err(other) => return Err(other),
        }
    }
    let mut log = gather.log(Format::Wpilog)?;
    (log.torn_at, log.passed_over) = (torn_at, passed_over);
    Ok(log)
}

/// Reads one record.
fn record(
    bytes: &mut Bytes<'_>,
    gather: &mut Gather,
    entries: &mut HashMap<u64, Entry>,
    passed_over: &mut Vec<String>,
) -> Result<(), Fault> {
    // Lengths of what follows: two bits for the entry, two for the size, three for the time, each less one.
    let lengths = usize::from(bytes.u8()?);
    let entry = bytes.unsigned((lengths & 3) + 1)?;
    let size = bytes.unsigned((lengths >> 2 & 3) + 1)?;
    let stamp_us = bytes.unsigned((lengths >> 4 & 7) + 1)?;
    let mut payload = Bytes::new(bytes.take(size as usize)?);
    if entry == 0 {
        return control(&mut payload, gather, entries, passed_over).map_err(|fault| match fault {
            Fault::Truncated { .. } => Fault::Damaged { at: bytes.at as u64, what: "a control record is too short" },
            other => other,
        });
    }
    let Some(entry) = entries.get(&entry) else { return Ok(()) };
    gather.row(entry.group, stamp_us as f64 / 1e6)?;
    if entry.kind == Kind::Text {
        if !entry.is_array {
            let text = String::from_utf8_lossy(payload.take(payload.left())?).into_owned();
            gather.set(entry.group, "", &Value::Text(&text))?;
        }
        return Ok(());
    }
    let mut element = 0;
    while element < MAX_ELEMENTS
        && let Ok(number) = number(&mut payload, entry.kind)
    {
        let name = if entry.is_array { format!("[{element}]") } else { String::new() };
        gather.set(entry.group, &name, &Value::Number(number))?;
        element += 1;
        if !entry.is_array {
            break;
        }
    }
    Ok(())
}

/// The next number of an entry's kind.
fn number(payload: &mut Bytes<'_>, kind: Kind) -> Result<f64, Fault> {
    Ok(match kind {
        Kind::Boolean => f64::from(u8::from(payload.u8()? != 0)),
        Kind::Int64 => payload.i64()? as f64,
        Kind::Float => f64::from(payload.f32()?),
        Kind::Double | Kind::Text => payload.f64()?,
    })
}

/// Takes a control record: an entry begins (0), ends (1), or has other metadata (2).
fn control(
    payload: &mut Bytes<'_>,
    gather: &mut Gather,
    entries: &mut HashMap<u64, Entry>,
    passed_over: &mut Vec<String>,
) -> Result<(), Fault> {
    let (what, entry) = (payload.u8()?, u64::from(payload.u32()?));
    match what {
        0 => {
            let (name, kind) = (payload.text32()?, payload.text32()?);
            let (element, is_array) = kind.strip_suffix("[]").map_or((kind.as_str(), false), |element| (element, true));
            match Kind::of(element) {
                Some(kind) => {
                    let group = gather.group(&name)?;
                    entries.insert(entry, Entry { group, kind, is_array });
                }
                None => passed_over.push(format!("`{name}`: {kind}")),
            }
        }
        1 => {
            entries.remove(&entry);
        }
        _ => {}
    }
    Ok(())
}
