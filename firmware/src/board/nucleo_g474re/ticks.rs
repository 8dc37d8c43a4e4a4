//! The tick's interrupt, from TIM6.

use core::sync::atomic::{AtomicPtr, Ordering};

use embassy_stm32::interrupt::{self, InterruptExt};
use embassy_stm32::pac;
use embassy_stm32::peripherals::TIM6;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::{RoundTo, Timer};

use super::BoardTick;
use super::constants::{TICK_HZ, TICK_PRIORITY};

/// The tick, once it runs; null before.
static TICK: AtomicPtr<BoardTick> = AtomicPtr::new(core::ptr::null_mut());

/// The timer of the ticks.
pub struct TickTimer(pub(super) Timer<'static, TIM6>);

impl TickTimer {
    /// Calls `tick` from the interrupt from now on.
    pub fn run(self, tick: &'static mut BoardTick) {
        TICK.store(tick, Ordering::Release);
        self.0.set_frequency(Hertz(TICK_HZ), RoundTo::Faster);
        self.0.clear_update_interrupt();
        self.0.enable_update_interrupt(true);
        interrupt::TIM6_DAC.set_priority(TICK_PRIORITY);
        // SAFETY: the handler is `on_tick`, and all it needs is in place.
        unsafe { interrupt::TIM6_DAC.enable() };
        self.0.start();
        // Runs until the next reset; dropped, it would be switched off.
        core::mem::forget(self);
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
