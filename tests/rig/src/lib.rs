//! A board in memory: what the application meets outside of the microcontroller, in process and in virtual time.

mod flash;
mod run;
mod world;

pub use flash::{ALWAYS, Cut, Ram};
pub use run::{FULL_SCALE, STEP, TICK_HZ, code, relay};
pub use world::{Motion, Shared, World};
