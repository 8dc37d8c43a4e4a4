//! Arrays of NumPy (`.npy`, format versions 1 to 3): a magic, a header that is a Python dictionary, the numbers.

use super::array::{Array, Kind};
use super::bytes::Bytes;
use super::fault::Fault;
use super::log::{Channel, Log};
use super::{Format, MAX_BYTES};

/// Most bytes of a header; NumPy itself refuses more than 10 000.
const MAX_HEADER: usize = 1 << 20;
/// Most dimensions of an array that NumPy has.
const MAX_DIMENSIONS: usize = 64;

/// What the header says.
#[derive(Clone, Debug, PartialEq)]
struct Header {
    /// Name (empty if there is but one), kind, and how many of it are in a row.
    fields: Vec<(String, Kind, usize)>,
    columns_first: bool,
    shape: Vec<usize>,
}

/// Reads one array as a log.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let mut channels = Vec::new();
    let mut passed_over = Vec::new();
    array("array", bytes, &mut channels, &mut passed_over)?;
    let mut log = Log::of_arrays(Format::Npy, channels)?;
    log.passed_over = passed_over;
    Ok(log)
}

/// Reads an array as channels called `name`.
pub(super) fn array(
    name: &str,
    bytes: &[u8],
    channels: &mut Vec<Channel>,
    passed_over: &mut Vec<String>,
) -> Result<(), Fault> {
    let mut bytes = Bytes::new(bytes);
    if bytes.take(6)? != b"\x93NUMPY" {
        return Err(Fault::Damaged { at: 0, what: "an array does not begin with \\x93NUMPY" });
    }
    let (major, _minor) = (bytes.u8()?, bytes.u8()?);
    let length = if major == 1 { usize::from(bytes.u16()?) } else { bytes.u32()? as usize };
    if length > MAX_HEADER {
        return Err(Fault::Damaged { at: bytes.at as u64, what: "the header of an array is too long" });
    }
    let at = bytes.at as u64;
    let text = String::from_utf8_lossy(bytes.take(length)?).into_owned();
    let Some(header) = header(&text) else {
        if text.contains("'O'") || text.contains("|O") {
            passed_over.push(format!("`{name}`: Python objects"));
            return Ok(());
        }
        return Err(Fault::Damaged { at, what: "the header of an array is not understood" });
    };
    let rows = header.shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
    let row_bytes = header
        .fields
        .iter()
        .try_fold(0_usize, |sum, (_, kind, count)| sum.checked_add(kind.bytes().checked_mul(*count)?));
    let Some(row_bytes) = row_bytes.filter(|bytes| *bytes > 0) else {
        passed_over.push(format!("`{name}`: rows of no bytes, or of too many"));
        return Ok(());
    };
    let total = rows.and_then(|rows| rows.checked_mul(row_bytes)).filter(|total| *total <= MAX_BYTES);
    let (Some(rows), Some(total)) = (rows, total) else {
        return Err(Fault::TooLarge { what: "bytes in an array", most: MAX_BYTES });
    };
    let data = bytes.take(total)?;
    let mut offset = 0;
    for (field, kind, count) in &header.fields {
        let full = if field.is_empty() { name.to_owned() } else { format!("{name}.{field}") };
        let mut shape = header.shape.clone();
        if *count > 1 {
            shape.push(*count);
        }
        let number =
            |row: usize, element: usize| kind.number(&data[row * row_bytes + offset + element * kind.bytes()..]);
        let numbers = (0..rows).flat_map(|row| (0..*count).map(move |element| (row, element)));
        let numbers: Vec<f64> = numbers.map(|(row, element)| number(row, element)).collect();
        let array =
            Array { name: &full, unit: kind.unit(), shape: &shape, columns_first: header.columns_first, numbers };
        array.push(channels, passed_over)?;
        offset += kind.bytes() * count;
    }
    Ok(())
}

/// The header's dictionary.
fn header(text: &str) -> Option<Header> {
    let after = |key: &str| {
        let at = text.find(&format!("'{key}'"))?;
        Some(text[at + key.len() + 2..].trim_start().strip_prefix(':')?.trim_start())
    };
    let columns_first = after("fortran_order")?.starts_with("True");
    let (shape, _) = after("shape")?.strip_prefix('(')?.split_once(')')?;
    let shape = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape: Vec<usize> = shape.map(|side| side.trim_end_matches('L').parse().ok()).collect::<Option<_>>()?;
    let descr = after("descr")?;
    let fields = if let Some(quoted) = descr.strip_prefix('\'') {
        vec![(String::new(), Kind::of_numpy(quoted.split_once('\'')?.0)?, 1)]
    } else {
        fields(descr.strip_prefix('[')?)?
    };
    (shape.len() <= MAX_DIMENSIONS).then_some(Header { fields, columns_first, shape })
}

/// The fields of a record array: `('t', '<f8'), ('q', '<f8', (6,))]`.
fn fields(mut text: &str) -> Option<Vec<(String, Kind, usize)>> {
    let mut fields = Vec::new();
    loop {
        text = text.trim_start_matches([',', ' ']);
        if text.starts_with(']') {
            return Some(fields);
        }
        let quoted = |text: &'_ str| {
            let (inside, rest) = text.trim_start_matches([',', ' ']).strip_prefix('\'')?.split_once('\'')?;
            Some((inside.to_owned(), rest.len()))
        };
        text = text.strip_prefix('(')?;
        let (name, left) = quoted(text)?;
        text = &text[text.len() - left..];
        let (kind, left) = quoted(text)?;
        text = text[text.len() - left..].trim_start();
        let mut count = 1_usize;
        if let Some(shape) = text.strip_prefix(", (") {
            let (sides, rest) = shape.split_once(')')?;
            for side in sides.split(',').map(str::trim).filter(|side| !side.is_empty()) {
                count = count.checked_mul(side.parse().ok()?)?;
            }
            text = rest;
        }
        text = text.strip_prefix(')')?;
        fields.push((name, Kind::of_numpy(&kind)?, count));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_plain_and_of_record_arrays_are_read() {
        let plain = header("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }          \n").unwrap();
        assert_eq!((plain.shape, plain.columns_first), (vec![3, 2], false));
        let text = "{'descr': [('t', '<f8'), ('q', '>i2', (2, 3))], 'fortran_order': True, 'shape': (10,), }";
        let records = header(text).unwrap();
        let sizes: Vec<_> =
            records.fields.iter().map(|(name, kind, count)| (name.as_str(), kind.bytes(), *count)).collect();
        assert_eq!(sizes, [("t", 8, 1), ("q", 2, 6)]);
        for wrong in
            ["", "{}", "{'descr': '<f8'", "{'descr': [('t'", "{'descr': '|O', 'fortran_order': False, 'shape': ()}"]
        {
            assert_eq!(header(wrong), None, "{wrong}");
        }
    }
}
