//! Who the device is.

use heapless::String;
use serde::{Deserialize, Serialize};

/// A short text on the wire, UTF-8.
pub type Text = String<24>;

/// Identity and scales of a device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Info {
    /// [`PROTOCOL_VERSION`](super::PROTOCOL_VERSION). First field, for ever.
    pub protocol_version: u16,
    /// [`SCHEMA`](super::SCHEMA). Second field, for ever.
    pub schema: u32,
    /// Version of the firmware, e.g. `0.1.0`.
    pub firmware: Text,
    /// Build hash of the firmware.
    pub build: Text,
    /// Name of the board.
    pub board: Text,
    /// Control ticks per second.
    pub tick_hz: u32,
    /// Counts per revolution; 0 for a linear axis.
    pub counts_per_revolution: u32,
    /// Position units per count, > 0.
    pub position_per_count: f32,
    /// Unit of position.
    pub position_unit: PositionUnit,
    /// Drive units at [`FULL_SCALE_CODE`](super::FULL_SCALE_CODE), > 0.
    pub drive_full_scale: f32,
    /// Unit of drive.
    pub drive_unit: DriveUnit,
    /// Largest motor current that the device measures either way, mA; 0 where it measures none.
    pub current_range_ma: u32,
}

/// Unit of position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PositionUnit {
    /// rad.
    #[default]
    Radian,
    /// m.
    Metre,
    /// mm.
    Millimetre,
    /// deg.
    Degree,
}

/// Unit of drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum DriveUnit {
    /// V.
    #[default]
    Volt,
    /// A.
    Ampere,
    /// N.
    Newton,
    /// Nm.
    NewtonMetre,
}

impl PositionUnit {
    /// Every unit.
    pub const ALL: [Self; 4] = [Self::Radian, Self::Metre, Self::Millimetre, Self::Degree];

    /// Its symbol, as in recordings.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Radian => "rad",
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Degree => "deg",
        }
    }
}

impl DriveUnit {
    /// Every unit.
    pub const ALL: [Self; 4] = [Self::Volt, Self::Ampere, Self::Newton, Self::NewtonMetre];

    /// Its symbol, as in recordings.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Volt => "V",
            Self::Ampere => "A",
            Self::Newton => "N",
            Self::NewtonMetre => "Nm",
        }
    }
}

/// Id, protocol version and schema of a message that answers [`Command::Hello`](super::Command::Hello), from a device of
/// any version; `None` for every other message.
#[must_use]
pub fn peer_version(message: &[u8]) -> Option<(u16, u16, u32)> {
    // Message::Reply and Reply::Info are both number 0, for ever.
    let ((message, id, reply, version, schema), _) =
        postcard::take_from_bytes::<(u8, u16, u8, u16, u32)>(message).ok()?;
    (message == 0 && reply == 0).then_some((id, version, schema))
}
