//! What the device sends.

use serde::{Deserialize, Serialize};

use super::{Batch, CommandError, Event, FaultRecord, Following, Info, Mode, Model, Settings};
use crate::estimate::modulating::{Parameter, Refusal};

/// A message of the device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // All of them live in one buffer; boxes do not exist here.
pub enum Message {
    /// The answer to a request.
    Reply {
        /// The request's id.
        id: u16,
        /// The answer.
        reply: Reply,
    },
    /// Something happened.
    Event(Event),
    /// Samples of the stream.
    Samples(Batch),
}

impl Message {
    /// Reads a message from a frame; `None` if it is none of this version.
    #[must_use]
    pub fn decode(message: &[u8]) -> Option<Self> {
        match postcard::take_from_bytes(message) {
            Ok((message, [])) => Some(message),
            _ => None,
        }
    }
}

/// The answer to a request. New ones are added at the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)]
pub enum Reply {
    /// To `Hello`. Number 0, for ever.
    Info(Info),
    /// Done.
    Done,
    /// Not done.
    Error(CommandError),
    /// To `Status`.
    Status(Status),
    /// To `GetSettings`.
    Settings(Settings),
    /// To `GetModel`; `None` if none is loaded.
    Model(Option<Model>),
    /// To `GetFault`; `None` if none is latched.
    Fault(Option<FaultRecord>),
    /// To `Identify`.
    Identified(Identified),
    /// To `SetPoints`.
    Following(Following),
}

/// What the device is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// Active mode.
    pub mode: Mode,
    /// Ticks since the reset, wraps.
    pub tick: u32,
    /// Position, counts.
    pub count: i32,
    /// Applied drive, drive codes.
    pub drive_code: i16,
    /// Every n-th sample is sent; 0: none.
    pub decimation: u16,
    /// Samples dropped on the board since the reset because the link was too slow, wraps.
    pub dropped: u32,
    /// Frames received damaged since the reset, wraps.
    pub bad_frames: u32,
    /// Ticks that ran late since the reset, wraps.
    pub overruns: u32,
    /// Settings or model differ from what is saved.
    pub unsaved: bool,
    /// Nothing but a push starts before the axis is homed or zeroed ([`CommandError::NotZeroed`]).
    pub zero_needed: bool,
}

/// A value and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value.
    pub value: f32,
    /// Its standard error, ≥ 0.
    pub se: f32,
}

/// What the board makes of its relay experiments, in the units of [`Info`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// Whether the numbers can be used.
    pub verdict: IdentificationVerdict,
    /// Inertia.
    pub b: Estimate,
    /// Viscous friction and back-EMF.
    pub c: Estimate,
    /// Coulomb friction.
    pub f1: Estimate,
    /// Constant load, where it was asked for.
    pub load: Option<Estimate>,
    /// Rms of the equation's residual, drive units.
    pub residual: f32,
    /// Condition of the scaled normal matrix.
    pub condition: f32,
    /// Windows used.
    pub windows: u32,
    /// The sine fit of the last experiment's position, where it could be made.
    pub sine: Option<Sine>,
}

/// A sine fit on the board (docs/theory.md, section 3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sine {
    /// Position units.
    pub amplitude: Estimate,
    /// rad/s.
    pub omega: Estimate,
    /// At the middle of the record, rad.
    pub phase_centre: Estimate,
    /// Position units.
    pub offset: Estimate,
    /// Residual standard deviation, position units.
    pub rms: f32,
    /// Periods in the record.
    pub cycles: f32,
}

/// Whether the data determine the model; as [`Refusal`], which has the advice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum IdentificationVerdict {
    /// Yes.
    Determined,
    /// [`Refusal::TooShort`].
    TooShort,
    /// [`Refusal::NoMotion`].
    NoMotion,
    /// [`Refusal::NotFinite`].
    NotFinite,
    /// [`Refusal::OneDirection`].
    OneDirection,
    /// [`Refusal::SingleSpeed`].
    SingleSpeed,
    /// Inertia.
    UndeterminedB,
    /// Viscous friction.
    UndeterminedC,
    /// Coulomb friction.
    UndeterminedF1,
    /// Load.
    UndeterminedLoad,
    /// Samples were lost in the experiment: repeat it.
    Gaps,
}

impl From<Refusal> for IdentificationVerdict {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::TooShort => Self::TooShort,
            Refusal::NoMotion => Self::NoMotion,
            Refusal::NotFinite => Self::NotFinite,
            Refusal::OneDirection => Self::OneDirection,
            Refusal::SingleSpeed => Self::SingleSpeed,
            Refusal::Undetermined(Parameter::Inertia) => Self::UndeterminedB,
            Refusal::Undetermined(Parameter::Damping) => Self::UndeterminedC,
            Refusal::Undetermined(Parameter::Coulomb) => Self::UndeterminedF1,
            Refusal::Undetermined(Parameter::Load) => Self::UndeterminedLoad,
        }
    }
}

impl IdentificationVerdict {
    /// Every verdict.
    pub const ALL: [Self; 11] = [
        Self::Determined,
        Self::TooShort,
        Self::NoMotion,
        Self::NotFinite,
        Self::OneDirection,
        Self::SingleSpeed,
        Self::UndeterminedB,
        Self::UndeterminedC,
        Self::UndeterminedF1,
        Self::UndeterminedLoad,
        Self::Gaps,
    ];

    /// What to do; `None` if nothing is wrong.
    #[must_use]
    pub const fn advice(self) -> Option<&'static str> {
        Some(match self {
            Self::Determined => return None,
            Self::TooShort => Refusal::TooShort.advice(),
            Self::NoMotion => Refusal::NoMotion.advice(),
            Self::NotFinite => Refusal::NotFinite.advice(),
            Self::OneDirection => Refusal::OneDirection.advice(),
            Self::SingleSpeed => Refusal::SingleSpeed.advice(),
            Self::UndeterminedB => Refusal::Undetermined(Parameter::Inertia).advice(),
            Self::UndeterminedC => Refusal::Undetermined(Parameter::Damping).advice(),
            Self::UndeterminedF1 => Refusal::Undetermined(Parameter::Coulomb).advice(),
            Self::UndeterminedLoad => Refusal::Undetermined(Parameter::Load).advice(),
            Self::Gaps => "samples were lost during the experiment: run it again",
        })
    }
}
