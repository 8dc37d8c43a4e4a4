//! The link between the board and the host: messages and frames, used unchanged on both sides.
//!
//! The host sends a [`Request`]; the device answers each with a [`Message::Reply`] of the same id, and sends
//! [`Message::Event`] and [`Message::Samples`] unasked. A message is postcard; a frame is COBS(message, CRC-32) and a
//! zero byte ([`encode`], [`Decoder`]). `docs/link.md` has the tables.
//!
//! **Numbers.** What the tick computes with is integers: positions in encoder counts, drives in codes of
//! 1/[`FULL_SCALE_CODE`] of full drive, times in ticks. What is physics (model, gains, trajectories) is f32 in the units
//! of [`Info`], which also says what a count, a code and a tick are.
//!
//! **Compatibility.** [`Command::Hello`] and the first two fields of [`Info`] never change, so that two versions can
//! tell each other apart ([`peer_version`]). Everything else may, with [`PROTOCOL_VERSION`]: the golden vectors in
//! `golden.txt` fail otherwise.

mod command;
mod error;
mod event;
mod field;
mod frame;
mod info;
mod model;
mod reply;
mod sample;
mod set_point;
mod settings;
mod validate;

pub use command::{
    Adaptive, Bounds, Command, ControllerGains, ErrorRate, OpenLoop, Pid, Push, Reference, Relay, Request, Track,
    Trajectory, WaveformPart,
};
pub use error::{CommandError, Rejected};
pub use event::{Ended, Ending, Event, FaultCause, FaultRecord, Limit, Mismatch};
pub use field::Field;
pub use frame::{Decoder, EncodeError, FrameError, MAX_FRAME, MAX_MESSAGE, checksum, encode};
pub use info::{DriveUnit, Info, PositionUnit, Text, peer_version};
pub use model::{EffectId, Model, WireEffect};
pub use reply::{Estimate, IdentificationVerdict, Identified, Message, Reply, Sine, Status};
pub use sample::{BATCH_BYTES, Batch, BatchError, BatchWriter, Mode, Sample};
pub use set_point::{Following, MOST_AHEAD, SET_POINTS, SetPoint, SetPoints};
pub use settings::{Settings, SettingsError};

/// Version of the messages and frames. Raised with every change of the golden vectors that leaves the house.
pub const PROTOCOL_VERSION: u16 = 5;
/// The baud rate of boards whose link has one.
pub const BAUD: u32 = 921_600;
/// The drive code of full drive.
pub const FULL_SCALE_CODE: i16 = i16::MAX;
/// Fingerprint of the wire format: the FNV-1a hash of the golden vectors.
pub const SCHEMA: u32 = crate::fnv::fnv1a(include_bytes!("golden.txt"));
