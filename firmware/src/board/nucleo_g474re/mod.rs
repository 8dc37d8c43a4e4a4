//! NUCLEO-G474RE with a full bridge and a quadrature encoder: docs/board-nucleo-g474re.md.

mod bridge;
mod ccm;
mod clock;
pub mod constants;
mod current;
mod encoder;
mod flash;
mod over_current;
mod protection;
mod serial;
mod start;
mod ticks;

pub use bridge::{Bridge, open_all_switches};
pub use clock::Microseconds;
pub use current::Current;
pub use encoder::{Quadrature, TransitionError};
pub use flash::{FlashError, SettingsFlash, acknowledge_ecc};
pub use over_current::OverCurrent;
pub use protection::Guard;
pub use serial::Serial;
pub use start::{Parts, start};
pub use ticks::{TickSlot, TickTimer};

use crate::board::{Board, RetainedRam};

/// What the tick needs.
pub struct Nucleo {
    encoder: Quadrature,
    bridge: Bridge,
    clock: Microseconds,
    guard: Guard,
    retained: RetainedRam,
}

impl Board for Nucleo {
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
