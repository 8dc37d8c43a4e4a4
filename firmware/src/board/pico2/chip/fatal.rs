//! The end of a program that is broken.

use super::bridge::open_all_switches;
use super::protection::select_reset;
use super::registers::watchdog;
use super::retained::RetainedRam;
use crate::app::remember_panic;

// A stack that is full is a fault whose handler needs some of it: the limit is lifted first. What is below the stack is
// the program's memory, which is lost with the reset.
core::arch::global_asm!(
    ".section .text.HardFault, \"ax\", %progbits",
    ".global HardFault",
    ".type HardFault, %function",
    ".thumb_func",
    "HardFault:",
    "movs r0, #0",
    "msr msplim, r0",
    "b {give_up}",
    ".size HardFault, . - HardFault",
    ".text",
    give_up = sym give_up,
);

/// What a broken program does: off at once, then a reset, after which the fault is reported.
pub extern "C" fn give_up() -> ! {
    cortex_m::interrupt::disable();
    open_all_switches();
    remember_panic(&mut RetainedRam);
    restart()
}

/// Switches off, then resets.
pub fn reset() -> ! {
    cortex_m::interrupt::disable();
    open_all_switches();
    restart()
}

/// Resets the whole chip, by the watchdog: SYSRESETREQ would leave PWM and pins as they are.
fn restart() -> ! {
    select_reset();
    loop {
        watchdog().ctrl().write(|control| control.trigger().set_bit());
    }
}
