//! A CMSDK APB UART (Arm DDI 0479, chapter 4.3). It is polled; its interrupt only ends the processor's sleep.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

use crate::board::Wire;

const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CTRL: usize = 0x8;
const INT_CLEAR: usize = 0xc;
const BAUDDIV: usize = 0x10;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 2;
const TX_ENABLE: u32 = 1;
const RX_ENABLE: u32 = 2;
const RX_INTERRUPT_ENABLE: u32 = 8;
const RX_INTERRUPT: u32 = 2;

/// The number of an interrupt of a receiver.
#[derive(Clone, Copy, Debug)]
struct Receiver(u16);

// SAFETY: the numbers that `link` and `plant` give are those of the board's receivers, below its 32 interrupts.
unsafe impl InterruptNumber for Receiver {
    fn number(self) -> u16 {
        self.0
    }
}

/// One UART.
#[derive(Debug)]
pub struct Uart {
    base: usize,
    receiver: Receiver,
}

impl Uart {
    /// UART0: the link.
    #[must_use]
    pub fn link() -> Self {
        Self::at(0x4000_4000, Receiver(0))
    }

    /// UART1: the plant.
    #[must_use]
    pub fn plant() -> Self {
        Self::at(0x4000_5000, Receiver(2))
    }

    fn at(base: usize, receiver: Receiver) -> Self {
        let mut uart = Self { base, receiver };
        // The smallest divider it accepts; QEMU is not slowed by it.
        uart.write_register(BAUDDIV, 16);
        uart.write_register(CTRL, TX_ENABLE | RX_ENABLE | RX_INTERRUPT_ENABLE);
        // A byte from before the reset is nobody's; and QEMU listens to its end of the line only once it was read here.
        uart.read_register(DATA);
        // There is no handler. Interrupts are masked, and one that is pending ends the sleep of the image's loop.
        cortex_m::interrupt::disable();
        // SAFETY: no critical section relies on this interrupt's mask, because nothing runs in its handler.
        unsafe { NVIC::unmask(receiver) };
        uart
    }

    fn read_register(&self, offset: usize) -> u32 {
        // SAFETY: a register of the UART at `base`, one of the two that `link` and `plant` name.
        unsafe { ((self.base + offset) as *const u32).read_volatile() }
    }

    fn write_register(&mut self, offset: usize, value: u32) {
        // SAFETY: as in `read_register`.
        unsafe { ((self.base + offset) as *mut u32).write_volatile(value) }
    }

    /// A received byte, if there is one. Until it is taken here, the processor does not sleep.
    pub fn receive(&mut self) -> Option<u8> {
        if self.read_register(STATE) & RX_FULL == 0 {
            return None;
        }
        // Before the byte is read: the next one cannot arrive until then, so that no announcement is lost.
        self.write_register(INT_CLEAR, RX_INTERRUPT);
        NVIC::unpend(self.receiver);
        Some(self.read_register(DATA) as u8)
    }

    /// Sends a byte, waiting for room.
    pub fn send(&mut self, byte: u8) {
        while self.read_register(STATE) & TX_FULL != 0 {}
        self.write_register(DATA, u32::from(byte));
    }
}

/// The link's UART with a buffer behind it for bytes that a slow host has not read, like the USB bridge of a real
/// board. The emulated board does not wait for a busy machine.
#[derive(Debug)]
pub struct Link {
    uart: Uart,
    /// Bytes put into the buffer and taken out of it since the start; wrap.
    put: usize,
    taken: usize,
}

/// In PSRAM, behind the flash's image.
const BUFFER: usize = super::PSRAM + 0x10_0000;
/// A power of two.
const BUFFER_BYTES: usize = 1 << 20;

impl Link {
    /// UART0 with its buffer.
    #[must_use]
    pub fn new() -> Self {
        Self { uart: Uart::link(), put: 0, taken: 0 }
    }

    fn place(at: usize) -> *mut u8 {
        (BUFFER + at % BUFFER_BYTES) as *mut u8
    }
}

impl Default for Link {
    fn default() -> Self {
        Self::new()
    }
}

impl Wire for Link {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        self.uart.read(buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let room = BUFFER_BYTES - self.put.wrapping_sub(self.taken);
        let used = room.min(bytes.len());
        for byte in bytes.iter().take(used) {
            // SAFETY: inside the buffer, PSRAM that only this link uses.
            unsafe { Self::place(self.put).write_volatile(*byte) };
            self.put = self.put.wrapping_add(1);
        }
        used
    }

    fn flush(&mut self) {
        while self.put != self.taken {
            // SAFETY: as in `write`; written there before.
            let byte = unsafe { Self::place(self.taken).read_volatile() };
            if self.uart.write(&[byte]) == 0 {
                return;
            }
            self.taken = self.taken.wrapping_add(1);
        }
    }

    fn idle(&self) -> bool {
        self.put == self.taken
    }
}

impl Wire for Uart {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let mut read = 0;
        for slot in buffer {
            let Some(byte) = self.receive() else {
                break;
            };
            *slot = byte;
            read += 1;
        }
        read
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let mut written = 0;
        for byte in bytes {
            if self.read_register(STATE) & TX_FULL != 0 {
                break;
            }
            self.write_register(DATA, u32::from(*byte));
            written += 1;
        }
        written
    }
}
