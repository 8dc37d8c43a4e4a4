//! The fields that an error can name.

use serde::{Deserialize, Serialize};

macro_rules! fields {
    ($($field:ident $name:literal $need:literal,)*) => {
        /// A field of a command, of the settings or of the model. New ones are added at the end.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
        pub enum Field {
            $(#[doc = concat!("`", $name, "`: ", $need, ".")] $field,)*
        }

        impl Field {
            /// Every field.
            pub const ALL: &'static [Self] = &[$(Self::$field,)*];

            /// Its name, as in the settings and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$field => $name,)* }
            }
            /// What is valid.
            #[must_use]
            pub const fn need(self) -> &'static str {
                match self { $(Self::$field => $need,)* }
            }
        }
    };
}

fields! {
    DriveMax "drive_max_code" "1 to 32767 drive codes, and what the board's power stage can give",
    TravelMin "travel_min_counts" "below travel_max_counts",
    TravelMax "travel_max_counts" "above travel_min_counts",
    SpeedMax "speed_max_counts_per_s" "1 to 2147483647 counts/s",
    CurrentMax "current_max_ma" "mA that the board measures (`device … info`); 0 for no limit, and where it measures none",
    MeanDriveMax "mean_drive_max_code" "1 to 32767 drive codes",
    FrozenTicks "frozen_ticks" "1 to 16777216 ticks",
    FrozenDrive "frozen_drive_code" "1 to 32767 drive codes",
    JumpCounts "jump_counts" "1 to 2147483647 counts",
    OverrunLimit "overrun_limit" "1 to 255 ticks",
    CommandTimeout "command_timeout_ms" "10 to 3600000 ms",
    Hysteresis "hysteresis_counts" "0 to 1073741824 counts",
    EncoderReversed "encoder_reversed" "true or false",
    CountsPerRevolution "counts_per_revolution" "1 to 16777216; 0 for a linear axis",
    PositionPerCount "position_per_count" "finite and above 0",
    DriveFullScale "drive_full_scale" "finite and above 0",
    H1 "h1" "1 to 32767 drive codes",
    H2 "h2" "1 to 32767 drive codes, h1 + h2 at most 32767",
    ReferenceAmplitude "reference.amplitude" "0 or more counts",
    PhaseStep "phase_step" "at most half a turn per tick",
    Amplitude "amplitude" "1 to 32767 drive codes",
    Centring "centring" "0 or more",
    BoundDrive "bounds.drive_max_code" "0 to 32767 drive codes",
    BoundTravel "bounds.travel_counts" "0 to 2147483647 counts",
    TrajectorySize "trajectory size" "finite, and within the travel limits",
    TrajectoryTime "trajectory time" "finite and above 0",
    Kp "kp" "finite and at least 0",
    Ki "ki" "finite and at least 0",
    Kd "kd" "finite and at least 0",
    Kv "kv" "finite and above 0",
    Lambda1 "lambda1" "finite and above 0",
    Lambda2 "lambda2" "finite and above 0",
    Delta "delta" "finite, and at least half of the speed that a count makes behind filter_s and observer_rad_s",
    Rates "rates" "finite and at least 0",
    WaveformOffset "waveform offset" "offset + length at most 512 points",
    Decimation "decimation" "1 or more",
    B "b" "finite and above 0",
    C "c" "finite and at least 0",
    F1 "f1" "finite and at least 0",
    EffectKind "effect" "one of this firmware's catalogue (`breakaway effects`)",
    EffectParameters "effect parameters" "as many as the catalogue says, each within its range",
    Brake "brake" "true or false",
    PushDrive "push drive" "not 0, and within mean_drive_max_code either way",
    PushTicks "push ticks" "1 or more",
    Filter "filter_s" "finite and at least 0",
    Observer "observer_rad_s" "finite and at least 0",
    Ahead "ahead" "1 to 31 set-points",
    HoldTicks "hold_ticks" "1 to 16777216 ticks",
    SetPointTicks "set-point ticks" "1 to 16777216 ticks after the one before",
    SetPointPosition "set-point position" "finite, and the way to it within the travel limits",
    SetPointVelocity "set-point velocity" "finite, and the speed on the way to it within speed_max_counts_per_s",
    SetPointSequence "set-point sequence" "at most that of the next set-point that the device wants",
    DriveUnit "drive_unit" "V, A, N or Nm; A where the board measures the motor's current",
    Supply "supply_v" "finite and above 0",
    Resistance "motor_resistance_ohm" "finite and at least 0; above 0 where drive_unit is A",
    Inductance "motor_inductance_h" "finite and at least 0; 0 where it is not known",
    CurrentBandwidth "current_bandwidth_hz" "at least 0; 0 for the largest, which leaves 60° of phase",
}
