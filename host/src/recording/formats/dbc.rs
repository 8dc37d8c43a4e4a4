//! Signals in a CAN frame by a description in DBC.

use std::collections::HashMap;
use std::path::Path;

use can_dbc::{ByteOrder, Dbc, MultiplexIndicator, Signal, SignalExtendedValueType, ValueType};

use super::guard::guarded;
use crate::file::shown;
use crate::recording::error::LogError;

/// Largest description, bytes: those of whole cars have 2 MB.
const MAX_BYTES: u64 = 1 << 26;

/// A message, and how its signals are stored.
pub(super) struct Description<'a> {
    pub(super) name: &'a str,
    signals: Vec<(&'a Signal, Storage)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Storage {
    Whole,
    Single,
    Double,
}

/// Reads a description.
///
/// # Errors
/// [`LogError::Description`].
pub(in crate::recording) fn read(path: &Path) -> Result<Dbc, LogError> {
    let refused = |what: String| LogError::Description { file: shown(path), what };
    let size = std::fs::metadata(path).map_err(|error| refused(error.to_string()))?.len();
    if size > MAX_BYTES {
        return Err(refused(format!("it has {size} bytes, and {MAX_BYTES} are read at most")));
    }
    let bytes = std::fs::read(path).map_err(|error| refused(error.to_string()))?;
    parse(&shown(path), &bytes)
}

/// Reads a description from its bytes; `file` is its name in messages.
///
/// # Errors
/// [`LogError::Description`].
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<Dbc, LogError> {
    // Units of older files are in Latin-1: their signs are lost, and nothing else.
    let text = String::from_utf8_lossy(bytes);
    let parsed = guarded(|| Dbc::try_from(text.as_ref()).map_err(|error| error.to_string()));
    parsed.unwrap_or_else(|| Err("it is damaged".to_owned())).map_err(|error| {
        let what = error.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
        LogError::Description { file: file.to_owned(), what }
    })
}

/// The messages by identifier, as a DBC has it.
pub(super) fn described(dbc: &Dbc) -> HashMap<u32, Description<'_>> {
    let storage = |id, name: &str| match dbc.extended_value_type_for_signal(id, name) {
        Some(SignalExtendedValueType::IEEEfloat32Bit) => Storage::Single,
        Some(SignalExtendedValueType::IEEEdouble64bit) => Storage::Double,
        _ => Storage::Whole,
    };
    let message = |message: &'_ can_dbc::Message| {
        message.signals.iter().map(|signal| storage(message.id, &signal.name)).collect::<Vec<_>>()
    };
    dbc.messages
        .iter()
        .map(|own| {
            let signals = own.signals.iter().zip(message(own)).collect();
            (own.id.raw(), Description { name: &own.name, signals })
        })
        .collect()
}

impl<'a> Description<'a> {
    /// The unit of a signal, where it has one.
    pub(super) fn unit(&self, name: &str) -> Option<String> {
        let (signal, _) = self.signals.iter().find(|(signal, _)| signal.name == name)?;
        Some(signal.unit.clone()).filter(|unit| !unit.is_empty())
    }

    /// The signals that a frame holds wholly, with their values.
    pub(super) fn values(&self, bytes: &[u8]) -> impl Iterator<Item = (&'a str, f64)> {
        let switch =
            self.signals.iter().find(|(signal, _)| signal.multiplexer_indicator == MultiplexIndicator::Multiplexor);
        let page = switch.and_then(|(signal, _)| raw(signal, bytes));
        let there = move |signal: &Signal| match signal.multiplexer_indicator {
            MultiplexIndicator::MultiplexedSignal(own) | MultiplexIndicator::MultiplexorAndMultiplexedSignal(own) => {
                page == Some(own)
            }
            _ => true,
        };
        self.signals.iter().filter(move |(signal, _)| there(signal)).filter_map(move |(signal, storage)| {
            let value = value(raw(signal, bytes)?, signal, *storage)?;
            Some((signal.name.as_str(), value * signal.factor + signal.offset))
        })
    }
}

/// The bits of a signal; `None` where the frame does not hold them all.
fn raw(signal: &Signal, bytes: &[u8]) -> Option<u64> {
    if !(1..=64).contains(&signal.size) {
        return None;
    }
    let mut bits = 0;
    let mut at = usize::try_from(signal.start_bit).ok()?;
    for k in 0..signal.size {
        let bit = u64::from(*bytes.get(at / 8)? >> (at % 8) & 1);
        match signal.byte_order {
            ByteOrder::LittleEndian => {
                bits |= bit << k;
                at += 1;
            }
            // From the highest bit down, then on from the highest bit of the next byte.
            ByteOrder::BigEndian => {
                bits = bits << 1 | bit;
                at = if at.is_multiple_of(8) { at + 15 } else { at - 1 };
            }
        }
    }
    Some(bits)
}

/// What the bits stand for, before factor and offset.
fn value(bits: u64, signal: &Signal, storage: Storage) -> Option<f64> {
    let unused = 64 - signal.size;
    match (storage, signal.value_type) {
        (Storage::Single, _) => (signal.size == 32).then(|| f64::from(f32::from_bits(bits as u32))),
        (Storage::Double, _) => (signal.size == 64).then(|| f64::from_bits(bits)),
        (Storage::Whole, ValueType::Signed) => Some(((bits << unused) as i64 >> unused) as f64),
        (Storage::Whole, ValueType::Unsigned) => Some(bits as f64),
    }
}
