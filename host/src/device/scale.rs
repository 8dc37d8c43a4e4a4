//! Between the integers of the link and physical units.

use breakaway_core::excite::waveform::phase_step;
use breakaway_core::link::{FULL_SCALE_CODE, Info, PositionUnit};

use super::DeviceError;
use crate::recording::Units;

/// What a count, a drive code and a tick of a device are.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Control ticks per second.
    pub tick_hz: f64,
    /// Units of drive and position.
    pub units: Units,
    /// Drive units at full scale code.
    full_drive: f64,
    /// Position units per count.
    pub step: f64,
    /// Counts per position unit where that is the rounder number.
    per_unit: Option<f64>,
}

/// The decimal number that was meant by a single-precision one: 0.001, not 0.0010000000474974513.
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}

/// A current of the link, A.
pub fn amperes(current_ma: i32) -> f64 {
    f64::from(current_ma) / 1000.0
}

impl Scale {
    /// The scale of a device.
    ///
    /// # Errors
    /// [`DeviceError::Range`] if it is of no use.
    pub fn new(info: &Info) -> Result<Self, DeviceError> {
        let valid = |value: f32| value.is_finite() && value > 0.0;
        for (what, value, valid) in [
            ("tick_hz", f64::from(info.tick_hz), info.tick_hz > 0),
            ("position_per_count", f64::from(info.position_per_count), valid(info.position_per_count)),
            ("drive_full_scale", f64::from(info.drive_full_scale), valid(info.drive_full_scale)),
        ] {
            if !valid {
                return Err(DeviceError::Range {
                    what,
                    value,
                    need: "the board reports a scale that is of no use".into(),
                });
            }
        }
        let mut step = decimal(info.position_per_count);
        // An encoder of so many counts per turn is known better than single precision holds it.
        let turn = match info.position_unit {
            PositionUnit::Radian => Some(std::f64::consts::TAU),
            PositionUnit::Degree => Some(360.0),
            PositionUnit::Metre | PositionUnit::Millimetre => None,
        };
        if let Some(turn) = turn.filter(|_| info.counts_per_revolution > 0) {
            let exact = turn / f64::from(info.counts_per_revolution);
            if ((step - exact) / exact).abs() < 1e-6 {
                step = exact;
            }
        }
        let per_unit = (1.0 / step).round();
        Ok(Self {
            tick_hz: f64::from(info.tick_hz),
            units: Units { u: info.drive_unit.symbol().into(), x: info.position_unit.symbol().into() },
            full_drive: decimal(info.drive_full_scale),
            step,
            per_unit: (per_unit >= 1.0 && (per_unit * step - 1.0).abs() < 1e-14).then_some(per_unit),
        })
    }

    /// Control tick, s.
    pub fn tick_s(&self) -> f64 {
        1.0 / self.tick_hz
    }

    /// Time of a tick, s.
    pub fn time(&self, tick: u64) -> f64 {
        tick as f64 / self.tick_hz
    }

    /// Position of a count, position units.
    pub fn position(&self, count: i32) -> f64 {
        // Dividing by 1000 gives the nearest number to 1.257 where multiplying by 0.001 does not.
        self.per_unit.map_or_else(|| f64::from(count) * self.step, |per_unit| f64::from(count) / per_unit)
    }

    /// Drive of a code, drive units.
    pub fn drive(&self, code: i32) -> f64 {
        f64::from(code) * self.full_drive / f64::from(FULL_SCALE_CODE)
    }

    /// Largest drive there is, drive units.
    pub fn drive_max(&self) -> f64 {
        self.full_drive
    }

    /// The nearest code of a positive drive.
    ///
    /// # Errors
    /// [`DeviceError::Range`] names `what`: it rounds to nothing, or is more than full drive.
    pub fn code(&self, what: &'static str, drive: f64) -> Result<i16, DeviceError> {
        let code = (drive / self.full_drive * f64::from(FULL_SCALE_CODE)).round();
        if code >= 1.0 && code <= f64::from(FULL_SCALE_CODE) {
            return Ok(code as i16);
        }
        let (least, most) = (self.drive(1), self.full_drive);
        Err(DeviceError::Range {
            what,
            value: drive,
            need: format!("it drives with {least:.2e} to {most} {}", self.units.u),
        })
    }

    /// The nearest number of counts of a distance, ≥ 0.
    ///
    /// # Errors
    /// [`DeviceError::Range`] names `what`: more than 2³⁰ counts.
    pub fn counts(&self, what: &'static str, distance: f64) -> Result<u32, DeviceError> {
        let counts = (distance / self.step).round();
        if (0.0..=f64::from(1 << 30)).contains(&counts) {
            return Ok(counts as u32);
        }
        let most = self.step * f64::from(1 << 30);
        Err(DeviceError::Range { what, value: distance, need: format!("at most {most:.3} {}", self.units.x) })
    }

    /// Ticks of a time, ≥ 1.
    ///
    /// # Errors
    /// [`DeviceError::Range`] names `what`.
    pub fn ticks(&self, what: &'static str, time_s: f64) -> Result<u32, DeviceError> {
        let ticks = (time_s * self.tick_hz).round();
        if (1.0..=f64::from(u32::MAX)).contains(&ticks) {
            return Ok(ticks as u32);
        }
        let most = f64::from(u32::MAX) / self.tick_hz;
        Err(DeviceError::Range { what, value: time_s, need: format!("1 tick to {most:.0} s") })
    }

    /// Phase advance per tick of a period.
    ///
    /// # Errors
    /// [`DeviceError::Range`] names `what`.
    pub fn phase_step(&self, what: &'static str, period_s: f64) -> Result<u32, DeviceError> {
        phase_step(period_s * self.tick_hz).ok_or_else(|| DeviceError::Range {
            what,
            value: period_s,
            need: "2 to 2³² control ticks".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::link::{DriveUnit, Settings, Text};

    use super::*;

    fn info(position_per_count: f32, counts_per_revolution: u32) -> Info {
        Info {
            protocol_version: 1,
            schema: 0,
            firmware: Text::new(),
            build: Text::new(),
            board: Text::new(),
            tick_hz: 10_000,
            counts_per_revolution,
            position_per_count,
            position_unit: PositionUnit::Radian,
            drive_full_scale: 12.0,
            drive_unit: DriveUnit::Volt,
            current_range_ma: 0,
        }
    }

    #[test]
    fn a_decimal_step_gives_decimal_positions() {
        let scale = Scale::new(&info(0.001, 0)).unwrap();
        assert_eq!((scale.position(1257), scale.position(-3)), (1.257, -0.003));
        assert_eq!(scale.time(12_345), 1.2345);
    }

    #[test]
    fn counts_per_turn_are_exact() {
        let settings = Settings::default();
        let scale = Scale::new(&info(settings.position_per_count, 4096)).unwrap();
        assert_eq!(scale.position(4096), std::f64::consts::TAU);
        // Unless the two do not belong together (a gear).
        assert_eq!(Scale::new(&info(0.001, 4096)).unwrap().step, 0.001);
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let scale = Scale::new(&info(0.001, 0)).unwrap();
        assert_eq!(scale.code("h1", 6.0).unwrap(), 16_384);
        for drive in [0.0, 1e-4, 12.1, f64::NAN] {
            assert!(scale.code("h1", drive).unwrap_err().to_string().starts_with("h1 = "), "{drive}");
        }
        assert!(scale.counts("travel", -1.0).is_err() && scale.counts("travel", f64::NAN).is_err());
        assert!(scale.ticks("duration_s", 1e-9).is_err() && scale.phase_step("period_s", 1e-9).is_err());
        assert!(Scale::new(&info(f32::NAN, 0)).is_err());
    }
}
