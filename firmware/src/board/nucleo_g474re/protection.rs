//! Break input and watchdog.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

use super::bridge::take_break;
use super::constants::{BREAK_NUMBER, WATCHDOG_RELOAD};
use crate::board::{Protection, Trip};

/// What protects the machine.
pub struct Guard {
    watchdog_reset: bool,
}

impl Guard {
    /// Starts the watchdog, once: from here on ticks must come.
    pub(super) fn start() -> Self {
        let watchdog_reset = pac::RCC.csr().read().iwdgrstf();
        pac::RCC.csr().modify(|causes| causes.set_rmvf(true));
        pac::IWDG.kr().write(|key| key.set_key(Key::ENABLE));
        pac::IWDG.pr().write(|prescaler| prescaler.set_pr(Pr::DIVIDE_BY4));
        pac::IWDG.rlr().write(|reload| reload.set_rl(WATCHDOG_RELOAD));
        pac::IWDG.kr().write(|key| key.set_key(Key::START));
        Self { watchdog_reset }
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
        pac::IWDG.kr().write(|key| key.set_key(Key::RESET));
    }
}
