//! A power stage with one PWM input, one direction input and one enable input.

use embedded_hal::digital::{OutputPin, PinState};
use embedded_hal::pwm::SetDutyCycle;

use super::drive::{Applied, Drive, FULL_SCALE};

/// What a power stage is allowed, and what it loses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest drive either way, in drive codes, 1..=[`FULL_SCALE`].
    pub code: i16,
    /// By how much the power stage shortens every pulse (its dead time), in PWM counts; less than full duty.
    /// It is reported, not made up for.
    pub dead_time: u16,
    /// Enabled without duty, the stage holds both ends of the motor together.
    pub brakes: bool,
}

/// Which setting of a [`SignMagnitude`] drive is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConfigError {
    /// [`Limits::code`] is not in 1..=[`FULL_SCALE`], or is less than one PWM count.
    Code,
    /// [`Limits::dead_time`] leaves nothing of a pulse at the limit.
    DeadTime,
}

/// Which part of the power stage could not be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveError {
    /// The duty cycle.
    Pwm,
    /// The direction pin.
    Direction,
    /// The enable pin.
    Enable,
}

/// Sign and magnitude on separate inputs: direction high is positive, enable high lets the stage drive.
///
/// The motor gets `sgn(command) · max(0, duty − dead time) / full duty` of the supply. There `duty` is the command's
/// magnitude rounded to the nearest PWM count, not above the limit.
pub struct SignMagnitude<P, D, E> {
    pwm: P,
    direction: D,
    enable: E,
    limits: Limits,
    /// The PWM's counts at full duty, ≥ 1.
    full_duty: u16,
    /// The limit in PWM counts, 1..=`full_duty`.
    max_duty: u16,
    enabled: bool,
    /// What the direction pin was last set to; `None` before the first drive and after an error.
    positive: Option<bool>,
}

impl<P: SetDutyCycle, D: OutputPin, E: OutputPin> SignMagnitude<P, D, E> {
    /// Takes the stage's inputs; sets none of them before the first call of a [`Drive`] method. The PWM's period
    /// must not change afterwards.
    ///
    /// # Errors
    /// [`ConfigError`] names the limit that is out of range.
    pub fn new(pwm: P, direction: D, enable: E, limits: Limits) -> Result<Self, ConfigError> {
        let full_duty = pwm.max_duty_cycle();
        let Ok(limit @ 1..) = u16::try_from(limits.code) else {
            return Err(ConfigError::Code);
        };
        // Rounded down: quantisation must not exceed the limit.
        let max_duty = scale(limit, full_duty, FULL_SCALE.unsigned_abs(), 0);
        if max_duty == 0 {
            return Err(ConfigError::Code);
        }
        if limits.dead_time >= max_duty {
            return Err(ConfigError::DeadTime);
        }
        Ok(Self { pwm, direction, enable, limits, full_duty, max_duty, enabled: false, positive: None })
    }

    fn set(&mut self, positive: bool, duty: u16) -> Result<(), DriveError> {
        if duty > 0 && self.positive != Some(positive) {
            // The old magnitude must not be seen in the new direction, not even for one PWM period.
            self.pwm.set_duty_cycle_fully_off().map_err(|_| DriveError::Pwm)?;
            let state = PinState::from(positive);
            self.direction.set_state(state).map_err(|_| DriveError::Direction)?;
            self.positive = Some(positive);
        }
        self.pwm.set_duty_cycle(duty).map_err(|_| DriveError::Pwm)
    }

    /// Passes a result on, having switched off if it is an error.
    fn guarded<T>(&mut self, result: Result<T, DriveError>) -> Result<T, DriveError> {
        if result.is_err() {
            self.positive = None;
            // The first error is the one to report.
            let _ = self.off();
        }
        result
    }
}

impl<P: SetDutyCycle, D: OutputPin, E: OutputPin> Drive for SignMagnitude<P, D, E> {
    type Error = DriveError;

    fn enable(&mut self) -> Result<(), DriveError> {
        let ready = self
            .pwm
            .set_duty_cycle_fully_off()
            .map_err(|_| DriveError::Pwm)
            .and_then(|()| self.enable.set_high().map_err(|_| DriveError::Enable));
        self.guarded(ready)?;
        self.enabled = true;
        Ok(())
    }

    fn apply(&mut self, command: i32) -> Result<Applied, DriveError> {
        if !self.enabled {
            return Ok(Applied::default());
        }
        let limit = i32::from(self.limits.code);
        // Not `clamp`, which would panic if it could not be seen that the limit is positive.
        let code = command.min(limit).max(-limit);
        let full = FULL_SCALE.unsigned_abs();
        let magnitude = code.unsigned_abs() as u16;
        let duty = scale(magnitude, self.full_duty, full, full / 2).min(self.max_duty);
        let set = self.set(code > 0, duty);
        self.guarded(set)?;

        let pulse = duty.saturating_sub(self.limits.dead_time);
        let applied = scale(pulse, full, self.full_duty, self.full_duty / 2) as i16;
        Ok(Applied { code: if code < 0 { -applied } else { applied }, limited: code != command })
    }

    fn brake(&mut self) -> Result<(), DriveError> {
        if !self.limits.brakes {
            return self.off();
        }
        // No command gets through, as after `off`.
        self.enable()?;
        self.enabled = false;
        Ok(())
    }

    fn off(&mut self) -> Result<(), DriveError> {
        self.enabled = false;
        let enable = self.enable.set_low().map_err(|_| DriveError::Enable);
        let pwm = self.pwm.set_duty_cycle_fully_off().map_err(|_| DriveError::Pwm);
        enable.and(pwm)
    }
}

/// `(value · to + bias) / from`, for `value` ≤ `from`: a change of scale, rounded down (`bias` 0) or to the nearest
/// (`bias` half of `from`). 0 if `from` is 0.
fn scale(value: u16, to: u16, from: u16, bias: u16) -> u16 {
    let product = u32::from(value) * u32::from(to);
    // value ≤ from, so the quotient is at most `to`, and the sum below 2³².
    let quotient = product.saturating_add(u32::from(bias)).checked_div(u32::from(from));
    quotient.unwrap_or(0) as u16
}

#[cfg(test)]
mod tests;
