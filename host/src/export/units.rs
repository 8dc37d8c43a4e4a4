//! From the units of a recording to SI: the force of a drive unit, and the angle or length of a position unit.

use std::str::FromStr;

use super::{ExportError, Target};
use crate::recording::Units;

/// What the drive is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// Voltage at the motor.
    Voltage,
    /// Current through the motor.
    Current,
    /// Share of the supply's voltage.
    Duty,
    /// Force or torque at the load.
    Effort,
}

impl FromStr for DriveKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "voltage" => Ok(Self::Voltage),
            "current" => Ok(Self::Current),
            "duty" => Ok(Self::Duty),
            "effort" => Ok(Self::Effort),
            _ => Err("expected voltage, current, duty or effort".to_owned()),
        }
    }
}

/// Where the position was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Behind the gear.
    #[default]
    Load,
    /// Before it.
    Motor,
}

impl FromStr for Side {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "load" => Ok(Self::Load),
            "motor" => Ok(Self::Motor),
            _ => Err("expected load or motor".to_owned()),
        }
    }
}

/// What is known of motor and gear. Nothing is by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// What the drive is; else its unit says so.
    pub drive: Option<DriveKind>,
    /// Kt, N·m/A; of a linear motor N/A.
    pub motor_constant: Option<f64>,
    /// R, Ω.
    pub resistance: Option<f64>,
    /// Voltage of the supply, V.
    pub supply: Option<f64>,
    /// Turns of the motor per turn of the load; of a linear axis rad of the motor per m. 1 if not given.
    pub gear: Option<f64>,
    /// Force at the load per drive unit, N·m or N; stands for all constants.
    pub drive_gain: Option<f64>,
    /// Where the position was measured.
    pub encoder: Side,
    /// Counts per turn, where the position is in counts.
    pub counts_per_turn: Option<f64>,
}

/// A recording's units in SI, at the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// A drive unit, N·m or N.
    pub force: f64,
    /// A position unit, rad or m.
    pub length: f64,
    /// Whether the axis is linear.
    pub linear: bool,
    /// See [`Motor::gear`].
    pub gear: f64,
    /// A motor that is driven by its voltage in V, with its constants.
    pub winding: Option<Winding>,
}

/// The winding of a motor whose drive is its voltage in V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// Kt = Ke, N·m/A.
    pub constant: f64,
    /// R, Ω.
    pub resistance: f64,
}

/// What a drive's unit is: its kind and its size in V, A, shares of the supply, or N·m.
fn unit_of_drive(unit: &str) -> Option<(DriveKind, f64)> {
    Some(match unit {
        "V" => (DriveKind::Voltage, 1.0),
        "mV" => (DriveKind::Voltage, 1e-3),
        "A" => (DriveKind::Current, 1.0),
        "mA" => (DriveKind::Current, 1e-3),
        "Nm" | "N·m" | "N*m" | "N m" | "N" => (DriveKind::Effort, 1.0),
        "mNm" | "mN·m" | "mN" => (DriveKind::Effort, 1e-3),
        "duty" => (DriveKind::Duty, 1.0),
        "pct" | "%" => (DriveKind::Duty, 0.01),
        _ => return None,
    })
}

/// Metres of a unit of length.
fn metres(unit: &str) -> Option<f64> {
    Some(match unit {
        "m" => 1.0,
        "cm" => 1e-2,
        "mm" => 1e-3,
        "um" | "µm" | "μm" => 1e-6,
        _ => return None,
    })
}

impl Motor {
    /// A recording's units in SI.
    ///
    /// # Errors
    /// [`ExportError`] names what is missing.
    pub fn scale(&self, units: &Units, target: Target) -> Result<Scale, ExportError> {
        let gear = self.gear.unwrap_or(1.0);
        let (radians, metres) = (units.radians(self.counts_per_turn), metres(&units.x));
        let size = radians.or(metres).ok_or_else(|| ExportError::Position { target, unit: units.x.clone() })?;
        // An encoder at the motor turns `gear` times as far.
        let length = if self.encoder == Side::Motor { size / gear } else { size };
        let (force, winding) = self.force(&units.u, gear, target)?;
        Ok(Scale { force, length, linear: radians.is_none(), gear, winding })
    }

    /// Force at the load per drive unit.
    fn force(&self, unit: &str, gear: f64, target: Target) -> Result<(f64, Option<Winding>), ExportError> {
        let useless = |option, reason| Err(ExportError::Useless { option, unit: unit.to_owned(), reason });
        let constants = [self.motor_constant, self.resistance, self.supply];
        if let Some(gain) = self.drive_gain {
            if constants.iter().any(Option::is_some) {
                return useless("--drive-gain", "the motor's constants are given as well; give one or the other");
            }
            return Ok((gain, None));
        }
        let known = unit_of_drive(unit);
        // Another kind than the unit says is in its own unit: V, A, shares of the supply, N·m.
        let size =
            known.filter(|(kind, _)| self.drive.is_none_or(|drive| drive == *kind)).map_or(1.0, |(_, size)| size);
        let kind = self.drive.or(known.map(|(kind, _)| kind));
        let kind = kind.ok_or_else(|| ExportError::Drive { target, unit: unit.to_owned() })?;
        let needed: &[(&str, Option<f64>)] = match kind {
            DriveKind::Voltage => &[("--motor-constant", constants[0]), ("--resistance", constants[1])],
            DriveKind::Current => &[("--motor-constant", constants[0])],
            DriveKind::Duty => {
                &[("--motor-constant", constants[0]), ("--resistance", constants[1]), ("--supply", constants[2])]
            }
            DriveKind::Effort => &[],
        };
        let missing: Vec<&str> = needed.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| *name).collect();
        if !missing.is_empty() {
            let missing = missing.join(" and ");
            return Err(ExportError::Constants { target, unit: unit.to_owned(), missing });
        }
        let [constant, resistance, supply] = constants.map(|value| value.unwrap_or(1.0));
        Ok(match kind {
            DriveKind::Voltage => {
                let winding = (size == 1.0).then_some(Winding { constant, resistance });
                (size * constant / resistance * gear, winding)
            }
            DriveKind::Current => (size * constant * gear, None),
            DriveKind::Duty => (size * supply * constant / resistance * gear, None),
            // It is measured at the load.
            DriveKind::Effort => (size, None),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(u: &str, x: &str) -> Units {
        Units { u: u.into(), x: x.into() }
    }

    /// By hand: Kt 0.05 N·m/A, R 2 Ω, 24 V, gear 10, encoder at the load: 0.25 N·m/V, 0.5 N·m/A, 6 N·m at full duty.
    #[test]
    fn a_drive_unit_is_a_torque() {
        let motor = Motor {
            motor_constant: Some(0.05),
            resistance: Some(2.0),
            supply: Some(24.0),
            gear: Some(10.0),
            ..Motor::default()
        };
        for (u, force) in [("V", 0.25), ("mV", 0.25e-3), ("A", 0.5), ("mA", 0.5e-3), ("pct", 0.06), ("duty", 6.0)] {
            let scale = motor.scale(&units(u, "rad"), Target::Mjcf).unwrap();
            assert!((scale.force / force - 1.0).abs() < 1e-12, "{u}: {scale:?}");
            assert_eq!((scale.length, scale.linear, scale.winding.is_some()), (1.0, false, u == "V"));
        }
        let motor_side = Motor { encoder: Side::Motor, ..motor };
        let scale = motor_side.scale(&units("V", "turns"), Target::Mjcf).unwrap();
        assert!((scale.length / (0.1 * std::f64::consts::TAU) - 1.0).abs() < 1e-12);
        let scale = Motor::default().scale(&units("mNm", "mm"), Target::Mjcf).unwrap();
        assert_eq!((scale.force, scale.length, scale.linear), (1e-3, 1e-3, true));
    }

    /// Each refusal names the option that helps.
    #[test]
    fn what_is_missing_is_named() {
        let refused = |motor: Motor, u: &str, x: &str| motor.scale(&units(u, x), Target::Mjcf).unwrap_err().to_string();
        let nothing = Motor::default();
        let both = refused(nothing, "V", "rad");
        assert!(both.contains("--motor-constant and --resistance") && both.contains("--drive-gain"), "{both}");
        let one = refused(Motor { motor_constant: Some(1.0), ..nothing }, "pct", "rad");
        assert!(one.contains("--resistance and --supply") && !one.contains("--motor-constant"), "{one}");
        assert!(refused(nothing, "pwm", "rad").contains("--drive voltage"));
        assert!(refused(nothing, "Nm", "counts").contains("--counts-per-turn"));
        let twice = Motor { drive_gain: Some(2.0), motor_constant: Some(1.0), ..nothing };
        assert!(refused(twice, "V", "rad").contains("one or the other"));
        let counts = Motor { counts_per_turn: Some(4096.0), ..nothing };
        assert!(counts.scale(&units("Nm", "counts"), Target::Mjcf).is_ok());
    }
}
