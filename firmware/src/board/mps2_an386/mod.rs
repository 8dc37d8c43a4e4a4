//! QEMU's mps2-an386: the virtual board.
//!
//! Encoder, power stage, clock and trips are in the simulated plant at the other end of UART1 ([`Lockstep`]); the link
//! is UART0. Time is virtual: one exchange is one tick, and between two exchanges it stands still.

mod flash;
mod lockstep;
mod meter;
mod uart;

pub use flash::SimulatedFlash;
pub use lockstep::{BOOT, Lockstep, Next, Received};
pub use meter::{Meter, done, panicked};
pub use uart::{Link, Uart};

use breakaway_core::link::FULL_SCALE_CODE;

use crate::board::{Applied, Clock, Drive, Encoder, Protection, RETAINED_WORDS, Retained, Trip};

/// Outside of what start-up code or QEMU touch at a reset: the retained words, and the flash image behind them.
const PSRAM: usize = 0x2100_0000;

/// What the tick sees of the simulated plant.
#[derive(Debug, Default)]
pub struct Virtual {
    count: Option<i32>,
    now_us: u32,
    enabled: bool,
    code: i16,
    trip: Option<Trip>,
}

impl Virtual {
    /// Takes what the plant says of the next tick, `period_us` after the last.
    pub fn next(&mut self, next: &Next, period_us: u32) {
        self.count = next.count;
        self.trip = next.trip;
        self.now_us = self.now_us.wrapping_add(period_us).wrapping_add(next.late_us);
    }

    /// The drive applied, drive codes.
    pub fn code(&self) -> i16 {
        if self.enabled { self.code } else { 0 }
    }
}

/// The simulated encoder does not answer.
#[derive(Clone, Copy, Debug)]
pub struct NoAnswer;

impl Encoder for Virtual {
    type Error = NoAnswer;

    fn count(&mut self) -> Result<i32, NoAnswer> {
        self.count.ok_or(NoAnswer)
    }
}

impl Drive for Virtual {
    type Error = core::convert::Infallible;

    fn enable(&mut self) -> Result<(), Self::Error> {
        (self.enabled, self.code) = (true, 0);
        Ok(())
    }

    fn apply(&mut self, command: i32) -> Result<Applied, Self::Error> {
        let full = i32::from(FULL_SCALE_CODE);
        self.code = command.clamp(-full, full) as i16;
        Ok(Applied { code: self.code(), limited: self.enabled && i32::from(self.code) != command })
    }

    fn off(&mut self) -> Result<(), Self::Error> {
        (self.enabled, self.code) = (false, 0);
        Ok(())
    }
}

impl Clock for Virtual {
    fn now_us(&self) -> u32 {
        self.now_us
    }
}

impl Protection for Virtual {
    fn tripped(&mut self) -> Option<Trip> {
        self.trip
    }

    /// There is none: ticks that stop are seen by whoever steps them.
    fn feed_watchdog(&mut self) {}
}

impl Retained for Virtual {
    fn read(&self) -> [u32; RETAINED_WORDS] {
        let words = PSRAM as *const u32;
        // SAFETY: the board's PSRAM, 16 MiB of which nothing else uses the first words.
        core::array::from_fn(|i| unsafe { words.add(i).read_volatile() })
    }

    fn write(&mut self, values: [u32; RETAINED_WORDS]) {
        let words = PSRAM as *mut u32;
        for (i, value) in values.into_iter().enumerate() {
            // SAFETY: as in `read`.
            unsafe { words.add(i).write_volatile(value) };
        }
    }
}
