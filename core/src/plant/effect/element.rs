//! What an effect is as a part of a machine, as its own file says it: a shape, with numbers in the law's units.
//!
//! Programs that build the machine elsewhere (the host's `export`) translate the shapes. They name no effect.

/// A part of a machine. Forces and friction levels are in drive units, positions in position units, angles in rad.
/// `x` is the position, `v` the velocity, `u` the drive, `t` the time of the session.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Element {
    /// None of the shapes below.
    Other,
    /// The drive acts later.
    DriveDelay {
        /// s.
        delay_s: f64,
    },
    /// The drive follows its command with a first-order lag.
    DriveLag {
        /// s.
        time_constant_s: f64,
    },
    /// The drive loses a constant part of every command.
    DriveDeadZone {
        /// Drive units.
        half_width: f64,
    },
    /// The drive is limited to ± this.
    DriveLimit {
        /// Drive units.
        largest: f64,
    },
    /// The drive loses `loss·sat((u − back_emf·v)/edge)`.
    DriveDeadTime {
        /// Drive units.
        loss: f64,
        /// Drive units.
        edge: f64,
        /// Drive per velocity.
        back_emf: f64,
    },
    /// The drive's gain is `1 − rate·t`.
    DriveGainDrift {
        /// 1/s.
        rate: f64,
    },
    /// A constant force.
    Constant {
        /// Drive units.
        force: f64,
    },
    /// A force `−by_speed·|v| − by_square·v·|v|`.
    Drag {
        /// Drive per velocity.
        by_speed: f64,
        /// Drive per velocity squared.
        by_square: f64,
    },
    /// A force `first[0]·sin(n·x + first[1]) + second[0]·sin(2n·x + second[1])`.
    Ripple {
        /// n, rad per position.
        wave_number: f64,
        /// Amplitude in drive units and phase in rad.
        first: [f64; 2],
        /// The same of the second harmonic; amplitude 0 where there is none.
        second: [f64; 2],
    },
    /// A force `−stiffness·(x − rest)`.
    Spring {
        /// Drive per position.
        stiffness: f64,
        /// Position.
        rest: f64,
    },
    /// A force `−|stiffness|·(x − begins)` where `stiffness·(x − begins)` is positive.
    Stop {
        /// Drive per position; its sign says the side.
        stiffness: f64,
        /// Position.
        begins: f64,
    },
    /// A force `amplitude·sin(angular_frequency·t + phase)`.
    Shaking {
        /// Drive units.
        amplitude: f64,
        /// rad/s.
        angular_frequency: f64,
        /// rad.
        phase: f64,
    },
    /// Friction level at rest, above that of sliding.
    LevelAtRest {
        /// Drive units.
        rise: f64,
    },
    /// Friction level `rise·e^(−(|v|/speed)^exponent)`.
    LevelBySpeed {
        /// Drive units.
        rise: f64,
        /// Velocity.
        speed: f64,
        /// 1.
        exponent: f64,
    },
    /// Friction level `ratio·|u|`.
    LevelByDrive {
        /// Friction per drive.
        ratio: f64,
    },
    /// Friction level `amplitude·sin(n·x + phase)`.
    LevelByPosition {
        /// Drive units.
        amplitude: f64,
        /// n, rad per position.
        wave_number: f64,
        /// rad.
        phase: f64,
    },
    /// Friction level `rise·e^(−t/time_constant_s)`.
    LevelInTime {
        /// Drive units.
        rise: f64,
        /// s.
        time_constant_s: f64,
    },
    /// From `at_s` on the inertia is greater by `share`.
    InertiaStep {
        /// Share of b.
        share: f64,
        /// s.
        at_s: f64,
    },
    /// Bristles carry the friction: `stiffness·z + damping·ż`, `ż = v − stiffness·|v|·z/g`,
    /// `g = f1 + rise·e^(−(v/speed)²)`.
    Bristles {
        /// Drive per position.
        stiffness: f64,
        /// Drive per velocity.
        damping: f64,
        /// Drive units; 0 where the level does not depend on the speed.
        rise: f64,
        /// Velocity.
        speed: f64,
    },
    /// A second body is free within a gap of the motor.
    LooseLoad {
        /// Share of b.
        share: f64,
        /// Whole width, position.
        gap: f64,
        /// Closing speed left after an impact, as a share.
        restitution: f64,
    },
    /// A second body behind a spring and a damper.
    SprungLoad {
        /// Share of b.
        share: f64,
        /// Of the body against a fixed motor, rad/s.
        angular_frequency: f64,
        /// Over the critical one.
        damping_ratio: f64,
    },
    /// The reading errs by `amplitude·sin(n·x + phase)`.
    ReadingRipple {
        /// Position.
        amplitude: f64,
        /// n, rad per position.
        wave_number: f64,
        /// rad.
        phase: f64,
    },
}

impl Element {
    /// The same in other units: a drive unit is a force of `force`, and a position unit a length (or angle) of
    /// `length`. Numbers of the drive itself (its limit, its dead zone) stay in drive units.
    #[must_use]
    pub fn in_units(self, force: f64, length: f64) -> Self {
        let amplitude = |[amplitude, phase]: [f64; 2]| [amplitude * force, phase];
        match self {
            Self::Other
            | Self::DriveDelay { .. }
            | Self::DriveLag { .. }
            | Self::DriveDeadZone { .. }
            | Self::DriveLimit { .. }
            | Self::DriveGainDrift { .. }
            | Self::LevelByDrive { .. }
            | Self::InertiaStep { .. }
            | Self::SprungLoad { .. } => self,
            Self::DriveDeadTime { loss, edge, back_emf } => {
                Self::DriveDeadTime { loss, edge, back_emf: back_emf / length }
            }
            Self::Constant { force: constant } => Self::Constant { force: constant * force },
            Self::Drag { by_speed, by_square } => {
                Self::Drag { by_speed: by_speed * force / length, by_square: by_square * force / (length * length) }
            }
            Self::Ripple { wave_number, first, second } => {
                Self::Ripple { wave_number: wave_number / length, first: amplitude(first), second: amplitude(second) }
            }
            Self::Spring { stiffness, rest } => {
                Self::Spring { stiffness: stiffness * force / length, rest: rest * length }
            }
            Self::Stop { stiffness, begins } => {
                Self::Stop { stiffness: stiffness * force / length, begins: begins * length }
            }
            Self::Shaking { amplitude, angular_frequency, phase } => {
                Self::Shaking { amplitude: amplitude * force, angular_frequency, phase }
            }
            Self::LevelAtRest { rise } => Self::LevelAtRest { rise: rise * force },
            Self::LevelBySpeed { rise, speed, exponent } => {
                Self::LevelBySpeed { rise: rise * force, speed: speed * length, exponent }
            }
            Self::LevelByPosition { amplitude, wave_number, phase } => {
                Self::LevelByPosition { amplitude: amplitude * force, wave_number: wave_number / length, phase }
            }
            Self::LevelInTime { rise, time_constant_s } => Self::LevelInTime { rise: rise * force, time_constant_s },
            Self::Bristles { stiffness, damping, rise, speed } => Self::Bristles {
                stiffness: stiffness * force / length,
                damping: damping * force / length,
                rise: rise * force,
                speed: speed * length,
            },
            Self::LooseLoad { share, gap, restitution } => Self::LooseLoad { share, gap: gap * length, restitution },
            Self::ReadingRipple { amplitude, wave_number, phase } => {
                Self::ReadingRipple { amplitude: amplitude * length, wave_number: wave_number / length, phase }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, with 2 N·m per drive unit and 0.5 rad per position unit. A stiffness is 4 times as much in N·m/rad, and a
    /// drag by the square 8 times. A speed is half, and a wave number twice.
    #[test]
    fn numbers_follow_their_units() {
        let drag = Element::Drag { by_speed: 1.0, by_square: 1.0 };
        assert_eq!(drag.in_units(2.0, 0.5), Element::Drag { by_speed: 4.0, by_square: 8.0 });
        let bristles = Element::Bristles { stiffness: 1.0, damping: 3.0, rise: 1.0, speed: 1.0 };
        let scaled = Element::Bristles { stiffness: 4.0, damping: 12.0, rise: 2.0, speed: 0.5 };
        assert_eq!(bristles.in_units(2.0, 0.5), scaled);
        let ripple = Element::Ripple { wave_number: 7.0, first: [1.0, 0.3], second: [0.0, 0.0] };
        let scaled = Element::Ripple { wave_number: 14.0, first: [2.0, 0.3], second: [0.0, 0.0] };
        assert_eq!(ripple.in_units(2.0, 0.5), scaled);
        let limit = Element::DriveLimit { largest: 24.0 };
        assert_eq!(limit.in_units(2.0, 0.5), limit);
    }
}
