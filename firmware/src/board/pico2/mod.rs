//! Raspberry Pi Pico 2 with a DRV8871-class bridge and a quadrature encoder: docs/board-pico2.md.
//!
//! What needs no registers builds for every target and is tested on the host. These are the constants, the encoder's
//! program, the levels of the bridge's inputs, and the pages of the flash. The registers are in `chip`.

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "registers, interrupt and retained RAM of the board")]
mod chip;
pub mod constants;
pub mod levels;
pub mod pages;
pub mod program;

#[cfg(target_os = "none")]
pub use chip::*;

use breakaway_core::link::Settings;

/// What a board that never saved anything starts with. Encoder and axis are their owner's: `breakaway device` sets them.
#[must_use]
pub fn defaults() -> Settings {
    Settings { drive_full_scale: constants::SUPPLY_V, ..Settings::default() }
}

#[cfg(test)]
mod tests {
    use super::defaults;

    /// They can be saved and loaded, they ask for no current that nothing measures, and the bridge bears the supply (DRV8871,
    /// recommended operating conditions).
    #[test]
    fn the_defaults_are_settings_that_the_board_takes() {
        let defaults = defaults();
        assert_eq!(defaults.validate(), Ok(()));
        assert_eq!(defaults.current_max_ma, 0);
        assert!((6.5..=45.0).contains(&defaults.drive_full_scale));
    }
}
