//! What the device says unasked.

use serde::{Deserialize, Serialize};

use super::Mode;

/// Something happened. New events are added at the end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event {
    /// The device has started; sent once after every reset.
    Started,
    /// A fault was latched; the drive is off.
    FaultRaised(FaultRecord),
    /// An experiment is over; the drive is 0 and the limits are those of the settings again.
    ExperimentEnded(Ended),
    /// The motion no longer follows the loaded model.
    ModelMismatch(Mismatch),
}

/// A latched fault with the numbers that caused it. It survives a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// What happened.
    pub cause: FaultCause,
    /// What was active.
    pub mode: Mode,
    /// When, ticks since the reset before the fault.
    pub tick: u32,
    /// Position then, counts.
    pub count: i32,
    /// Applied drive then, drive codes.
    pub drive_code: i16,
    /// The number that raised it, in the unit of the cause's setting.
    pub value: i32,
    /// The limit it passed.
    pub limit: i32,
}

/// What raises a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FaultCause {
    /// Driven at `frozen_drive_code` or more, either way, for `frozen_ticks` in all (value: ticks) without motion,
    /// which is 4 counts. The encoder or one of its channels is dead.
    EncoderFrozen,
    /// The count changed by more than `jump_counts` in one tick (value: counts).
    EncoderJump,
    /// The encoder did not answer, or has lost its count.
    EncoderError,
    /// `overrun_limit` ticks in a row were late, or more did not come (value: ticks).
    TickOverrun,
    /// No command for `command_timeout_ms` while moving (value: ms).
    LinkLost,
    /// A protection of the power stage or of the controller (value: the board's number of it): over-temperature, supply,
    /// clock.
    BreakInput,
    /// The supply is missing or out of range (value: mV).
    Supply,
    /// The power stage could not be set.
    DriveStage,
    /// The watchdog reset the device: no valid tick was completed in time.
    Watchdog,
    /// The program panicked and the device was reset.
    Panic,
    /// The saved settings were damaged or of another version; defaults are in use.
    SettingsLost,
    /// The saved model was damaged or of another version; none is loaded.
    ModelLost,
    /// The axis gains speed against the drive (value: its work so far, in counts at `frozen_drive_code`). Encoder or
    /// motor is connected the wrong way round, and no loop may be closed.
    WrongDirection,
    /// The device was reset (pin, supply) while the drive was on (value: tick at which the run had started).
    ResetWhileDriven,
    /// The controller's output was not a finite number.
    NotFinite,
    /// The emergency stop is open.
    EmergencyStop,
    /// The current was above the level at which the board's own comparator switches off (limit: mA of the
    /// level). The value is in mA, of the tick that saw it, when the current may have fallen already.
    OverCurrent,
    /// The current is limited, and what measures it is not there or contradicts itself.
    CurrentSensor,
}

impl FaultCause {
    /// Every cause.
    pub const ALL: [Self; 18] = [
        Self::EncoderFrozen,
        Self::EncoderJump,
        Self::EncoderError,
        Self::TickOverrun,
        Self::LinkLost,
        Self::BreakInput,
        Self::Supply,
        Self::DriveStage,
        Self::Watchdog,
        Self::Panic,
        Self::SettingsLost,
        Self::ModelLost,
        Self::WrongDirection,
        Self::ResetWhileDriven,
        Self::NotFinite,
        Self::EmergencyStop,
        Self::OverCurrent,
        Self::CurrentSensor,
    ];
}

/// The end of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ended {
    /// What it was.
    pub mode: Mode,
    /// How it ended.
    pub ending: Ending,
    /// Tick of the end; no later sample belongs to it.
    pub tick: u32,
    /// Ticks it lasted.
    pub ticks: u32,
    /// Ticks in which a controller asked for more drive than the limit in force; 0 where none ran.
    pub saturated: u32,
}

/// How an experiment ended. Only [`Ending::Settled`], [`Ending::Homed`] and, where it was asked for, [`Ending::TimeUp`] are a
/// success.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// Its ticks are up.
    TimeUp,
    /// The limit cycle has settled.
    Settled {
        /// Cycles seen.
        cycles: u16,
    },
    /// A limit cycle that differs between the directions.
    Asymmetric {
        /// Cycles seen.
        cycles: u16,
    },
    /// There is no limit cycle: no motion, or it died (h2 ≤ f1). A push that moves nothing ends so too.
    NoLimitCycle,
    /// A limit was reached. This is not a fault.
    Limit {
        /// Which.
        limit: Limit,
        /// The value that reached it, in the limit's unit.
        value: i32,
    },
    /// The host stopped it.
    Stopped,
    /// A fault.
    Fault(FaultCause),
    /// A stop was found, and the count there is what was asked for.
    Homed,
}

/// A limit of the settings or of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Limit {
    /// Travel limits of the settings (counts).
    Travel,
    /// Travel of the experiment (counts from the start).
    Bound,
    /// Speed (counts/s).
    Speed,
    /// Current (mA).
    Current,
    /// Mean drive (drive codes).
    MeanDrive,
    /// Without set-points for as long as the run said (ticks).
    SetPoints,
}

/// Where measurement and model disagree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mismatch {
    /// −1, 0 or 1: direction of motion, 0 for both.
    pub direction: i8,
    /// Bin of the speed when it was found, 0 the slowest of 16 up to the reference's largest speed.
    pub speed_bin: u8,
    /// Bin of the position in which it is largest, of 16 over the travel seen.
    pub position_bin: u8,
    /// Mean residual over its standard error; below 0 where the missing force acts against the motion.
    pub score: f32,
}
