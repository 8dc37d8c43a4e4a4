//! The bridge at its inputs, by the data sheet's table, clock by clock.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};

use super::compare;
use crate::board::pico2::constants::{DEAD_TIME_COUNTS, DRIVE_MAX_CODE, PWM_COUNTS};
use crate::board::{Drive, FULL_SCALE, Limits, SignMagnitude};

/// What the bridge does in one clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Bridge {
    Coasts,
    Drives(i32),
    Brakes,
}

fn bridge(in1: bool, in2: bool) -> Bridge {
    match (in1, in2) {
        (false, false) => Bridge::Coasts,
        (true, false) => Bridge::Drives(1),
        (false, true) => Bridge::Drives(-1),
        (true, true) => Bridge::Brakes,
    }
}

/// One period of a slice that counts up and down: a channel is high while the count is below its compare value.
fn period(word: u32) -> impl Iterator<Item = Bridge> {
    let count = (0..PWM_COUNTS).chain((0..PWM_COUNTS).rev());
    count.map(move |count| {
        let high = |half: u32| u32::from(count) < half;
        bridge(high(word & 0xffff), high(word >> 16))
    })
}

/// Clocks of drive in a period, by their sign.
fn driven(word: u32) -> i32 {
    period(word).map(|now| if let Bridge::Drives(sign) = now { sign } else { 0 }).sum()
}

/// Every duty drives for twice its counts, brakes for the rest, and never coasts.
#[test]
fn a_period_drives_or_brakes() {
    for (positive, sign) in [(true, 1), (false, -1)] {
        for duty in (0..=PWM_COUNTS).step_by(125).chain([1, 2, PWM_COUNTS - 1]) {
            let word = compare(positive, duty, PWM_COUNTS);
            assert!(!period(word).any(|now| now == Bridge::Coasts), "{duty}");
            let against = period(word).filter(|now| *now == Bridge::Drives(-sign)).count();
            assert_eq!((driven(word), against), (sign * 2 * i32::from(duty), 0), "{positive} {duty}");
        }
        assert!(period(compare(positive, 0, PWM_COUNTS)).all(|now| now == Bridge::Brakes));
        assert!(period(compare(positive, PWM_COUNTS, PWM_COUNTS)).all(|now| now == Bridge::Drives(sign)));
        // More than there is, is all.
        assert_eq!(compare(positive, u16::MAX, PWM_COUNTS), compare(positive, PWM_COUNTS, PWM_COUNTS));
    }
}

/// The slice as the chip's driver sees it.
#[derive(Clone, Default)]
struct Slice {
    positive: Rc<Cell<bool>>,
    word: Rc<Cell<u32>>,
}

impl pwm::ErrorType for Slice {
    type Error = Infallible;
}
impl SetDutyCycle for Slice {
    fn max_duty_cycle(&self) -> u16 {
        PWM_COUNTS
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.word.set(compare(self.positive.get(), duty, PWM_COUNTS));
        Ok(())
    }
}
impl digital::ErrorType for Slice {
    type Error = Infallible;
}
impl OutputPin for Slice {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.positive.set(false);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.positive.set(true);
        Ok(())
    }
}

/// What the drive says that the motor gets is what the bridge gives it, less the dead time: the mean of a period.
#[test]
fn the_applied_code_is_the_mean_voltage() {
    let slice = Slice::default();
    let limits = Limits { code: DRIVE_MAX_CODE, dead_time: DEAD_TIME_COUNTS, brakes: true };
    let mut drive = SignMagnitude::new(slice.clone(), slice.clone(), slice.clone(), limits).unwrap();
    drive.enable().unwrap();
    let full = i32::from(FULL_SCALE);
    let clocks = 2 * i32::from(PWM_COUNTS);
    let lost = 2 * i32::from(DEAD_TIME_COUNTS);
    for command in (-40_000..=40_000).step_by(97) {
        let applied = drive.apply(command).unwrap();
        let driven = driven(slice.word.get());
        let given = (driven.abs() - lost).max(0) * driven.signum();
        // Rounded to the nearest code: half of one, in clocks.
        assert!((i32::from(applied.code) * clocks - given * full).abs() <= clocks / 2, "{command}: {applied:?}");
        // And that is what was asked for, to the nearest count and less the dead time.
        let asked = command.clamp(-full, full) * clocks / full;
        assert!((driven - asked).abs() <= 2, "{command}: {driven} of {asked} clocks");
    }
}
