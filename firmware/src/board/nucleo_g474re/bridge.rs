//! A full bridge on TIM1: two half bridges, each with complementary inputs and dead time, made into the inputs of a
//! [`SignMagnitude`] drive.
//!
//! A positive drive switches leg A and holds leg B low; a negative one the other way round; off opens all four switches.
//! The registers are written without the HAL, whose checks could panic in the tick.

use core::convert::Infallible;
use core::sync::atomic::{AtomicBool, Ordering};

use embassy_stm32::gpio::Output;
use embassy_stm32::pac;
use embassy_stm32::peripherals::TIM1;
use embassy_stm32::timer::Channel;
use embassy_stm32::timer::complementary_pwm::{ComplementaryPwm, Ossi, Ossr};
use embedded_hal::digital::{self, OutputPin, PinState};
use embedded_hal::pwm::{self, SetDutyCycle};

use super::constants::{BREAK_FILTER, BREAK_LEVEL, DEAD_TIME_CLOCKS, DEAD_TIME_COUNTS, DRIVE_MAX_CODE};
use crate::board::{Limits, SignMagnitude};

/// The power stage.
pub type Bridge = SignMagnitude<Magnitude, Direction, Enable>;

/// Leg A drives. Written and read by the tick only.
static POSITIVE: AtomicBool = AtomicBool::new(true);

/// The duty cycle of the leg that drives.
pub struct Magnitude {
    /// PWM counts at full duty.
    full: u16,
}

/// Which leg drives.
pub struct Direction;

/// All four switches, and the power stage's own enable input.
pub struct Enable {
    input: Output<'static>,
    lamp: Output<'static>,
}

/// Sets up the timer's outputs, off; `input` is the power stage's enable input, `lamp` shows that it is on.
///
/// # Panics
/// If the constants do not fit each other, on the first start with them.
pub fn bridge(mut timer: ComplementaryPwm<'static, TIM1>, input: Output<'static>, lamp: Output<'static>) -> Bridge {
    timer.set_master_output_enable(false);
    timer.set_dead_time(DEAD_TIME_CLOCKS);
    // Off means driven to the inactive level, not left floating: after MOE = 0 all outputs are low (the reset value of
    // OISx and OISxN).
    timer.set_off_state_selection_idle(Ossi::IDLE_LEVEL);
    timer.set_off_state_selection_run(Ossr::IDLE_LEVEL);
    timer.set_automatic_output_enable(false);
    timer.set_break_polarity(BREAK_LEVEL);
    timer.set_break_filter(BREAK_FILTER);
    timer.set_break_input_pin_enable(true);
    timer.set_break_enable(true);
    for leg in [Channel::Ch1, Channel::Ch2] {
        timer.set_duty(leg, 0);
        timer.enable(leg);
    }
    let full = u16::try_from(timer.get_max_duty()).unwrap_or(u16::MAX);
    // Stays as it is until the next reset; dropped, it would be switched off.
    core::mem::forget(timer);
    let limits = Limits { code: DRIVE_MAX_CODE, dead_time: DEAD_TIME_COUNTS };
    let Ok(bridge) = SignMagnitude::new(Magnitude { full }, Direction, Enable { input, lamp }, limits) else {
        panic!("the drive's constants do not fit each other");
    };
    bridge
}

/// Opens all four switches, from wherever the program is.
pub fn open_all_switches() {
    pac::TIM1.bdtr().modify(|break_and_dead_time| break_and_dead_time.set_moe(false));
}

/// Whether the break input has switched off since it was last asked, or does so now.
pub fn take_break() -> bool {
    let tripped = pac::TIM1.sr().read().bif(0);
    if tripped {
        // All flags but this one keep their value when 1 is written. It is set again at once while the input is active.
        pac::TIM1.sr().write(|flags| {
            flags.0 = u32::MAX;
            flags.set_bif(0, false);
        });
    }
    tripped
}

impl pwm::ErrorType for Magnitude {
    type Error = Infallible;
}

impl SetDutyCycle for Magnitude {
    fn max_duty_cycle(&self) -> u16 {
        self.full
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

    /// While the break input is active the timer keeps its outputs off whatever is asked of it; the tick sees that by
    /// [`take_break`], which is why a trip from before is forgotten here.
    fn set_high(&mut self) -> Result<(), Infallible> {
        take_break();
        pac::TIM1.bdtr().modify(|break_and_dead_time| break_and_dead_time.set_moe(true));
        self.input.set_high();
        self.lamp.set_high();
        Ok(())
    }
}
