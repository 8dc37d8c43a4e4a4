//! The tick's interrupt, from TIM6.

use core::sync::atomic::{AtomicPtr, Ordering};

use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::pac;

use super::BoardTick;
use super::constants::{CORE_HZ, TICK_HZ, TICK_PRIORITY};

/// The tick, once it runs; null before.
static TICK: AtomicPtr<BoardTick> = AtomicPtr::new(core::ptr::null_mut());

/// The timer of the ticks.
pub struct TickTimer(pub(super) ());

impl TickTimer {
    /// Calls `tick` from the interrupt from now on.
    pub fn run(self, tick: &'static mut BoardTick) {
        TICK.store(tick, Ordering::Release);
        pac::TIM6.arr().write(|last| last.set_arr((CORE_HZ / TICK_HZ - 1) as u16));
        pac::TIM6.dier().write(|interrupts| interrupts.set_uie(true));
        interrupt::TIM6_DAC.set_priority(TICK_PRIORITY);
        // SAFETY: the handler is `on_tick`, and all it needs is in place.
        unsafe { interrupt::TIM6_DAC.enable() };
        pac::TIM6.cr1().write(|control| control.set_cen(true));
    }
}

/// What the interrupt handler of TIM6_DAC calls, and nobody else.
pub fn on_tick() {
    // The only flag there is.
    pac::TIM6.sr().write(|flags| flags.set_uif(false));
    let tick = TICK.load(Ordering::Acquire);
    // SAFETY: null, or from the `&'static mut` that `run` has consumed, so that nobody else has one; the handler does not
    // interrupt itself.
    if let Some(tick) = unsafe { tick.as_mut() } {
        tick.tick();
    }
}
