//! Settings and model in flash: with CRC and version, and never a silent guess.
//!
//! The store is our own: two pages that take turns. With `sequential-storage` and the HAL's flash driver the NUCLEO's
//! image was 8.6 KB larger. That driver is for many items that change often. Here is one record, which changes on
//! command.

mod flash;

pub use flash::FlashStore;

use breakaway_core::link::{FaultCause, Model, Settings};

/// Version of what is stored. Raised when [`Settings`] or [`Model`] change on the wire. (1 was another format, which reads as
/// damaged.)
pub const VERSION: u16 = 4;

/// What start-up found.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// Stored settings, or the defaults.
    pub settings: Settings,
    /// Stored model, if there was one.
    pub model: Option<Model>,
    /// What was lost: [`FaultCause::SettingsLost`] (then there is no model either: its units are the settings') or
    /// [`FaultCause::ModelLost`]. With it comes the version that was found, −1 where none could be read.
    pub lost: Option<(FaultCause, i32)>,
    /// The travel limits are saved ones, not the board's own: they count from a zero that is not known since the reset.
    pub zero_needed: bool,
}

impl Loaded {
    /// What a board that never saved anything starts with.
    #[must_use]
    pub fn defaults(settings: Settings) -> Self {
        Self { settings, model: None, lost: None, zero_needed: false }
    }
}

/// What could not be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoreError;

/// Where settings and model are kept.
pub trait Store {
    /// Keeps them.
    ///
    /// # Errors
    /// [`StoreError`]: what was kept before is still there.
    fn save(&mut self, settings: &Settings, model: Option<&Model>) -> Result<(), StoreError>;
}

/// Keeps nothing: for boards without flash to spare. Saving is an error, not a silent loss.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoStore;

impl Store for NoStore {
    fn save(&mut self, _: &Settings, _: Option<&Model>) -> Result<(), StoreError> {
        Err(StoreError)
    }
}

#[cfg(test)]
mod tests;
