//! The lock-step with the simulated plant, on UART1 (docs/virtual-board.md).
//!
//! Plant to board, by first byte:
//! - 0x00 … 0x7f: a tick; the count has changed by this, a signed 7-bit number. One byte for most ticks: the bytes
//!   that QEMU passes in are what a tick costs.
//! - 0x80, i32: a tick at this count.
//! - 0x81, what (u8), i32: a condition of the ticks to come (`Lockstep::condition`).
//! - 0x82, ticks per second (u32), length (u8), settings (postcard): the start.
//!
//! Board to plant, i16: the drive code applied after each tick; or [`BOOT`] after a reset, which asks for the start.
//! Numbers are little-endian.

use breakaway_core::link::Settings;

use super::uart::Uart;
use crate::board::Trip;

/// What a board says when it has started; no drive code.
pub const BOOT: i16 = i16::MIN;

/// Longest message: a start with its settings.
const LONGEST: usize = 6 + 128;

/// What the plant says of the next tick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Next {
    /// Encoder count; `None` if the encoder does not answer.
    pub count: Option<i32>,
    /// How late the tick comes, µs.
    pub late_us: u32,
    /// What is tripped.
    pub trip: Option<Trip>,
}

/// What has arrived.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // One at a time, on the stack.
pub enum Received {
    /// Time for a tick.
    Tick(Next),
    /// Ticks per second, and settings of the machine for a board that has none of its own.
    Start(u32, Settings),
}

/// The plant's end of the board.
#[derive(Debug)]
pub struct Lockstep {
    uart: Uart,
    message: [u8; LONGEST],
    length: usize,
    count: i32,
    dead: bool,
    next: Next,
}

impl Lockstep {
    /// Announces the board.
    #[must_use]
    pub fn new(uart: Uart) -> Self {
        let mut lockstep =
            Self { uart, message: [0; LONGEST], length: 0, count: 0, dead: false, next: Next::default() };
        lockstep.answer(BOOT);
        lockstep
    }

    /// The drive code applied after a tick.
    pub fn answer(&mut self, code: i16) {
        for byte in code.to_le_bytes() {
            self.uart.send(byte);
        }
    }

    /// Takes a byte, if there is one; a message when it is complete.
    pub fn poll(&mut self) -> Option<Received> {
        let byte = self.uart.receive()?;
        if let Some(slot) = self.message.get_mut(self.length) {
            *slot = byte;
            self.length += 1;
        }
        let message = self.message.get(..self.length)?;
        let received = match *message {
            [step @ 0..=0x7f] => {
                // Bit 6 is the sign.
                let step = i32::from((step << 1).cast_signed() >> 1);
                self.count = self.count.wrapping_add(step);
                Some(self.tick())
            }
            [0x80, a, b, c, d] => {
                self.count = i32::from_le_bytes([a, b, c, d]);
                Some(self.tick())
            }
            [0x81, what, a, b, c, d] => {
                self.condition(what, i32::from_le_bytes([a, b, c, d]));
                None
            }
            [0x82, a, b, c, d, length, ref settings @ ..] if settings.len() >= usize::from(length) => {
                let settings = postcard::from_bytes(settings).unwrap_or_default();
                Some(Received::Start(u32::from_le_bytes([a, b, c, d]), settings))
            }
            // Not complete; what is none of these, or too long, is thrown away.
            [0x80..=0x82, ..] if self.length < LONGEST => return None,
            _ => None,
        };
        self.length = 0;
        received
    }

    fn tick(&mut self) -> Received {
        let late_us = core::mem::take(&mut self.next.late_us);
        let count = (!self.dead).then_some(self.count);
        Received::Tick(Next { count, late_us, ..self.next })
    }

    fn condition(&mut self, what: u8, value: i32) {
        match what {
            // The next tick comes late by this many µs.
            0 => self.next.late_us = value.unsigned_abs(),
            1 => self.next.trip = Some(Trip::Break(value)),
            2 => self.next.trip = Some(Trip::Supply(value)),
            5 => self.next.trip = Some(Trip::EmergencyStop),
            3 => self.next.trip = None,
            4 => self.dead = value != 0,
            _ => {}
        }
    }
}
