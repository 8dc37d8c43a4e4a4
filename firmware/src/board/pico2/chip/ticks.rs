//! The tick's interrupt, from a PWM slice that has no pins. It starts with the bridge's slice, and a tick takes two of
//! that one's periods. The bridge takes over what a tick sets at the end of the first, 50 µs after the tick's start.

use core::sync::atomic::{AtomicPtr, Ordering};

use cortex_m::peripheral::NVIC;
use rp235x_hal::pac::Interrupt;

use super::protection::start_watchdog;
use super::registers::pwm;
use crate::board::pico2::constants::{PWM_SLICE, STOP_PRIORITY, TICK_COUNTS, TICK_PRIORITY, TICK_SLICE};

/// Where the interrupt finds its tick, a `T`: a static of the image, beside the handler.
pub struct TickSlot<T>(AtomicPtr<T>);

impl<T> TickSlot<T> {
    /// Nothing to be called yet.
    pub const fn empty() -> Self {
        Self(AtomicPtr::new(core::ptr::null_mut()))
    }

    /// What the interrupt handler of PWM_IRQ_WRAP_0 calls, and nobody else: `tick` with the `T`, once there is one.
    pub fn on_interrupt(&self, tick: impl FnOnce(&mut T)) {
        // SAFETY: writing 1 clears the flag of a slice.
        pwm().intr().write(|flags| unsafe { flags.bits(1 << TICK_SLICE) });
        let slot = self.0.load(Ordering::Acquire);
        // SAFETY: null, or from the `&'static mut` that `TickTimer::run` has consumed, so that nobody else has one; the
        // handler does not interrupt itself.
        if let Some(found) = unsafe { slot.as_mut() } {
            tick(found);
        }
    }
}

/// The timer of the ticks, and the two interrupts.
pub struct TickTimer(pub(super) NVIC);

impl TickTimer {
    /// Hands `tick` to the interrupt by its `slot`, and lets it come from now on. The watchdog counts from here.
    pub fn run<T: Send>(self, slot: &'static TickSlot<T>, tick: &'static mut T) {
        let Self(mut nvic) = self;
        slot.0.store(tick, Ordering::Release);
        // SAFETY: any 16 bits are a top; bits of slices; the handlers call `on_interrupt` and `on_stop`, and all they need
        // is in place. The priorities break no lock: none is taken by priority.
        unsafe {
            pwm().ch(TICK_SLICE).top().write(|top| top.top().bits(TICK_COUNTS - 1));
            pwm().irq0_inte().write(|slices| slices.bits(1 << TICK_SLICE));
            nvic.set_priority(Interrupt::IO_IRQ_BANK0, STOP_PRIORITY);
            nvic.set_priority(Interrupt::PWM_IRQ_WRAP_0, TICK_PRIORITY);
            NVIC::unmask(Interrupt::IO_IRQ_BANK0);
            NVIC::unmask(Interrupt::PWM_IRQ_WRAP_0);
            start_watchdog();
            // Both at the same clock.
            pwm().en().write(|slices| slices.bits(1 << PWM_SLICE | 1 << TICK_SLICE));
        }
    }
}
