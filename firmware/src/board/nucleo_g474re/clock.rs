//! Microseconds, from TIM5.

use embassy_stm32::Peri;
use embassy_stm32::pac;
use embassy_stm32::peripherals::TIM5;
use embassy_stm32::timer::low_level::Timer;

use super::constants::{CLOCK_HZ, CORE_HZ};
use crate::board::Clock;

/// The free-running counter.
pub struct Microseconds(());

impl Microseconds {
    /// Starts it.
    pub fn start(timer: Peri<'static, TIM5>) -> Self {
        let timer = Timer::new(timer);
        pac::TIM5.psc().write_value((CORE_HZ / CLOCK_HZ - 1) as u16);
        pac::TIM5.arr().write_value(u32::MAX);
        // The prescaler is taken over by an update.
        pac::TIM5.egr().write(|events| events.set_ug(true));
        timer.start();
        // Runs until the next reset; dropped, it would be switched off.
        core::mem::forget(timer);
        Self(())
    }
}

impl Clock for Microseconds {
    fn now_us(&self) -> u32 {
        pac::TIM5.cnt().read()
    }
}
