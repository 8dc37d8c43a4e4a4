//! A flash of two pages whose power can be cut.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

/// Power for any number of bytes.
pub const ALWAYS: usize = usize::MAX;

/// Two pages of `PAGE` bytes that are programmed in words of 8, as the STM32G4's.
#[derive(Clone, Debug)]
pub struct Ram<const PAGE: usize> {
    /// The cells, 2·`PAGE` bytes.
    pub cells: Vec<u8>,
    /// For how many more bytes there is power.
    pub power: usize,
}

/// Power was cut.
#[derive(Clone, Copy, Debug)]
pub struct Cut;

impl NorFlashError for Cut {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const PAGE: usize> Ram<PAGE> {
    /// Cells as they are given, erased beyond.
    pub fn new(mut cells: Vec<u8>) -> Self {
        cells.resize(2 * PAGE, 0xff);
        Self { cells, power: ALWAYS }
    }

    /// Changes cells one after the other, as far as the power goes.
    fn change(&mut self, at: usize, to: impl ExactSizeIterator<Item = u8>) -> Result<(), Cut> {
        let length = to.len();
        let powered = length.min(self.power);
        self.cells[at..].iter_mut().zip(to).take(powered).for_each(|(cell, byte)| *cell = byte);
        if self.power != ALWAYS {
            self.power -= powered;
        }
        if powered == length { Ok(()) } else { Err(Cut) }
    }
}

impl<const PAGE: usize> ErrorType for &mut Ram<PAGE> {
    type Error = Cut;
}

impl<const PAGE: usize> ReadNorFlash for &mut Ram<PAGE> {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Cut> {
        bytes.copy_from_slice(&self.cells[offset as usize..][..bytes.len()]);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.cells.len()
    }
}

impl<const PAGE: usize> NorFlash for &mut Ram<PAGE> {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Cut> {
        self.change(from as usize, std::iter::repeat_n(0xff, (to - from) as usize))
    }

    /// # Panics
    /// Where a word is programmed twice between erases (RM0440: an error), or not in whole words.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Cut> {
        let at = offset as usize;
        assert!(at.is_multiple_of(8) && bytes.len().is_multiple_of(8), "{} bytes at {at}", bytes.len());
        let before = &self.cells[at..at + bytes.len()];
        assert!(before.iter().all(|cell| *cell == 0xff), "programmed twice at {at}");
        self.change(at, bytes.iter().copied())
    }
}
