//! The settings of a device.

use serde::{Deserialize, Serialize};

use super::{DriveUnit, Field, PositionUnit};

/// Limits, guards and scales. Limits end an experiment or cut the drive; guards raise a fault.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Limit: largest drive either way, drive codes, ≥ 1.
    pub drive_max_code: i16,
    /// Limit: lowest position, counts.
    pub travel_min_counts: i32,
    /// Limit: highest position, counts, above the lowest.
    pub travel_max_counts: i32,
    /// Limit: speed, counts/s, 1 ..= 2³¹ − 1.
    pub speed_max_counts_per_s: u32,
    /// Limit: motor current, mA; 0 for none. More than the board measures is refused, and anything else where it measures none.
    pub current_max_ma: u32,
    /// Limit: |drive| averaged over about a second, drive codes, ≥ 1: what the motor stands for long when it stands still.
    pub mean_drive_max_code: i16,
    /// Guard: driven for this many ticks in all without motion (4 counts) is a frozen encoder, 1 ..= 2²⁴.
    pub frozen_ticks: u32,
    /// Guard: |drive| from which the axis is expected to move, drive codes, ≥ 1.
    pub frozen_drive_code: i16,
    /// Guard: most counts in one tick, 1 ..= 2³¹ − 1.
    pub jump_counts: u32,
    /// Guard: late ticks in a row, ≥ 1.
    pub overrun_limit: u8,
    /// Guard: longest silence of the host while moving, ms, 10 ..= 3 600 000.
    pub command_timeout_ms: u32,
    /// Hysteresis of the relays, counts ≤ 2³⁰.
    pub hysteresis_counts: u32,
    /// The encoder counts down when a positive drive moves the axis.
    pub encoder_reversed: bool,
    /// Counts per revolution, ≤ 2²⁴; 0 for a linear axis.
    pub counts_per_revolution: u32,
    /// Position units per count, > 0.
    pub position_per_count: f32,
    /// Unit of position.
    pub position_unit: PositionUnit,
    /// Drive units at full scale code, > 0.
    pub drive_full_scale: f32,
    /// Unit of drive. With A a current loop is closed in each tick of a run, on a board that measures the current.
    pub drive_unit: DriveUnit,
    /// After a run the motor's own current holds it: both ends are at the same side of the supply. Where the power
    /// stage cannot do that, the motor coasts. It coasts after a trip and a reset in any case.
    pub brake: bool,
    /// Voltage of the bridge at full duty, V, > 0: what the current loop drives with.
    pub supply_v: f32,
    /// Resistance of the motor with bridge and shunt, Ω, ≥ 0; 0 where it is not known, and no current loop can be closed.
    pub motor_resistance_ohm: f32,
    /// Inductance of the motor, H, ≥ 0; 0 where it is not known.
    pub motor_inductance_h: f32,
    /// Bandwidth of the current loop, Hz, ≥ 0; 0: the largest that leaves 60° of phase.
    pub current_bandwidth_hz: f32,
}

/// Which setting is out of range.
pub type SettingsError = Field;

impl Default for Settings {
    /// A 4096-count encoder on a 24 V supply, at half drive and within ten revolutions either way. That is enough to
    /// move any axis gently, too little to wind one up. For longer than about a second, an eighth of the drive, which
    /// a motor of that voltage stands when it is blocked.
    fn default() -> Self {
        Self {
            drive_max_code: i16::MAX / 2,
            travel_min_counts: -40_960,
            travel_max_counts: 40_960,
            speed_max_counts_per_s: 1_000_000,
            current_max_ma: 0,
            // A stalled brushed motor draws five to ten times its rated current at its rated voltage. An eighth is about rated.
            mean_drive_max_code: i16::MAX / 8,
            frozen_ticks: 5_000,
            frozen_drive_code: i16::MAX / 4,
            jump_counts: 1_000,
            overrun_limit: 3,
            command_timeout_ms: 1_000,
            hysteresis_counts: 2,
            encoder_reversed: false,
            counts_per_revolution: 4_096,
            position_per_count: core::f32::consts::TAU / 4_096.0,
            position_unit: PositionUnit::Radian,
            drive_full_scale: 24.0,
            drive_unit: DriveUnit::Volt,
            brake: false,
            supply_v: 24.0,
            motor_resistance_ohm: 0.0,
            motor_inductance_h: 0.0,
            current_bandwidth_hz: 0.0,
        }
    }
}

impl Settings {
    /// Whether both have the same travel limits.
    #[must_use]
    pub fn same_travel(&self, other: &Self) -> bool {
        (self.travel_min_counts, self.travel_max_counts) == (other.travel_min_counts, other.travel_max_counts)
    }

    /// Checks every range.
    ///
    /// # Errors
    /// [`SettingsError`] names the first setting out of range.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let signed = 1..=i32::MAX as u32;
        let positive = |value: f32| value.is_finite() && value > 0.0;
        let known = |value: f32| value.is_finite() && value >= 0.0;
        for (valid, field) in [
            (self.drive_max_code >= 1, Field::DriveMax),
            (self.travel_max_counts > self.travel_min_counts, Field::TravelMax),
            (signed.contains(&self.speed_max_counts_per_s), Field::SpeedMax),
            (self.mean_drive_max_code >= 1, Field::MeanDriveMax),
            ((1..=1 << 24).contains(&self.frozen_ticks), Field::FrozenTicks),
            (self.frozen_drive_code >= 1, Field::FrozenDrive),
            (signed.contains(&self.jump_counts), Field::JumpCounts),
            (self.overrun_limit >= 1, Field::OverrunLimit),
            ((10..=3_600_000).contains(&self.command_timeout_ms), Field::CommandTimeout),
            (self.hysteresis_counts <= 1 << 30, Field::Hysteresis),
            (self.counts_per_revolution <= 1 << 24, Field::CountsPerRevolution),
            (positive(self.position_per_count), Field::PositionPerCount),
            (positive(self.drive_full_scale), Field::DriveFullScale),
            (positive(self.supply_v), Field::Supply),
            (known(self.motor_resistance_ohm), Field::Resistance),
            (known(self.motor_inductance_h), Field::Inductance),
            (known(self.current_bandwidth_hz), Field::CurrentBandwidth),
        ] {
            if !valid {
                return Err(field);
            }
        }
        Ok(())
    }
}
