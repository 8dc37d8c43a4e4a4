//! Microseconds, from TIMER0: it counts ticks of the crystal, which the HAL divides to 1 MHz.

use super::registers::timer;
use crate::board::Clock;

/// The free-running counter.
pub struct Microseconds(pub(super) ());

impl Clock for Microseconds {
    fn now_us(&self) -> u32 {
        timer().timerawl().read().bits()
    }
}
