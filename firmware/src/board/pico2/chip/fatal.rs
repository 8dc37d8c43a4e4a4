//! The end of a program: by command, or because it is broken.

use super::bridge::open_all_switches;
use super::protection::select_reset;
use super::registers::watchdog;

/// Switches off, at once.
pub fn switch_off() {
    cortex_m::interrupt::disable();
    open_all_switches();
}

/// Resets the whole chip, by the watchdog: SYSRESETREQ would leave PWM and pins as they are.
pub fn reset() -> ! {
    switch_off();
    select_reset();
    loop {
        watchdog().ctrl().write(|control| control.trigger().set_bit());
    }
}
