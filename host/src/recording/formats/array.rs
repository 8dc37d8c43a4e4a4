//! Arrays of numbers as channels: a vector is one, a matrix one for each of its columns.

use super::fault::Fault;
use super::log::{Channel, MAX_CHANNELS, Values};

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A truth value.
    Bool,
    /// Signed, of 1, 2, 4 or 8 bytes.
    Signed { bytes: usize, little: bool },
    /// Unsigned, of 1, 2, 4 or 8 bytes.
    Unsigned { bytes: usize, little: bool },
    /// Floating, of 2, 4 or 8 bytes.
    Float { bytes: usize, little: bool },
    /// A date or a duration of 8 bytes, and how long its unit is, s.
    Time { unit_s: f64, little: bool },
}

impl Kind {
    /// The kind that NumPy calls `<f8`.
    pub(super) fn of_numpy(text: &str) -> Option<Self> {
        let (order, rest) = text.split_at_checked(1)?;
        let (letter, size) = rest.split_at_checked(1)?;
        let little = order != ">";
        if letter == "M" || letter == "m" {
            let unit_s = match size.strip_prefix("8[")?.strip_suffix(']')? {
                "s" => 1.0,
                "ms" => 1e-3,
                "us" => 1e-6,
                "ns" => 1e-9,
                _ => return None,
            };
            return Some(Self::Time { unit_s, little });
        }
        let bytes: usize = size.parse().ok()?;
        match (letter, bytes) {
            ("b", 1) => Some(Self::Bool),
            ("i", 1 | 2 | 4 | 8) => Some(Self::Signed { bytes, little }),
            ("u", 1 | 2 | 4 | 8) => Some(Self::Unsigned { bytes, little }),
            ("f", 2 | 4 | 8) => Some(Self::Float { bytes, little }),
            _ => None,
        }
    }

    /// Its size.
    pub(super) const fn bytes(self) -> usize {
        match self {
            Self::Bool => 1,
            Self::Signed { bytes, .. } | Self::Unsigned { bytes, .. } | Self::Float { bytes, .. } => bytes,
            Self::Time { .. } => 8,
        }
    }

    /// Its unit, where the kind says it.
    pub(super) const fn unit(self) -> Option<&'static str> {
        match self {
            Self::Time { .. } => Some("s"),
            _ => None,
        }
    }

    /// The number at the beginning of `bytes`; NaN if they are too few.
    pub(super) fn number(self, bytes: &[u8]) -> f64 {
        let unsigned = |count: usize, little: bool| {
            let bytes = bytes.get(..count)?;
            let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
            Some(if little { bytes.iter().rev().fold(0, add) } else { bytes.iter().fold(0, add) })
        };
        // The sign bit of a number of fewer bytes than eight is moved to the top, and back.
        let signed = |count: usize, little: bool| {
            let shift = 64 - 8 * count as u32;
            unsigned(count, little).map(|bits| (bits << shift) as i64 >> shift)
        };
        let number = match self {
            Self::Bool => unsigned(1, true).map(|bits| f64::from(u8::from(bits != 0))),
            Self::Signed { bytes, little } => signed(bytes, little).map(|number| number as f64),
            Self::Unsigned { bytes, little } => unsigned(bytes, little).map(|number| number as f64),
            Self::Float { bytes: 8, little } => unsigned(8, little).map(f64::from_bits),
            Self::Float { bytes: 4, little } => unsigned(4, little).map(|bits| f64::from(f32::from_bits(bits as u32))),
            Self::Float { little, .. } => unsigned(2, little).map(|bits| half(bits as u16)),
            Self::Time { unit_s, little } => {
                let count = signed(8, little).filter(|count| *count != i64::MIN);
                // Divided, so that 3 ms are the number that is written 0.003.
                count.map(|count| count as f64 / unit_s.recip().round())
            }
        };
        number.unwrap_or(f64::NAN)
    }
}

/// A number of 16 bits (IEEE 754).
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    sign * match exponent {
        0 => fraction * 2f64.powi(-14),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    }
}

/// Numbers with their shape.
#[derive(Debug)]
pub(super) struct Array<'a> {
    pub name: &'a str,
    pub unit: Option<&'a str>,
    pub shape: &'a [usize],
    /// Whether the first index runs fastest, as in Fortran and MATLAB.
    pub columns_first: bool,
    pub numbers: Vec<f64>,
}

impl Array<'_> {
    /// Adds the array to `channels`. The longer side of a matrix is time.
    pub(super) fn push(self, channels: &mut Vec<Channel>, passed_over: &mut Vec<String>) -> Result<(), Fault> {
        let sides: Vec<usize> = self.shape.iter().copied().filter(|side| *side != 1).collect();
        let unit = || self.unit.map(str::to_owned);
        let channel = |name: String, numbers| Channel { name, unit: unit(), values: Values::Numbers(numbers) };
        match sides[..] {
            [] | [_] => channels.push(channel(self.name.to_owned(), self.numbers)),
            [first, second] => {
                let (rows, columns) = (first.max(second), first.min(second));
                if channels.len() + columns > MAX_CHANNELS {
                    return Err(Fault::TooLarge { what: "channels", most: MAX_CHANNELS });
                }
                // Whether numbers that follow each other are of one column.
                let along = (first >= second) == self.columns_first;
                for column in 0..columns {
                    let at = |row: usize| if along { column * rows + row } else { row * columns + column };
                    let numbers = (0..rows).filter_map(|row| self.numbers.get(at(row)).copied()).collect();
                    channels.push(channel(format!("{}[{column}]", self.name), numbers));
                }
            }
            _ => passed_over.push(format!("`{}`: an array of {} dimensions", self.name, sides.len())),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_kind_are_read() {
        let number = |kind: &str, bytes: &[u8]| Kind::of_numpy(kind).unwrap().number(bytes);
        assert_eq!(number("<f8", &1.5_f64.to_le_bytes()), 1.5);
        assert_eq!(number(">f4", &(-2.5_f32).to_be_bytes()), -2.5);
        // 0x3E00 is 1.5 · 2⁰; 0x8001 the smallest negative number, -2⁻²⁴.
        assert_eq!(number("<f2", &[0x00, 0x3e]), 1.5);
        assert_eq!(number("<f2", &[0x01, 0x80]), -(2f64.powi(-24)));
        assert_eq!(number("<i2", &(-3_i16).to_le_bytes()), -3.0);
        assert_eq!(number("|i1", &[0xff]), -1.0);
        assert_eq!(number("<u4", &u32::MAX.to_le_bytes()), 4_294_967_295.0);
        assert_eq!(number("|b1", &[7]), 1.0);
        assert_eq!(number("<m8[ms]", &3_i64.to_le_bytes()), 0.003);
        assert!(number("<M8[ns]", &i64::MIN.to_le_bytes()).is_nan() && number("<f8", &[0; 7]).is_nan());
    }

    /// A matrix of 3 rows and 2 columns, in C's order and in Fortran's, and lying.
    #[test]
    fn the_longer_side_of_a_matrix_is_time() {
        let columns = |shape: &[usize], columns_first, numbers: &[f64]| {
            let mut channels = Vec::new();
            let array = Array { name: "q", unit: None, shape, columns_first, numbers: numbers.to_vec() };
            array.push(&mut channels, &mut Vec::new()).unwrap();
            channels.into_iter().map(|c| (c.name, c.values.numbers().unwrap().to_vec())).collect::<Vec<_>>()
        };
        let wanted = [("q[0]".to_owned(), vec![1.0, 2.0, 3.0]), ("q[1]".to_owned(), vec![4.0, 5.0, 6.0])];
        assert_eq!(columns(&[3, 2], false, &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]), wanted);
        assert_eq!(columns(&[3, 2], true, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), wanted);
        assert_eq!(columns(&[2, 3], false, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), wanted);
        assert_eq!(columns(&[2, 3], true, &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]), wanted);
        assert_eq!(columns(&[1, 3, 1], true, &[1.0, 2.0, 3.0]), [("q".to_owned(), vec![1.0, 2.0, 3.0])]);
    }
}
