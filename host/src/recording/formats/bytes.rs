//! Bytes read one number after the other, with an error where they end.
// Not every format reads every number.
#![cfg_attr(not(feature = "logs"), allow(dead_code))]

use super::fault::Fault;

/// A place in bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    /// Next byte.
    pub at: usize,
    /// Whether numbers have their lowest byte first.
    pub little: bool,
}

macro_rules! number {
    ($($name:ident),*) => {$(
        pub(super) fn $name(&mut self) -> Result<$name, Fault> {
            let bytes = self.array()?;
            Ok(if self.little { $name::from_le_bytes(bytes) } else { $name::from_be_bytes(bytes) })
        }
    )*};
}

impl<'a> Bytes<'a> {
    pub(super) const fn new(all: &'a [u8]) -> Self {
        Self { all, at: 0, little: true }
    }

    /// The same with the order of bytes that a file says.
    pub(super) const fn ordered(all: &'a [u8], little: bool) -> Self {
        Self { all, at: 0, little }
    }

    pub(super) const fn left(&self) -> usize {
        self.all.len() - self.at
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.left() == 0
    }

    /// The next `count` bytes.
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], Fault> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.all.len());
        let end = end.ok_or(Fault::Truncated { at: self.at as u64 })?;
        let taken = &self.all[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let at = self.at as u64;
        self.take(N)?.try_into().map_err(|_| Fault::Truncated { at })
    }

    /// What is left.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.all[self.at..]
    }

    /// Passes over bytes up to a multiple of `size`, counted from `origin`.
    pub(super) fn align(&mut self, origin: usize, size: usize) -> Result<(), Fault> {
        let over = (self.at - origin) % size;
        if over > 0 { self.take(size - over).map(drop) } else { Ok(()) }
    }

    /// An unsigned number of `count` bytes, at most 8, the lowest first.
    pub(super) fn unsigned(&mut self, count: usize) -> Result<u64, Fault> {
        let bytes = self.take(count.min(8))?;
        Ok(bytes.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }

    /// Text behind its length of 32 bits.
    pub(super) fn text32(&mut self) -> Result<String, Fault> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    number!(u8, i8, u16, i16, u32, i32, u64, i64, f32, f64);
}
