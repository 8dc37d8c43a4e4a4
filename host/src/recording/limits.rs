//! How much of a file is read, so that no input, not even one without an end, takes all memory.

use std::cell::Cell;
use std::io::{self, Read};
use std::rc::Rc;

use super::error::RecordingError;
use crate::file::FileError;

/// Most bytes before the end of a row: as many columns as there may be, of 64 characters each.
pub const MAX_ROW_BYTES: usize = 1 << 20;
/// Most columns: what spreadsheets can have.
pub const MAX_COLUMNS: usize = 16_384;
/// Most rows that are kept: fourteen hours at 1 kHz, in 1.2 GB.
pub const MAX_ROWS: usize = 50_000_000;
/// Bytes that a reader asks for at once.
pub(super) const BUFFER: usize = 1 << 16;

/// What a [`Limited`] reader has seen and may still read, shared with who uses it.
#[derive(Debug, Default)]
pub(super) struct Meter {
    left: Cell<usize>,
    exceeded: Cell<bool>,
    last: Cell<u8>,
}

impl Meter {
    /// A row has ended: the next one may be as long again. What is buffered already does not count.
    pub(super) fn row_ended(&self) {
        self.left.set(MAX_ROW_BYTES + 2 * BUFFER);
    }

    /// Whether the input's last byte ends a line.
    pub(super) fn ends_a_line(&self) -> bool {
        self.last.get() == b'\n'
    }

    /// What an error of the reader means.
    pub(super) fn error(&self, file: &str, line: u64, source: &io::Error) -> RecordingError {
        if self.exceeded.get() {
            return RecordingError::LongRow { file: file.to_owned(), line };
        }
        FileError::reading(file, source).into()
    }
}

/// A reader that fails when too many bytes come without the end of a row.
#[derive(Debug)]
pub(super) struct Limited<R> {
    inner: R,
    meter: Rc<Meter>,
}

impl<R: Read> Limited<R> {
    pub(super) fn new(inner: R) -> (Self, Rc<Meter>) {
        let meter = Rc::new(Meter::default());
        meter.row_ended();
        (Self { inner, meter: Rc::clone(&meter) }, meter)
    }
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        let Some(left) = self.meter.left.get().checked_sub(count) else {
            self.meter.exceeded.set(true);
            return Err(io::Error::other("a row without end"));
        };
        self.meter.left.set(left);
        if let Some(&last) = count.checked_sub(1).and_then(|at| buffer.get(at)) {
            self.meter.last.set(last);
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_without_end_fails_and_rows_that_end_do_not() {
        let (mut input, meter) = Limited::new(io::repeat(0));
        let read = input.read_to_end(&mut Vec::new());
        assert!(matches!(meter.error("a", 7, &read.unwrap_err()), RecordingError::LongRow { line: 7, .. }));
        let (mut input, meter) = Limited::new(io::repeat(b'\n'));
        let mut buffer = vec![0; BUFFER];
        for _ in 0..100 {
            input.read_exact(&mut buffer).unwrap();
            meter.row_ended();
        }
        assert!(meter.ends_a_line());
    }
}
