//! Two pages of simulated flash. They are in PSRAM, which a reset leaves alone, and in a file of the host by
//! semihosting, where QEMU was given one (`-semihosting-config enable=on,target=native,arg=image,arg=FILE`).

use cortex_m_semihosting::{nr, syscall};
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use super::PSRAM;

/// Erase page, as the STM32G4's in dual-bank mode.
const PAGE: usize = 2048;
const SIZE: usize = 2 * PAGE;
/// Behind the retained words.
const IMAGE: usize = PSRAM + 0x1000;
/// In front of the image, once it has been read or erased since power-on.
const MARK: usize = IMAGE - 4;
const MARKED: u32 = 0x464c_4153;

/// Longest command line taken.
const COMMAND_LINE: usize = 256;

/// The simulated flash.
#[derive(Debug)]
pub struct SimulatedFlash {
    file: Option<usize>,
}

/// Out of bounds or not aligned.
#[derive(Clone, Copy, Debug)]
pub struct FlashError(NorFlashErrorKind);

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        self.0
    }
}

impl SimulatedFlash {
    /// Opens the file, and reads it on power-on; without a file the flash starts blank.
    ///
    /// `semihosting` says that QEMU was started with it: without, the call would be a fault of the processor.
    #[must_use]
    pub fn open(semihosting: bool) -> Self {
        let mut flash = Self { file: if semihosting { open_file() } else { None } };
        // SAFETY: a word of PSRAM that nothing else uses.
        let mark = MARK as *mut u32;
        if unsafe { mark.read_volatile() } != MARKED {
            flash.image().fill(0xff);
            flash.read_file();
            // SAFETY: as above.
            unsafe { mark.write_volatile(MARKED) };
        }
        flash
    }

    #[allow(clippy::unused_self, reason = "the borrow of the one driver is what makes the image its own")]
    fn image(&mut self) -> &mut [u8] {
        // SAFETY: SIZE bytes of PSRAM that only this driver uses, and there is one driver; any bytes are valid.
        unsafe { core::slice::from_raw_parts_mut(IMAGE as *mut u8, SIZE) }
    }

    /// `length` bytes from `offset`, both multiples of `unit`.
    fn cells(&mut self, offset: u32, length: usize, unit: usize) -> Result<&mut [u8], FlashError> {
        let start = offset as usize;
        if !(start.is_multiple_of(unit) && length.is_multiple_of(unit)) {
            return Err(FlashError(NorFlashErrorKind::NotAligned));
        }
        let cells = self.image().get_mut(start..start.saturating_add(length));
        cells.ok_or(FlashError(NorFlashErrorKind::OutOfBounds))
    }

    fn read_file(&mut self) {
        if let Some(file) = self.file {
            let image = self.image();
            // SAFETY: SYS_READ (Arm semihosting specification) of at most `image.len()` bytes into `image`. What a short
            // file leaves out stays blank.
            let _ = unsafe { syscall!(READ, file, image.as_mut_ptr(), image.len()) };
        }
    }

    fn write_file(&mut self) {
        if let Some(file) = self.file {
            let image = self.image();
            // SAFETY: SYS_SEEK to the start, and SYS_WRITE of `image`.
            let _ = unsafe { syscall!(SEEK, file, 0) };
            let _ = unsafe { syscall!(WRITE, file, image.as_ptr(), image.len()) };
            let _ = unsafe { syscall!(FLEN, file) };
        }
    }
}

/// The file named by the second word of the command line, for reading and writing.
fn open_file() -> Option<usize> {
    let mut line = [0_u8; COMMAND_LINE];
    let mut block = [line.as_mut_ptr() as usize, line.len()];
    // SAFETY: SYS_GET_CMDLINE writes at most `block[1]` bytes to `block[0]`, and the length.
    let failed = unsafe { cortex_m_semihosting::syscall1(nr::GET_CMDLINE, block.as_mut_ptr() as usize) };
    let line = line.get(..block[1]).filter(|_| failed == 0)?;
    let space = line.iter().position(|byte| *byte == b' ')?;
    let name = line.get(space + 1..)?;
    let mut path = [0_u8; COMMAND_LINE];
    path.get_mut(..name.len())?.copy_from_slice(name);
    let length = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
    // SAFETY: SYS_OPEN of a zero-terminated name. Mode 3 is "r+b": the file must be there.
    let file = unsafe { syscall!(OPEN, path.as_ptr(), 3, length) };
    (file != usize::MAX).then_some(file)
}

impl ErrorType for SimulatedFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SimulatedFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        bytes.copy_from_slice(self.cells(offset, bytes.len(), 1)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for SimulatedFlash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        self.cells(from, to.saturating_sub(from) as usize, PAGE)?.fill(0xff);
        self.write_file();
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        // Programming only clears bits.
        let cells = self.cells(offset, bytes.len(), Self::WRITE_SIZE)?;
        cells.iter_mut().zip(bytes).for_each(|(cell, byte)| *cell &= byte);
        self.write_file();
        Ok(())
    }
}
