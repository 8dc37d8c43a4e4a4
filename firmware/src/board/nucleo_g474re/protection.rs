//! Break input and watchdog.

use embassy_stm32::pac;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

use super::bridge::take_break;
use super::constants::{SUPPLY_LEVEL, WATCHDOG_RELOAD};
use super::current::Current;
use super::over_current::OverCurrent;
use crate::board::{Protection, Trip};

/// What protects the machine.
pub struct Guard {
    watchdog_reset: bool,
    current: Option<(Current, OverCurrent)>,
}

/// What switches TIM1 off beside the pin, whatever the program does: the break of the system (RM0440, TIM1, using the break function).
/// Once; the clocks of SYSCFG and PWR are on.
pub(super) fn system_breaks() {
    // A crystal that stops: the clock security system. It also raises the NMI, whose handler resets (RM0440, RCC, CSS).
    pac::RCC.cr().modify(|clocks| clocks.set_csson(true));
    // The controller's supply (RM0440, PWR, programmable voltage detector).
    pac::PWR.cr2().modify(|detector| {
        detector.set_pls(SUPPLY_LEVEL);
        detector.set_pvde(true);
    });
    // A core that has locked up in its fault handler, and the supply (RM0440, SYSCFG_CFGR2). Both stay until the next reset. Not
    // the flash's double errors: the store reads what a power cut has left.
    pac::SYSCFG.cfgr2().modify(|breaks| {
        breaks.set_cll(true);
        breaks.set_pvdl(true);
    });
}

impl Guard {
    /// Starts the watchdog, once: from here on ticks must come.
    pub(super) fn start(current: Option<Current>) -> Self {
        let current = current.map(|current| {
            let over_current = OverCurrent::start(current.offset());
            (current, over_current)
        });
        let watchdog_reset = pac::RCC.csr().read().iwdgrstf();
        pac::RCC.csr().modify(|causes| causes.set_rmvf(true));
        pac::IWDG.kr().write(|key| key.set_key(Key::ENABLE));
        pac::IWDG.pr().write(|prescaler| prescaler.set_pr(Pr::DIVIDE_BY4));
        pac::IWDG.rlr().write(|reload| reload.set_rl(WATCHDOG_RELOAD));
        pac::IWDG.kr().write(|key| key.set_key(Key::START));
        Self { watchdog_reset, current }
    }
}

impl Protection for Guard {
    fn tripped(&mut self) -> Option<Trip> {
        take_break(self.current.as_ref().map_or(0, |(_, over_current)| over_current.level_ma()))
    }

    fn current_ma(&mut self) -> Option<i32> {
        self.current.as_mut()?.0.milliamperes()
    }

    fn limit_current(&mut self, limit_ma: u32) {
        if let Some((_, over_current)) = &mut self.current {
            over_current.set_limit(limit_ma);
        }
    }

    fn watchdog_reset(&self) -> bool {
        self.watchdog_reset
    }

    fn feed_watchdog(&mut self) {
        pac::IWDG.kr().write(|key| key.set_key(Key::RESET));
    }
}
