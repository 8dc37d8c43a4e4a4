//! A fake power stage that writes down what its inputs are set to, in order.

use core::cell::RefCell;
use std::rc::Rc;
use std::vec::Vec;

use embedded_hal::{digital, pwm};
use proptest::prelude::*;

use super::*;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    Duty(u16),
    Direction(bool),
    Enable(bool),
}

#[derive(Clone, Default)]
struct Stage {
    log: Rc<RefCell<Vec<Set>>>,
    broken: Rc<RefCell<Option<DriveError>>>,
}

#[derive(Debug)]
struct Broken;

impl pwm::Error for Broken {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl Stage {
    fn set(&self, part: DriveError, what: Set) -> Result<(), Broken> {
        if *self.broken.borrow() == Some(part) {
            return Err(Broken);
        }
        self.log.borrow_mut().push(what);
        Ok(())
    }

    fn taken(&self) -> Vec<Set> {
        self.log.take()
    }

    fn drive(&self, full_duty: u16, limits: Limits) -> Result<Fake, ConfigError> {
        SignMagnitude::new(
            Pwm(self.clone(), full_duty),
            Pin(self.clone(), DriveError::Direction, Set::Direction),
            Pin(self.clone(), DriveError::Enable, Set::Enable),
            limits,
        )
    }
}

type Fake = SignMagnitude<Pwm, Pin, Pin>;

struct Pwm(Stage, u16);

impl pwm::ErrorType for Pwm {
    type Error = Broken;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        self.1
    }
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        assert!(duty <= self.1, "embedded-hal: duty is at most max_duty_cycle");
        self.0.set(DriveError::Pwm, Set::Duty(duty))
    }
}

struct Pin(Stage, DriveError, fn(bool) -> Set);

impl digital::ErrorType for Pin {
    type Error = Broken;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.0.set(self.1, (self.2)(false))
    }
    fn set_high(&mut self) -> Result<(), Broken> {
        self.0.set(self.1, (self.2)(true))
    }
}

const FREE: Limits = Limits { code: FULL_SCALE, dead_time: 0, brakes: true };

fn enabled(stage: &Stage, full_duty: u16, limits: Limits) -> Fake {
    let mut drive = stage.drive(full_duty, limits).unwrap();
    drive.enable().unwrap();
    stage.taken();
    drive
}

#[test]
fn a_drive_that_is_off_sets_nothing_and_says_so() {
    let stage = Stage::default();
    let mut drive = stage.drive(1000, FREE).unwrap();
    assert_eq!(drive.apply(20_000), Ok(Applied { code: 0, limited: false }));
    assert_eq!(stage.taken(), []);
}

#[test]
fn enabling_starts_from_zero_drive_and_off_disables_before_anything_else() {
    let stage = Stage::default();
    let mut drive = stage.drive(1000, FREE).unwrap();
    drive.enable().unwrap();
    assert_eq!(stage.taken(), [Set::Duty(0), Set::Enable(true)]);
    drive.off().unwrap();
    assert_eq!(stage.taken(), [Set::Enable(false), Set::Duty(0)]);
    assert_eq!(drive.apply(1), Ok(Applied::default()));
}

#[test]
fn a_reversal_passes_through_zero_duty() {
    let stage = Stage::default();
    let mut drive = enabled(&stage, 1000, FREE);
    drive.apply(i32::from(FULL_SCALE)).unwrap();
    assert_eq!(stage.taken(), [Set::Duty(0), Set::Direction(true), Set::Duty(1000)]);
    drive.apply(i32::from(FULL_SCALE)).unwrap();
    assert_eq!(stage.taken(), [Set::Duty(1000)]);
    drive.apply(-i32::from(FULL_SCALE)).unwrap();
    assert_eq!(stage.taken(), [Set::Duty(0), Set::Direction(false), Set::Duty(1000)]);
}

#[test]
fn beyond_the_limit_it_saturates_and_says_so() {
    let stage = Stage::default();
    let mut drive = enabled(&stage, 32_767, Limits { code: 10_000, dead_time: 0, brakes: true });
    assert_eq!(drive.apply(i32::MAX), Ok(Applied { code: 10_000, limited: true }));
    assert_eq!(drive.apply(i32::MIN), Ok(Applied { code: -10_000, limited: true }));
    assert_eq!(drive.apply(10_000), Ok(Applied { code: 10_000, limited: false }));
}

#[test]
fn dead_time_and_quantisation_are_in_what_was_applied() {
    let stage = Stage::default();
    let mut drive = enabled(&stage, 100, Limits { code: FULL_SCALE, dead_time: 4, brakes: true });
    // 16384/32767 of 100 counts is 50; the pulse is 46 counts long: 46·32767/100 = 15072.8.
    assert_eq!(drive.apply(16_384).unwrap().code, 15_073);
    assert_eq!(drive.apply(-16_384).unwrap().code, -15_073);
    // 1310/32767 of 100 counts is 4.0: all of it is lost in the dead time.
    assert_eq!(drive.apply(1_310).unwrap().code, 0);
    // 1639/32767 of 100 counts is 5.002: one count of it is left.
    assert_eq!(drive.apply(1_639).unwrap().code, 328);
}

#[test]
fn settings_out_of_range_are_named() {
    let stage = Stage::default();
    let error = |full_duty, code, dead_time| stage.drive(full_duty, Limits { code, dead_time, brakes: true }).err();
    assert_eq!(error(1000, 0, 0), Some(ConfigError::Code));
    assert_eq!(error(1000, -5, 0), Some(ConfigError::Code));
    assert_eq!(error(0, FULL_SCALE, 0), Some(ConfigError::Code));
    assert_eq!(error(1000, 32, 0), Some(ConfigError::Code), "less than one PWM count");
    assert_eq!(error(1000, 33, 0), None);
    assert_eq!(error(1000, FULL_SCALE, 1000), Some(ConfigError::DeadTime));
    assert_eq!(error(1000, FULL_SCALE, 999), None);
}

#[test]
fn an_error_names_the_part_and_switches_off_what_it_can() {
    for part in [DriveError::Pwm, DriveError::Direction] {
        let stage = Stage::default();
        let mut drive = enabled(&stage, 1000, FREE);
        stage.broken.replace(Some(part));
        assert_eq!(drive.apply(5_000), Err(part));
        assert!(stage.taken().contains(&Set::Enable(false)), "{part:?}");
        stage.broken.replace(None);
        assert_eq!(drive.apply(5_000), Ok(Applied::default()), "{part:?}");
    }
    let stage = Stage::default();
    let mut drive = stage.drive(1000, FREE).unwrap();
    stage.broken.replace(Some(DriveError::Enable));
    assert_eq!(drive.enable(), Err(DriveError::Enable));
    assert_eq!(stage.taken().last(), Some(&Set::Duty(0)));
}

proptest! {
    /// For any stage the drive is odd in the command and never above the limit. It is never above the command by more
    /// than half a PWM count (the rounding) and half a code (the report's own rounding).
    #[test]
    fn applied_is_odd_and_bounded(
        full_duty in 1..=u16::MAX,
        code in 1..=FULL_SCALE,
        dead_time in 0..100u16,
        command in -40_000..40_000i32,
    ) {
        let stage = Stage::default();
        if let Ok(mut drive) = stage.drive(full_duty, Limits { code, dead_time, brakes: true }) {
            drive.enable().unwrap();
            let applied = drive.apply(command).unwrap();
            let mirrored = drive.apply(-command).unwrap();
            prop_assert_eq!(mirrored.code, -applied.code);
            prop_assert_eq!(mirrored.limited, applied.limited);
            prop_assert!(applied.code.unsigned_abs() <= code.unsigned_abs());
            prop_assert!(i32::from(applied.code) * command >= 0);
            let half_count = 0.5 * f64::from(FULL_SCALE) / f64::from(full_duty);
            let excess = f64::from(applied.code.unsigned_abs()) - f64::from(command.unsigned_abs());
            prop_assert!(excess <= half_count + 0.5);
        }
    }
}

/// Braking leaves the stage on without duty, and lets no command through; a stage that cannot brake is off.
#[test]
fn braking_is_no_drive() {
    for brakes in [true, false] {
        let stage = Stage::default();
        let mut drive = enabled(&stage, 32_767, Limits { brakes, ..FREE });
        drive.apply(20_000).unwrap();
        stage.taken();
        drive.brake().unwrap();
        let on = stage.taken();
        assert!(on.contains(&Set::Enable(brakes)) && on.contains(&Set::Duty(0)), "{on:?}");
        assert_eq!(drive.apply(20_000), Ok(Applied::default()));
        assert_eq!(stage.taken(), []);
    }
}
