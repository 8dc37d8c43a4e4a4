//! The last two pages of the flash, for settings and model.

use embassy_stm32::flash::{Async, Error, Flash};
use embassy_stm32::pac;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};

use super::constants::{SETTINGS_AT, SETTINGS_BYTES};

/// Two pages of flash; offsets from their start.
pub struct SettingsFlash {
    flash: Flash<'static, Async>,
    dual_bank: bool,
}

/// Why the flash refuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Outside of the two pages.
    OutOfBounds,
    /// The option bytes make one bank of the two (DBANK = 0): other pages, and a save would hold up the tick.
    SingleBank,
    /// The hardware's.
    Hardware(Error),
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
            Self::Hardware(Error::Unaligned) => NorFlashErrorKind::NotAligned,
            Self::SingleBank | Self::Hardware(_) => NorFlashErrorKind::Other,
        }
    }
}

impl SettingsFlash {
    /// Takes the flash.
    pub fn new(flash: Flash<'static, Async>) -> Self {
        Self { flash, dual_bank: pac::FLASH.optr().read().dbank() }
    }

    /// The hardware's offset of `length` bytes at `offset` of the settings. Alignment is checked by the driver.
    fn place(&self, offset: u32, length: usize) -> Result<u32, FlashError> {
        let end = u32::try_from(length).ok().and_then(|length| offset.checked_add(length));
        match (self.dual_bank, end) {
            (false, _) => Err(FlashError::SingleBank),
            (true, Some(..=SETTINGS_BYTES)) => Ok(SETTINGS_AT + offset),
            (true, _) => Err(FlashError::OutOfBounds),
        }
    }
}

/// After a power cut while writing, reading the word that was being written is an NMI of the flash's error correction
/// (RM0440): acknowledged here; what was read is then for the items' CRC to reject. `false` if this was not the cause.
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

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let place = self.place(offset, bytes.len())?;
        self.flash.blocking_read(place, bytes).map_err(FlashError::Hardware)
    }

    fn capacity(&self) -> usize {
        SETTINGS_BYTES as usize
    }
}

impl NorFlash for SettingsFlash {
    const WRITE_SIZE: usize = <Flash<'static, Async> as NorFlash>::WRITE_SIZE;
    const ERASE_SIZE: usize = <Flash<'static, Async> as NorFlash>::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.saturating_sub(from);
        let place = self.place(from, length as usize)?;
        self.flash.erase(place, place + length).await.map_err(FlashError::Hardware)
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let place = self.place(offset, bytes.len())?;
        self.flash.write(place, bytes).await.map_err(FlashError::Hardware)
    }
}
