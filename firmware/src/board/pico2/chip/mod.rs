//! The registers of the RP2350, and what the HAL does with them: clocks, USB, the boot ROM's functions.

mod bridge;
mod clock;
mod encoder;
mod fatal;
mod flash;
mod pins;
mod protection;
mod registers;
mod serial;
mod start;
mod stop;
mod ticks;

pub use bridge::Bridge;
pub use clock::Microseconds;
pub use encoder::{Quadrature, TransitionError};
pub use fatal::{reset, switch_off};
pub use flash::{FlashError, SettingsFlash};
pub use protection::Guard;
pub use serial::Serial;
pub use start::{IMAGE_DEFINITION, Parts, start};
pub use stop::on_stop;
pub use ticks::{TickSlot, TickTimer};

use crate::board::{Board, RetainedRam};

/// What the tick needs.
pub struct Pico2 {
    encoder: Quadrature,
    bridge: Bridge,
    clock: Microseconds,
    guard: Guard,
    retained: RetainedRam,
}

impl Board for Pico2 {
    type Encoder = Quadrature;
    type Drive = Bridge;
    type Clock = Microseconds;
    type Protection = Guard;
    type Retained = RetainedRam;

    fn encoder(&mut self) -> &mut Quadrature {
        &mut self.encoder
    }
    fn drive(&mut self) -> &mut Bridge {
        &mut self.bridge
    }
    fn clock(&self) -> &Microseconds {
        &self.clock
    }
    fn protection(&mut self) -> &mut Guard {
        &mut self.guard
    }
    fn retained(&mut self) -> &mut RetainedRam {
        &mut self.retained
    }
}
