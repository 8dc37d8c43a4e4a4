//! Emergency stop and watchdog.

use super::registers::{psm, watchdog};
use super::stop;
use crate::board::pico2::constants::WATCHDOG_US;
use crate::board::{Protection, Trip};

/// What protects the machine.
pub struct Guard {
    watchdog_reset: bool,
}

impl Guard {
    /// Before anything else may reset the board.
    pub(super) fn new() -> Self {
        Self { watchdog_reset: watchdog().reason().read().timer().bit_is_set() }
    }
}

/// Starts the watchdog, once: from here on ticks must come.
pub(super) fn start_watchdog() {
    select_reset();
    feed();
    watchdog().ctrl().modify(|_, control| control.enable().set_bit());
}

/// What the watchdog resets: everything but the oscillators (RP2350, PSM, WDSEL). The pads with it, so that the bridge
/// is off.
pub(super) fn select_reset() {
    psm().wdsel().write(|domains| {
        // SAFETY: every domain; the next line takes two out.
        unsafe { domains.bits(0x01ff_ffff) };
        domains.rosc().clear_bit().xosc().clear_bit()
    });
}

/// A core halted by a debugger must not leave the motor driven, and the PWM goes on then. So while the bridge is
/// enabled the watchdog counts on and resets the board. While it is off, a breakpoint may last. No handler above the
/// tick writes this register but one that resets the board.
#[inline]
pub(super) fn pause_watchdog_in_debug(pause: bool) {
    watchdog().ctrl().modify(|_, control| {
        control.pause_dbg0().bit(pause).pause_dbg1().bit(pause);
        control.pause_jtag().bit(pause)
    });
}

#[inline]
fn feed() {
    // SAFETY: 24 bits, µs.
    watchdog().load().write(|left| unsafe { left.bits(WATCHDOG_US) });
}

impl Protection for Guard {
    fn tripped(&mut self) -> Option<Trip> {
        stop::take().then_some(Trip::EmergencyStop)
    }

    fn watchdog_reset(&self) -> bool {
        self.watchdog_reset
    }

    fn feed_watchdog(&mut self) {
        feed();
    }
}
