//! MATLAB's files of versions 5 to 7: elements of a type and a size, matrices in them, packed by zlib or not.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::array::{Array, Kind};
use super::bytes::Bytes;
use super::fault::Fault;
use super::log::{Channel, Log, MAX_CHANNELS};
use super::{Format, MAX_BYTES};

/// Bytes before the first element, and where the order of the bytes is said.
const HEADER: usize = 128;
const ORDER: usize = 126;
/// Deepest structure within a structure.
const MAX_DEPTH: usize = 16;
/// Most elements of an array of structures.
const MAX_ELEMENTS: usize = 64;
/// Types of elements.
const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;
/// Classes of matrices.
const CELL: u8 = 1;
const STRUCTURE: u8 = 2;
const NUMBERS: std::ops::RangeInclusive<u8> = 6..=15;

/// What is read.
#[derive(Debug)]
struct Reader {
    little: bool,
    channels: Vec<Channel>,
    passed_over: Vec<String>,
    /// Bytes that may still be unpacked.
    left: u64,
}

/// Reads the file's variables.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let little = match bytes.get(ORDER..HEADER) {
        Some(b"IM") => true,
        Some(b"MI") => false,
        _ => return Err(Fault::Damaged { at: ORDER as u64, what: "the header does not say the order of bytes" }),
    };
    let mut reader = Reader { little, channels: Vec::new(), passed_over: Vec::new(), left: MAX_BYTES as u64 };
    let mut bytes = Bytes::ordered(bytes, little);
    bytes.take(HEADER)?;
    while bytes.left() >= 8 {
        let at = bytes.at as u64;
        match element(&mut bytes)? {
            (COMPRESSED, packed) => {
                let mut content = Vec::new();
                // Each is one element, whose size is not known before.
                ZlibDecoder::new(packed.rest())
                    .take(reader.left + 1)
                    .read_to_end(&mut content)
                    .map_err(|_| Fault::Damaged { at, what: "a variable cannot be unpacked" })?;
                reader.left = reader
                    .left
                    .checked_sub(content.len() as u64)
                    .ok_or(Fault::TooLarge { what: "bytes, unpacked", most: MAX_BYTES })?;
                let mut content = Bytes::ordered(&content, little);
                if let (MATRIX, mut matrix) = element(&mut content)? {
                    reader.matrix(&mut matrix, None, 0)?;
                }
            }
            (MATRIX, mut matrix) => reader.matrix(&mut matrix, None, 0)?,
            _ => {}
        }
    }
    let mut log = Log::of_arrays(Format::Mat, reader.channels)?;
    log.passed_over = reader.passed_over;
    Ok(log)
}

/// The next element: its type and its content.
fn element<'a>(bytes: &mut Bytes<'a>) -> Result<(u32, Bytes<'a>), Fault> {
    let tag = bytes.u32()?;
    let inside = |content: &'a [u8], little| Bytes::ordered(content, little);
    // A small one has its size in the upper half, and its content in the other four bytes of the tag.
    if tag >> 16 != 0 {
        let content = bytes.take(4)?;
        let size = (tag >> 16) as usize;
        let content = content.get(..size);
        let damaged = Fault::Damaged { at: bytes.at as u64, what: "a small element is larger than four bytes" };
        return Ok((tag & 0xffff, inside(content.ok_or(damaged)?, bytes.little)));
    }
    let size = bytes.u32()? as usize;
    let content = bytes.take(size)?;
    // Elements begin at multiples of eight bytes, but for what is packed. The last one may not be filled up.
    let over = size % 8;
    if tag != COMPRESSED && over > 0 {
        bytes.take((8 - over).min(bytes.left()))?;
    }
    Ok((tag, inside(content, bytes.little)))
}

impl Reader {
    /// Reads a matrix. `name` is what a structure calls it; else it has its own.
    fn matrix(&mut self, bytes: &mut Bytes<'_>, name: Option<&str>, depth: usize) -> Result<(), Fault> {
        if bytes.is_empty() {
            return Ok(());
        }
        if depth > MAX_DEPTH {
            return Err(Fault::TooLarge { what: "structures within each other", most: MAX_DEPTH });
        }
        let class = element(bytes)?.1.u32()? as u8;
        let (_, mut sides) = element(bytes)?;
        let mut shape = Vec::new();
        while sides.left() >= 4 {
            shape.push(sides.u32()? as usize);
        }
        let (_, own) = element(bytes)?;
        let own = String::from_utf8_lossy(own.rest()).into_owned();
        let name = name.unwrap_or(&own);
        match class {
            class if NUMBERS.contains(&class) => {
                let at = bytes.at as u64;
                let (kind, content) = element(bytes)?;
                let kind =
                    kind_of(kind, self.little).ok_or(Fault::Damaged { at, what: "numbers of an unknown type" })?;
                let count = shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
                let content = content.rest();
                if count != Some(content.len() / kind.bytes()) {
                    return Err(Fault::Damaged { at, what: "a matrix whose size is not that of its content" });
                }
                let numbers = content.chunks_exact(kind.bytes()).map(|bytes| kind.number(bytes)).collect();
                if self.channels.len() >= MAX_CHANNELS {
                    return Err(Fault::TooLarge { what: "channels", most: MAX_CHANNELS });
                }
                let array = Array { name, unit: None, shape: &shape, columns_first: true, numbers };
                array.push(&mut self.channels, &mut self.passed_over)
            }
            STRUCTURE => self.structure(bytes, name, &shape, depth),
            CELL => {
                let count = shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side)).unwrap_or(0);
                for cell in 0..count.min(MAX_ELEMENTS) {
                    let (_, mut content) = element(bytes)?;
                    self.matrix(&mut content, Some(&format!("{name}{{{}}}", cell + 1)), depth + 1)?;
                }
                Ok(())
            }
            class => {
                self.passed_over
                    .push(format!("`{name}`: a variable of class {class}, neither numbers nor a structure"));
                Ok(())
            }
        }
    }

    /// Reads the fields of a structure, or of each of an array of them.
    fn structure(&mut self, bytes: &mut Bytes<'_>, name: &str, shape: &[usize], depth: usize) -> Result<(), Fault> {
        let at = bytes.at as u64;
        let length = element(bytes)?.1.u32()? as usize;
        let (_, names) = element(bytes)?;
        if length == 0 {
            return Err(Fault::Damaged { at, what: "a structure whose fields have names of no length" });
        }
        let text = |field: &[u8]| {
            String::from_utf8_lossy(field.split(|byte| *byte == 0).next().unwrap_or_default()).into_owned()
        };
        let fields: Vec<String> = names.rest().chunks_exact(length).map(text).collect();
        let count = shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side)).unwrap_or(0);
        for index in 0..count.min(MAX_ELEMENTS) {
            for field in &fields {
                let (_, mut content) = element(bytes)?;
                let index = if count > 1 { format!("({})", index + 1) } else { String::new() };
                self.matrix(&mut content, Some(&format!("{name}{index}.{field}")), depth + 1)?;
            }
        }
        Ok(())
    }
}

/// How the numbers of an element are stored.
fn kind_of(element: u32, little: bool) -> Option<Kind> {
    Some(match element {
        1 => Kind::Signed { bytes: 1, little },
        2 => Kind::Unsigned { bytes: 1, little },
        3 => Kind::Signed { bytes: 2, little },
        4 => Kind::Unsigned { bytes: 2, little },
        5 => Kind::Signed { bytes: 4, little },
        6 => Kind::Unsigned { bytes: 4, little },
        7 => Kind::Float { bytes: 4, little },
        9 => Kind::Float { bytes: 8, little },
        12 => Kind::Signed { bytes: 8, little },
        13 => Kind::Unsigned { bytes: 8, little },
        _ => return None,
    })
}
