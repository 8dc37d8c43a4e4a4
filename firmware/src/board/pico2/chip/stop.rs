//! The emergency stop. The PWM of the RP2350 has no break input. So an interrupt above all others holds both inputs of
//! the bridge low, as the hardware does on the NUCLEO. The tick sees the pin as well, 100 µs later at the most, and
//! latches the fault.

use core::sync::atomic::{AtomicBool, Ordering};

use super::bridge::open_all_switches;
use super::pins::{self, Function, Pull};
use super::registers::io;
use crate::board::pico2::constants::STOP_PIN;

/// The stop was pressed, since this was last taken.
static PRESSED: AtomicBool = AtomicBool::new(false);

/// Eight pins to a register of interrupts, four bits each; the last is the rising edge (RP2350, IO_BANK0, INTR0).
const REGISTER: usize = STOP_PIN / 8;
const RISING: u32 = 1 << (STOP_PIN % 8 * 4 + 3);

/// Sets up the pin, and lets its edge interrupt once the interrupt is enabled. The tick finds out about a level.
pub(super) fn watch() {
    pins::connect(STOP_PIN, Function::Sio, Pull::Up);
    acknowledge();
    // SAFETY: the bit of this edge alone.
    io().proc0_inte(REGISTER).write(|edges| unsafe { edges.bits(RISING) });
}

/// What the interrupt handler of IO_IRQ_BANK0 calls, and nobody else.
#[inline]
pub fn on_stop() {
    open_all_switches();
    PRESSED.store(true, Ordering::Release);
    acknowledge();
}

/// Whether the stop is pressed now, or was since it was last taken.
#[inline]
pub(super) fn is_stopped() -> bool {
    PRESSED.load(Ordering::Acquire) || pins::is_high(STOP_PIN)
}

/// The same, and forgets what was. A press after the first line is seen by the pin, or by its own interrupt.
#[inline]
pub(super) fn take() -> bool {
    let pressed = PRESSED.load(Ordering::Acquire);
    PRESSED.store(false, Ordering::Release);
    pressed || pins::is_high(STOP_PIN)
}

#[inline]
fn acknowledge() {
    // SAFETY: writing 1 clears the latched edge, writing 0 changes nothing.
    io().intr(REGISTER).write(|edges| unsafe { edges.bits(RISING) });
}
