//! A full bridge on TIM1: two half bridges, each with complementary inputs and dead time, made into the inputs of a
//! [`SignMagnitude`] drive.
//!
//! A positive drive switches leg A and holds leg B low; a negative one the other way round. No duty holds both low,
//! which brakes. Off opens all four switches. The registers are written without the HAL, whose checks could panic in
//! the tick.

use core::convert::Infallible;
use core::sync::atomic::{AtomicBool, Ordering};

use embassy_stm32::gpio::Output;
use embassy_stm32::pac;
use embassy_stm32::pac::timer::vals::{Bkp, Cms, Mms2, Ocm, Ossi, Ossr};
use embedded_hal::digital::{self, OutputPin, PinState};
use embedded_hal::pwm::{self, SetDutyCycle};

use super::constants::{
    BREAK_FILTER, BREAK_LEVEL, BREAK_PIN, CURRENT_TRIGGER, DEAD_TIME_CODE, DEAD_TIME_COUNTS, DRIVE_MAX_CODE,
    OVER_CURRENT_FILTER, PWM_COUNTS, SYSTEM_BREAK,
};
use crate::board::{Limits, SignMagnitude, Trip};

/// The bits of TIM1_SR that are flags (RM0440).
const FLAGS: u32 = 0x00f3_3fff;

/// The power stage.
pub type Bridge = SignMagnitude<Magnitude, Direction, Enable>;

/// Leg A drives. Written and read by the tick only.
static POSITIVE: AtomicBool = AtomicBool::new(true);

/// The duty cycle of the leg that drives.
pub struct Magnitude;

/// Which leg drives.
pub struct Direction;

/// All four switches, and the power stage's own enable input.
pub struct Enable {
    input: Output<'static>,
    lamp: Output<'static>,
}

/// Sets up the timer's outputs, off; `input` is the power stage's enable input, `lamp` shows that it is on. TIM1 has its clock and
/// its pins; once.
///
/// # Panics
/// If the constants do not fit each other, on the first start with them.
pub(super) fn bridge(input: Output<'static>, lamp: Output<'static>) -> Bridge {
    let timer = pac::TIM1;
    timer.arr().write(|last| last.set_arr(PWM_COUNTS));
    timer.ccmr_output(0).write(|outputs| {
        for leg in [0, 1] {
            outputs.set_ocm(leg, Ocm::PWM_MODE1);
            outputs.set_ocpe(leg, true);
        }
    });
    // Channel 4 has no pin: its rise starts the ADC.
    timer.ccmr_output(1).write(|outputs| outputs.set_ocm(1, Ocm::PWM_MODE1));
    timer.ccr(3).write(|compare| compare.set_ccr(CURRENT_TRIGGER));
    timer.cr2().write(|control| control.set_mms2(Mms2::COMPARE_OC4));
    timer.ccer().write(|outputs| {
        for leg in [0, 1] {
            outputs.set_cce(leg, true);
            outputs.set_ccne(leg, true);
        }
    });
    // The pin; the breaks of the system come beside it (`system_breaks`).
    timer.af1().write(|breaks| breaks.set_bkine(true));
    // The second break has no pin; the comparators come to it where the current is measured (`over_current.rs`).
    timer.af2().write(|_| {});
    // MOE = 0: off. Off means driven to the inactive level, not left floating: then all outputs are low (the reset value of
    // OISx and OISxN). AOE = 0: nothing comes on by itself.
    timer.bdtr().write(|break_and_dead_time| {
        break_and_dead_time.set_dtg(DEAD_TIME_CODE);
        break_and_dead_time.set_ossi(Ossi::IDLE_LEVEL);
        break_and_dead_time.set_ossr(Ossr::IDLE_LEVEL);
        break_and_dead_time.set_bkp(0, BREAK_LEVEL);
        break_and_dead_time.set_bkf(0, BREAK_FILTER);
        break_and_dead_time.set_bke(0, true);
        // Whatever the pin's level, a comparator's is high.
        break_and_dead_time.set_bkp(1, Bkp::ACTIVE_HIGH);
        break_and_dead_time.set_bkf(1, OVER_CURRENT_FILTER);
        break_and_dead_time.set_bke(1, true);
    });
    timer.cr1().write(|control| {
        control.set_cms(Cms::CENTER_ALIGNED3);
        control.set_arpe(true);
    });
    // Period and duty (0) are taken over by an update.
    timer.egr().write(|events| events.set_ug(true));
    timer.cr1().modify(|control| control.set_cen(true));
    let limits = Limits { code: DRIVE_MAX_CODE, dead_time: DEAD_TIME_COUNTS, brakes: true };
    let Ok(bridge) = SignMagnitude::new(Magnitude, Direction, Enable { input, lamp }, limits) else {
        panic!("the drive's constants do not fit each other");
    };
    bridge
}

/// Opens all four switches, from wherever the program is.
pub fn open_all_switches() {
    pac::TIM1.bdtr().modify(|break_and_dead_time| break_and_dead_time.set_moe(false));
}

/// Flag of the second break (RM0440, TIM1_SR, B2IF); the crate of the registers does not name it.
const SECOND_BREAK: u32 = 1 << 8;

/// What has switched TIM1 off since it was last asked, or does so now. It is the pin, a break of the system, or an
/// over-current above `level_ma`.
pub fn take_break(level_ma: u32) -> Option<Trip> {
    let flags = pac::TIM1.sr().read();
    let (pin, system, current) = (flags.bif(0), flags.sbif(), flags.0 & SECOND_BREAK != 0);
    if pin || system || current {
        // All flags but these keep their value when 1 is written; what is no flag takes 0. One is set again at once while its
        // cause lasts.
        pac::TIM1.sr().write(|flags| {
            flags.0 = FLAGS & !SECOND_BREAK;
            flags.set_bif(0, false);
            flags.set_sbif(false);
        });
    }
    match (system, current) {
        (true, _) => Some(SYSTEM_BREAK),
        (_, true) => Some(Trip::OverCurrent(level_ma)),
        _ => pin.then_some(BREAK_PIN),
    }
}

impl pwm::ErrorType for Magnitude {
    type Error = Infallible;
}

impl SetDutyCycle for Magnitude {
    fn max_duty_cycle(&self) -> u16 {
        PWM_COUNTS
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        let (a, b) = if POSITIVE.load(Ordering::Relaxed) { (duty, 0) } else { (0, duty) };
        pac::TIM1.ccr(0).write(|compare| compare.set_ccr(a));
        pac::TIM1.ccr(1).write(|compare| compare.set_ccr(b));
        Ok(())
    }
}

impl digital::ErrorType for Direction {
    type Error = Infallible;
}

impl OutputPin for Direction {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set_state(PinState::Low)
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set_state(PinState::High)
    }

    fn set_state(&mut self, state: PinState) -> Result<(), Infallible> {
        POSITIVE.store(state == PinState::High, Ordering::Relaxed);
        Ok(())
    }
}

impl digital::ErrorType for Enable {
    type Error = Infallible;
}

impl OutputPin for Enable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        open_all_switches();
        self.input.set_low();
        self.lamp.set_low();
        Ok(())
    }

    /// While the break input is active the timer keeps its outputs off, whatever the command is. The tick sees that
    /// by [`take_break`], which is why a trip from before is forgotten here.
    fn set_high(&mut self) -> Result<(), Infallible> {
        take_break(0);
        pac::TIM1.bdtr().modify(|break_and_dead_time| break_and_dead_time.set_moe(true));
        self.input.set_high();
        self.lamp.set_high();
        Ok(())
    }
}
