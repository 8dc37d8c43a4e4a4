//! One field of a row: text to number.

use super::error::{ListError, Place, RecordingError};

/// Most characters of a wrong field that a message repeats.
const SHOWN: usize = 40;

/// A field for a message: what does not fit, and what a terminal would obey, left out.
pub(super) fn shown(text: &str) -> String {
    let mut short: String = text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).take(SHOWN).collect();
    if text.chars().nth(SHOWN).is_some() {
        short.push('…');
    }
    short
}

/// The finite number in a field; `place` is called only for an error. With `decimal_comma`, 0,5 is a number too.
pub(super) fn number(bytes: &[u8], decimal_comma: bool, place: impl FnOnce() -> Place) -> Result<f64, RecordingError> {
    let bytes = bytes.trim_ascii();
    let Ok(text) = std::str::from_utf8(bytes) else {
        return Err(RecordingError::NotUtf8 { place: place() });
    };
    let parsed = text.parse::<f64>().or_else(|error| match text.split_once(',') {
        Some((whole, part)) if decimal_comma && !part.contains(',') && !text.contains('.') => {
            format!("{whole}.{part}").parse()
        }
        _ => Err(error),
    });
    match parsed {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(RecordingError::NotFinite { place: place(), text: shown(text) }),
        Err(_) if text.is_empty() => Err(RecordingError::EmptyField { place: place() }),
        Err(_) if text.starts_with(['[', '(']) => Err(ListError::Whole { place: place(), text: shown(text) }.into()),
        Err(_) if text.contains('\n') => Err(RecordingError::OpenQuote { place: place() }),
        Err(_) => Err(RecordingError::NotANumber { place: place(), text: shown(text) }),
    }
}
