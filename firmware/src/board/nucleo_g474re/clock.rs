//! Microseconds, from TIM5.

use embassy_stm32::pac;

use super::constants::{CLOCK_HZ, CORE_HZ};
use crate::board::Clock;

/// The free-running counter.
pub struct Microseconds(());

impl Microseconds {
    /// Starts it; once. TIM5 has its clock.
    pub(super) fn start() -> Self {
        pac::TIM5.psc().write_value((CORE_HZ / CLOCK_HZ - 1) as u16);
        pac::TIM5.arr().write_value(u32::MAX);
        // The prescaler is taken over by an update.
        pac::TIM5.egr().write(|events| events.set_ug(true));
        pac::TIM5.cr1().write(|control| control.set_cen(true));
        Self(())
    }
}

impl Clock for Microseconds {
    fn now_us(&self) -> u32 {
        pac::TIM5.cnt().read()
    }
}
