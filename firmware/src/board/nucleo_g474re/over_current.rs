//! Over-current: two comparators open the bridge without the program (RM0440, COMP, DAC; TIM1, using the break function).
//!
//! COMP3 sees a current above the level one way, COMP1 one below it the other way. Both act on TIM1's second break input,
//! which has a flag of its own: an over-current is not taken for the emergency stop.

use embassy_stm32::pac;
use embassy_stm32::pac::comp::vals::{Hysteresis, Inm, Polarity};
use embassy_stm32::pac::dac::Dac;
use embassy_stm32::pac::dac::vals::Mode;

use super::constants::{CORE_HZ, CURRENT_RANGE_CODES, CURRENT_RANGE_MA, MA_PER_CODE_Q16, TRIP_PERCENT};

/// The DAC's interface above 160 MHz (RM0440, DAC_MCR, HFSEL).
const ABOVE_160_MHZ: u8 = 0b10;
/// DAC and comparator are up to speed after so many µs (DS12288: 8 and 5).
const START_UP_US: u32 = 10;

/// The comparators, and the level that they have.
pub struct OverCurrent {
    offset: u16,
    level_ma: u32,
}

impl OverCurrent {
    /// Sets both up around the code that no current makes; once. TIM1's outputs are off, and the clocks are on. Nothing can change
    /// the comparators before the next reset.
    pub(super) fn start(offset: u16) -> Self {
        let mut over_current = Self { offset, level_ma: 0 };
        for dac in [pac::DAC3, pac::DAC1] {
            dac.mcr().write(|mode| {
                mode.set_hfsel(ABOVE_160_MHZ);
                // To the comparator alone; the pin of DAC1 stays free.
                mode.set_mode(0, Mode::NORMAL_INT_BUFDIS);
            });
            dac.cr().write(|control| control.set_en(0, true));
        }
        over_current.set_limit(0);
        cortex_m::asm::delay(START_UP_US * (CORE_HZ / 1_000_000));
        // PC1 against DAC3; PB1 against DAC1, high while the pin is below (RM0440, COMP, input assignment).
        pac::COMP3.csr().write(|comparator| {
            comparator.set_inmsel(Inm::DACA);
            comparator.set_inpsel(true);
            comparator.set_hyst(Hysteresis::HYST10M);
            comparator.set_en(true);
        });
        pac::COMP1.csr().write(|comparator| {
            comparator.set_inmsel(Inm::DACB);
            comparator.set_inpsel(true);
            comparator.set_polarity(Polarity::INVERTED);
            comparator.set_hyst(Hysteresis::HYST10M);
            comparator.set_en(true);
        });
        cortex_m::asm::delay(START_UP_US * (CORE_HZ / 1_000_000));
        for comparator in [pac::COMP3, pac::COMP1] {
            comparator.csr().modify(|comparator| comparator.set_lock(true));
        }
        pac::TIM1.af2().write(|breaks| {
            for comparator in [0, 2] {
                breaks.set_bk2cmpe(comparator, true);
            }
        });
        over_current
    }

    /// The level at which the bridge opens: [`TRIP_PERCENT`] of the limit, or all that is measured.
    pub(super) fn set_limit(&mut self, limit_ma: u32) {
        let above = limit_ma.saturating_mul(TRIP_PERCENT) / 100;
        self.level_ma = if limit_ma == 0 { CURRENT_RANGE_MA } else { above.min(CURRENT_RANGE_MA) };
        // Below 2¹², as the range is.
        let codes = ((self.level_ma << 16) / MA_PER_CODE_Q16.unsigned_abs()).min(CURRENT_RANGE_CODES) as u16;
        let set = |dac: Dac, level: u16| dac.dhr12r(0).write(|data| data.set_dhr(level));
        set(pac::DAC3, self.offset.saturating_add(codes));
        set(pac::DAC1, self.offset.saturating_sub(codes));
    }

    /// That level, mA.
    pub(super) fn level_ma(&self) -> u32 {
        self.level_ma
    }
}
