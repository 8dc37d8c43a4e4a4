//! What a board gives to the application.
//!
//! - To the tick, a [`Board`]: an [`Encoder`], a [`Drive`], a [`Clock`], a [`Protection`] and memory that is
//!   [`Retained`] through a reset.
//! - To the thread beside it, a [`Wire`] for the link and a flash (`embedded_storage::nor_flash`).
//!
//! PWM and pins are those of embedded-hal 1.0, so that any HAL's types fit. It has no traits for encoders and clocks,
//! so these are our own. A board file implements them, and a `bin/` ties them together. It makes the
//! [`crate::app::Channels`], and gives one end to the tick's interrupt and the other to the thread.

mod clock;
mod drive;
mod encoder;
#[cfg(all(target_os = "none", feature = "board-mps2-an386"))]
#[allow(unsafe_code, reason = "registers and fixed addresses of the board")]
pub mod mps2_an386;
#[cfg(all(target_os = "none", feature = "board-nucleo-g474re"))]
#[allow(unsafe_code, reason = "interrupt and retained RAM of the board")]
pub mod nucleo_g474re;
#[cfg(any(not(target_os = "none"), feature = "board-pico2"))]
pub mod pico2;
mod protection;
#[cfg(all(target_os = "none", any(feature = "board-nucleo-g474re", feature = "board-pico2")))]
#[allow(unsafe_code, reason = "a static that start-up code leaves alone")]
mod retained_ram;
#[cfg(all(target_os = "none", any(feature = "board-mps2-an386", feature = "board-nucleo-g474re")))]
#[allow(unsafe_code, reason = "routines that the compiler calls")]
pub mod routines;
mod sign_magnitude;
mod wire;

pub use clock::{Clock, elapsed_us};
pub use drive::{Applied, Drive, FULL_SCALE};
pub use encoder::{Encoder, travel};
pub use protection::{Protection, RETAINED_WORDS, Retained, Trip};
#[cfg(all(target_os = "none", any(feature = "board-nucleo-g474re", feature = "board-pico2")))]
pub use retained_ram::RetainedRam;
pub use sign_magnitude::{ConfigError, DriveError, Limits, SignMagnitude};
pub use wire::Wire;

/// All that the tick needs. A struct with these five fields and five getters is enough. A type that implements all
/// five itself, as the virtual board's does, is a board as it is.
pub trait Board {
    /// Position.
    type Encoder: Encoder;
    /// Power stage.
    type Drive: Drive;
    /// Time.
    type Clock: Clock;
    /// Trips and watchdog.
    type Protection: Protection;
    /// Memory for the fault record.
    type Retained: Retained;

    /// The position sensor.
    fn encoder(&mut self) -> &mut Self::Encoder;
    /// The power stage.
    fn drive(&mut self) -> &mut Self::Drive;
    /// The clock.
    fn clock(&self) -> &Self::Clock;
    /// Trips and watchdog.
    fn protection(&mut self) -> &mut Self::Protection;
    /// Memory that outlives a reset.
    fn retained(&mut self) -> &mut Self::Retained;
}

impl<T: Encoder + Drive + Clock + Protection + Retained> Board for T {
    type Encoder = Self;
    type Drive = Self;
    type Clock = Self;
    type Protection = Self;
    type Retained = Self;

    fn encoder(&mut self) -> &mut Self {
        self
    }
    fn drive(&mut self) -> &mut Self {
        self
    }
    fn clock(&self) -> &Self {
        self
    }
    fn protection(&mut self) -> &mut Self {
        self
    }
    fn retained(&mut self) -> &mut Self {
        self
    }
}
