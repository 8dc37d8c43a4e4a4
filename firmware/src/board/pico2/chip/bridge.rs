//! The bridge on both channels of a PWM slice, made into the inputs of a [`SignMagnitude`] drive (see
//! [`levels`](super::super::levels)).
//!
//! Off holds both pins low behind the slice, at once: all four switches are open. The registers are written without the
//! HAL, whose checks could panic in the tick.

use core::convert::Infallible;
use core::sync::atomic::{AtomicBool, Ordering};

use embedded_hal::digital::{self, OutputPin, PinState};
use embedded_hal::pwm::{self, SetDutyCycle};

use super::protection::pause_watchdog_in_debug;
use super::registers::pwm;
use super::{pins, stop};
use crate::board::pico2::constants::{
    DEAD_TIME_COUNTS, DRIVE_MAX_CODE, IN1_PIN, IN2_PIN, LAMP_PIN, PWM_COUNTS, PWM_SLICE,
};
use crate::board::pico2::levels::compare;
use crate::board::{Limits, SignMagnitude};

/// The power stage.
pub type Bridge = SignMagnitude<Magnitude, Direction, Enable>;

/// The sign of the drive. Written and read by the tick only.
static POSITIVE: AtomicBool = AtomicBool::new(true);

/// The duty cycle of the input that is pulsed.
pub struct Magnitude(());

/// Which input is pulsed.
pub struct Direction(());

/// Both inputs.
pub struct Enable(());

/// Sets up pins and slice, off; once. The slice does not count before all are started together.
///
/// # Panics
/// If the constants do not fit each other, on the first start with them.
pub(super) fn bridge() -> Bridge {
    pins::connect_low(IN1_PIN);
    pins::connect_low(IN2_PIN);
    pins::connect(LAMP_PIN, pins::Function::Sio, pins::Pull::Down);
    pins::drive(LAMP_PIN);
    let slice = pwm().ch(PWM_SLICE);
    // SAFETY: any 16 bits are a top; the count turns around there, which takes a clock more than it says.
    slice.top().write(|top| unsafe { top.top().bits(PWM_COUNTS - 1) });
    slice.csr().write(|control| control.ph_correct().set_bit());
    let limits = Limits { code: DRIVE_MAX_CODE, dead_time: DEAD_TIME_COUNTS, brakes: true };
    let Ok(mut bridge) = SignMagnitude::new(Magnitude(()), Direction(()), Enable(()), limits) else {
        panic!("the drive's constants do not fit each other");
    };
    // Both inputs are written, so that nothing of before is let through.
    let Ok(()) = crate::board::Drive::off(&mut bridge) else {
        panic!("infallible");
    };
    bridge
}

/// Opens all four switches, from wherever the program is.
#[inline]
pub fn open_all_switches() {
    pins::hold_low(IN1_PIN);
    pins::hold_low(IN2_PIN);
}

impl pwm::ErrorType for Magnitude {
    type Error = Infallible;
}

impl SetDutyCycle for Magnitude {
    fn max_duty_cycle(&self) -> u16 {
        PWM_COUNTS
    }

    /// Both channels in one write, which the slice takes over at the end of its period.
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        let levels = compare(POSITIVE.load(Ordering::Relaxed), duty, PWM_COUNTS);
        // SAFETY: two compare values.
        pwm().ch(PWM_SLICE).cc().write(|both| unsafe { both.bits(levels) });
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
        pins::set(LAMP_PIN, false);
        pause_watchdog_in_debug(true);
        Ok(())
    }

    /// The emergency stop may come between the lines: it is looked at once more at the end. The tick sees it by
    /// [`stop::take`], which is why a trip from before is forgotten here.
    fn set_high(&mut self) -> Result<(), Infallible> {
        stop::take();
        pause_watchdog_in_debug(false);
        pins::release(IN1_PIN);
        pins::release(IN2_PIN);
        let stopped = stop::is_stopped();
        if stopped {
            open_all_switches();
        }
        pins::set(LAMP_PIN, !stopped);
        Ok(())
    }
}
