//! The last two pages of the flash, for settings and model.
//!
//! On the registers, by RM0440 (embedded flash memory: page erase and programming sequences), for two pages of one bank.

use core::ptr::{read_volatile, write_volatile};

use embassy_stm32::pac;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use super::constants::{SETTINGS_AT, SETTINGS_BYTES, SETTINGS_PAGE, SETTINGS_PAGE_BYTES};

/// Where the flash is in memory.
const FLASH: u32 = 0x0800_0000;
/// Bytes programmed at once.
const WORD: usize = 8;

/// Two pages of flash; offsets from their start.
pub struct SettingsFlash(());

/// Why the flash refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Outside of the two pages.
    OutOfBounds,
    /// Not whole pages, or not whole words of 8 bytes.
    NotAligned,
    /// The option bytes make one bank of the two (DBANK = 0): other pages, and a save would hold up the tick.
    SingleBank,
    /// The hardware: programming over what is not erased, or a protected page.
    Hardware,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::NotAligned => NorFlashErrorKind::NotAligned,
            Self::SingleBank | Self::Hardware => NorFlashErrorKind::Other,
        }
    }
}

impl SettingsFlash {
    /// Takes the flash; once.
    pub(super) fn new() -> Self {
        Self(())
    }
}

/// The address of `length` bytes at `offset` of the settings, both multiples of `unit`.
#[inline(never)]
fn place(offset: u32, length: usize, unit: usize) -> Result<u32, FlashError> {
    let end = u32::try_from(length).ok().and_then(|length| offset.checked_add(length));
    if !pac::FLASH.optr().read().dbank() {
        Err(FlashError::SingleBank)
    } else if end.is_none_or(|end| end > SETTINGS_BYTES) {
        Err(FlashError::OutOfBounds)
    } else if !((offset as usize).is_multiple_of(unit) && length.is_multiple_of(unit)) {
        Err(FlashError::NotAligned)
    } else {
        Ok(FLASH + SETTINGS_AT + offset)
    }
}

/// Unlocked, with the data cache off: it may be corrupted while one bank is read and the other written (errata ES0430). Both
/// are put back when it is dropped.
struct Unlocked;

impl Unlocked {
    fn begin() -> Self {
        while pac::FLASH.sr().read().bsy() {}
        if pac::FLASH.cr().read().lock() {
            pac::FLASH.keyr().write_value(0x4567_0123);
            pac::FLASH.keyr().write_value(0xcdef_89ab);
        }
        pac::FLASH.acr().modify(|access| access.set_dcen(false));
        // Errors from before: each flag is cleared by writing 1.
        pac::FLASH.sr().modify(|_| {});
        Self
    }

    /// Waits for the end of what was started.
    fn finish() -> Result<(), FlashError> {
        loop {
            let status = pac::FLASH.sr().read();
            if !status.bsy() {
                let failed = status.operr()
                    || status.progerr()
                    || status.wrperr()
                    || status.pgaerr()
                    || status.sizerr()
                    || status.pgserr();
                return if failed { Err(FlashError::Hardware) } else { Ok(()) };
            }
        }
    }
}

impl Drop for Unlocked {
    fn drop(&mut self) {
        // Nothing but the lock: no programming, no page erase.
        pac::FLASH.cr().write(|control| control.set_lock(true));
        pac::FLASH.acr().modify(|access| access.set_dcrst(true));
        pac::FLASH.acr().modify(|access| access.set_dcrst(false));
        pac::FLASH.acr().modify(|access| access.set_dcen(true));
    }
}

/// After a power cut while writing, reading the word that was being written is an NMI of the flash's error correction
/// (RM0440). It is acknowledged here. The record's CRC then rejects the word. `false` if this was not the cause.
pub fn acknowledge_ecc() -> bool {
    let status = pac::FLASH.eccr().read();
    let uncorrected = status.eccd() || status.eccd2();
    // The flags are cleared by writing 1.
    pac::FLASH.eccr().write_value(status);
    uncorrected
}

impl ErrorType for SettingsFlash {
    type Error = FlashError;
}

impl ReadNorFlash for SettingsFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let from = place(offset, bytes.len(), Self::READ_SIZE)?;
        for (at, byte) in (from..).zip(bytes) {
            // SAFETY: inside the two pages, which no program is in. Volatile, as a write changes what is read.
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
    const ERASE_SIZE: usize = SETTINGS_PAGE_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        place(from, to.saturating_sub(from) as usize, Self::ERASE_SIZE)?;
        let _unlocked = Unlocked::begin();
        for page in from / SETTINGS_PAGE_BYTES..to / SETTINGS_PAGE_BYTES {
            pac::FLASH.cr().write(|control| {
                control.set_per(true);
                control.set_bker(true);
                control.set_pnb(SETTINGS_PAGE + page as u8);
                control.set_strt(true);
            });
            Unlocked::finish()?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let start = place(offset, bytes.len(), WORD)?;
        let _unlocked = Unlocked::begin();
        pac::FLASH.cr().write(|control| control.set_pg(true));
        let (words, _) = bytes.as_chunks::<4>();
        for (at, word) in (start..).step_by(4).zip(words) {
            // SAFETY: inside the two pages, which no program is in; aligned, as `offset` is.
            unsafe { write_volatile(at as *mut u32, u32::from_le_bytes(*word)) };
            // The second half starts the programming.
            if at % WORD as u32 != 0 {
                Unlocked::finish()?;
            }
        }
        Ok(())
    }
}
