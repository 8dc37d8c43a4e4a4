//! Break input and watchdog.

use embassy_stm32::pac;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;

use super::bridge::take_break;
use super::constants::BREAK_NUMBER;
use crate::board::{Protection, Trip};

/// What protects the machine.
pub struct Guard {
    watchdog: IndependentWatchdog<'static, IWDG>,
    watchdog_reset: bool,
}

impl Guard {
    /// Starts the watchdog: from here on ticks must come.
    pub fn start(mut watchdog: IndependentWatchdog<'static, IWDG>) -> Self {
        let watchdog_reset = pac::RCC.csr().read().iwdgrstf();
        pac::RCC.csr().modify(|causes| causes.set_rmvf(true));
        watchdog.unleash();
        Self { watchdog, watchdog_reset }
    }
}

impl Protection for Guard {
    fn tripped(&mut self) -> Option<Trip> {
        take_break().then_some(Trip::Break(BREAK_NUMBER))
    }

    fn watchdog_reset(&self) -> bool {
        self.watchdog_reset
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.pet();
    }
}
