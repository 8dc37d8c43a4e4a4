//! What a board gives to the application: an [`Encoder`], a [`Drive`] and a [`Clock`].
//!
//! PWM and pins are those of embedded-hal 1.0, so that any HAL's types fit; it has no traits for encoders and
//! clocks, so these are our own.

mod clock;
mod drive;
mod encoder;
mod sign_magnitude;

pub use clock::{Clock, elapsed_us};
pub use drive::{Applied, Drive, FULL_SCALE};
pub use encoder::{Encoder, travel};
pub use sign_magnitude::{ConfigError, DriveError, Limits, SignMagnitude};
