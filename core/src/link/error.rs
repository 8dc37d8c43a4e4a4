//! Why a command was not carried out.

use serde::{Deserialize, Serialize};

use super::{Field, Mode, SettingsError};
use crate::says::says;

/// Why a command was not carried out. New reasons are added at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CommandError {
    /// The frame was whole, the command was not one this device knows.
    Malformed,
    /// A field is out of range.
    Range(Field),
    /// A setting is out of range; none was changed.
    Settings(SettingsError),
    /// Not while this mode is active: stop first.
    Busy(Mode),
    /// A fault is latched: read it, remove its cause, clear it.
    Faulted,
    /// There is nothing to identify: run a relay experiment first.
    NothingRecorded,
    /// The storage could not be written; what was saved before is still there.
    Storage,
    /// This board or build cannot do it.
    Unsupported,
    /// The cause of the fault is still there (break input, missing supply, encoder).
    FaultPersists,
    /// The start position is outside the travel limits.
    OutsideTravel,
    /// The travel limits are saved ones, and the count starts where the axis stood at the reset: home or zero it first.
    NotZeroed,
    /// No set-points are wanted: no run along them is under way.
    NotFollowing,
}

says! { CommandError:
    Self::Malformed => "the command is not one that the device knows",
    Self::Range(field) => "{} is out of range: it must be {}" (field.name(), field.need()),
    Self::Settings(field) => "the setting {} is out of range: it must be {}" (field.name(), field.need()),
    Self::Busy(mode) => "the device is in mode `{}`: stop it first" (mode.name()),
    Self::Faulted => "a fault is latched: remove its cause and clear it",
    Self::NothingRecorded => "there is nothing to identify: run a relay experiment on it first",
    Self::Storage => "its flash could not be written; what was saved before is still there",
    Self::Unsupported => "this board or firmware cannot do it",
    Self::FaultPersists => "the cause of the fault is still there; remove it first",
    Self::OutsideTravel => "the start position is outside the travel limits",
    Self::NotZeroed => "its travel limits mean nothing before it is zeroed: home it, or zero it where it stands",
    Self::NotFollowing => "it does not follow set-points: the run along them is over, or was not started",
}

/// A frame that is no valid request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// The id to answer under, where it could be read.
    pub id: Option<u16>,
    /// The answer.
    pub error: CommandError,
}

says! { Rejected:
    Self { error, .. } => "{error}",
}
