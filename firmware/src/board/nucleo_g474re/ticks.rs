//! The tick's interrupt, from TIM6.

use core::sync::atomic::{AtomicPtr, Ordering};

use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::pac;

use super::constants::{CORE_HZ, TICK_HZ, TICK_PRIORITY};
use super::current::wait_for_sample;

/// Where the interrupt finds its tick, a `T`: a static of the image, beside the handler.
pub struct TickSlot<T>(AtomicPtr<T>);

impl<T> TickSlot<T> {
    /// Nothing to be called yet.
    pub const fn empty() -> Self {
        Self(AtomicPtr::new(core::ptr::null_mut()))
    }

    /// What the interrupt handler of TIM6_DAC calls, and nobody else: `tick` with the `T`, once there is one.
    pub fn on_interrupt(&self, tick: impl FnOnce(&mut T)) {
        // The only flag there is.
        pac::TIM6.sr().write(|flags| flags.set_uif(false));
        let slot = self.0.load(Ordering::Acquire);
        // SAFETY: null, or from the `&'static mut` that `TickTimer::run` has consumed, so that nobody else has one; the
        // handler does not interrupt itself.
        if let Some(found) = unsafe { slot.as_mut() } {
            tick(found);
        }
    }
}

/// The timer of the ticks.
pub struct TickTimer(pub(super) ());

impl TickTimer {
    /// Hands `tick` to the interrupt by its `slot`, and lets it come from now on.
    pub fn run<T: Send>(self, slot: &'static TickSlot<T>, tick: &'static mut T) {
        slot.0.store(tick, Ordering::Release);
        pac::TIM6.arr().write(|last| last.set_arr((CORE_HZ / TICK_HZ - 1) as u16));
        pac::TIM6.dier().write(|interrupts| interrupts.set_uie(true));
        interrupt::TIM6_DAC.set_priority(TICK_PRIORITY);
        // SAFETY: the handler calls `on_interrupt`, and all it needs is in place.
        unsafe { interrupt::TIM6_DAC.enable() };
        // Each tick comes just after a sample of the current: a tick is two whole periods of the PWM.
        let _ = wait_for_sample();
        pac::TIM6.cr1().write(|control| control.set_cen(true));
    }
}
