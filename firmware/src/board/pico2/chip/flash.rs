//! Two sectors of the flash, for settings and model.
//!
//! The flash cannot be read while it is written, so nothing may be fetched from it then. Nothing ever is: the whole
//! program is in RAM (link.x). So ticks go on during a save, with no lock and the other core asleep. The boot ROM's
//! functions do the work (RP2350, boot ROM, low-level flash commands).

use core::ptr::read_volatile;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use rp235x_hal::rom_data::{
    connect_internal_flash, flash_enter_cmd_xip, flash_exit_xip, flash_flush_cache, flash_range_erase,
    flash_range_program,
};

use crate::board::pico2::constants::{SECTOR_BYTES, SETTINGS_AT, SETTINGS_BYTES};
use crate::board::pico2::pages::pages;

/// Where the flash is read (RP2350, address map, XIP), by a cache that is emptied after each change.
const FLASH: u32 = 0x1000_0000;
/// Bytes of a record's word; a flash without error correction may be programmed in any.
const WORD: usize = 8;
/// No erase command beside that of a sector: a block as large as the whole address space is never used.
const NO_BLOCK: (u32, u8) = (1 << 31, 0);

/// Two sectors of flash; offsets from their start.
pub struct SettingsFlash(());

/// Why the flash refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Outside of the two sectors.
    OutOfBounds,
    /// Not whole sectors, or not whole words of 8 bytes.
    NotAligned,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::NotAligned => NorFlashErrorKind::NotAligned,
        }
    }
}

impl SettingsFlash {
    /// Takes the flash; once.
    pub(super) fn new() -> Self {
        Self(())
    }
}

/// Where `length` bytes at `offset` of the settings are in the flash, both multiples of `unit`.
fn place(offset: u32, length: usize, unit: usize) -> Result<u32, FlashError> {
    let end = u32::try_from(length).ok().and_then(|length| offset.checked_add(length));
    if end.is_none_or(|end| end > SETTINGS_BYTES) {
        Err(FlashError::OutOfBounds)
    } else if !((offset as usize).is_multiple_of(unit) && length.is_multiple_of(unit)) {
        Err(FlashError::NotAligned)
    } else {
        Ok(SETTINGS_AT + offset)
    }
}

/// Has the boot ROM work on the flash, in between leaving the mode in which it is read and taking it up again.
fn change(work: impl FnOnce()) {
    // SAFETY: nothing is fetched or read from the flash meanwhile: program, constants and vectors are in RAM, and this is
    // the only driver.
    unsafe {
        connect_internal_flash();
        flash_exit_xip();
        work();
        flash_flush_cache();
        flash_enter_cmd_xip();
    }
}

impl ErrorType for SettingsFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SettingsFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = FLASH + place(offset, bytes.len(), Self::READ_SIZE)?;
        for (at, byte) in (from..).zip(bytes) {
            // SAFETY: inside the two sectors. Volatile, as a write changes what is read.
            *byte = unsafe { read_volatile(at as *const u8) };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        SETTINGS_BYTES as usize
    }
}

impl NorFlash for SettingsFlash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.saturating_sub(from) as usize;
        let at = place(from, length, Self::ERASE_SIZE)?;
        let (block, command) = NO_BLOCK;
        // SAFETY: whole sectors of the settings.
        change(|| unsafe { flash_range_erase(at, length, block, command) });
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let at = place(offset, bytes.len(), WORD)?;
        change(|| {
            for (start, page) in pages(at, bytes) {
                // SAFETY: a whole page of the settings, as they start on one; what is not to be changed is all ones.
                unsafe { flash_range_program(start, page.as_ptr(), page.len()) };
            }
        });
        Ok(())
    }
}
