//! The end of a program: by command, or because it is broken.

use super::bridge::open_all_switches;
use super::protection::select_reset;
use super::registers::watchdog;

/// Switches off, at once.
pub fn switch_off() {
    cortex_m::interrupt::disable();
    open_all_switches();
}

/// Resets the whole chip, PWM and pins with it, by the watchdog: SYSRESETREQ is a warm reset of the core.
pub fn reset() -> ! {
    switch_off();
    select_reset();
    loop {
        watchdog().ctrl().write(|control| control.trigger().set_bit());
    }
}
